"""Exported functions and required libraries of the released binaries, read from the files."""

from __future__ import annotations

import re
from pathlib import Path
from zipfile import ZipFile

import fmpy
import lief
import pytest

from released_fmus import FMUS, TWINS

each_fmu = pytest.mark.parametrize("name", FMUS)
each_twin = pytest.mark.parametrize("twin", TWINS)

# Functions of the header that are not for co-simulation.
MODEL_EXCHANGE = {
    "fmi2EnterEventMode",
    "fmi2NewDiscreteStates",
    "fmi2EnterContinuousTimeMode",
    "fmi2CompletedIntegratorStep",
    "fmi2SetTime",
    "fmi2SetContinuousStates",
    "fmi2GetDerivatives",
    "fmi2GetEventIndicators",
    "fmi2GetContinuousStates",
    "fmi2GetNominalsOfContinuousStates",
}
BY_THE_LINKER = {"__mh_dylib_header", "___dso_handle"}  # symbols of a library of macOS


@pytest.fixture(scope="module")
def functions() -> set[str]:
    """The functions of FMI 2.0 for Co-Simulation, from the header of the standard."""
    header = Path(fmpy.__file__).parent / "c-code" / "fmi2Functions.h"
    declared = set(re.findall(r"^#define \w+\s+fmi2FullName\((\w+)\)", header.read_text(), re.M))
    assert declared > MODEL_EXCHANGE
    return declared - MODEL_EXCHANGE


def binary(released: Path, name: str, platform: str, extension: str) -> list[int]:
    library = name.removesuffix("_FMI3") + extension
    with ZipFile(released / f"{name}.fmu") as archive:
        return list(archive.read(f"binaries/{platform}/{library}"))


# An object of lief is valid only as long as its parent exists, so each parent has a variable below.


def linux(released: Path, name: str) -> lief.ELF.Binary:
    parsed = lief.ELF.parse(binary(released, name, "linux64", ".so"))
    assert isinstance(parsed, lief.ELF.Binary)
    return parsed


def windows(released: Path, name: str) -> lief.PE.Binary:
    parsed = lief.PE.parse(binary(released, name, "win64", ".dll"))
    assert isinstance(parsed, lief.PE.Binary)
    return parsed


@each_fmu
def test_linux_exports_only_the_fmi_functions(
    name: str, released: Path, functions: set[str]
) -> None:
    elf = linux(released, name)
    assert {symbol.name for symbol in elf.exported_symbols} == functions


@each_fmu
def test_linux_needs_glibc_2_17_at_most(name: str, released: Path) -> None:
    elf = linux(released, name)
    assert set(elf.libraries) <= {"libc.so.6", "libm.so.6"}
    versions = [
        needed.name
        for library in elf.symbols_version_requirement
        for needed in library.get_auxiliary_symbols()
    ]
    assert versions
    for version in versions:
        numbers = re.fullmatch(r"GLIBC_(\d+)\.(\d+)(?:\.\d+)?", str(version))
        assert numbers is not None, version
        assert (int(numbers[1]), int(numbers[2])) <= (2, 17), version


@each_fmu
def test_windows_exports_only_the_fmi_functions(
    name: str, released: Path, functions: set[str]
) -> None:
    dll = windows(released, name)
    export = dll.get_export()
    assert export is not None
    assert {str(entry.name) for entry in export.entries} == functions


@each_fmu
def test_windows_needs_only_system_libraries(name: str, released: Path) -> None:
    dll = windows(released, name)
    imported = [str(library.name) for library in dll.imports]
    assert imported
    for library in imported:
        assert re.fullmatch(r"KERNEL32\.dll|msvcrt\.dll|api-ms-win-crt-[-a-z0-9]+\.dll", library)


@each_fmu
def test_macos_exports_only_the_fmi_functions_and_needs_only_the_system(
    name: str, released: Path, functions: set[str]
) -> None:
    universal = lief.MachO.parse(binary(released, name, "darwin64", ".dylib"))
    assert universal is not None and universal.size == 1
    macho = universal.at(0)
    assert macho is not None
    exported = {str(symbol.name) for symbol in macho.exported_symbols} - BY_THE_LINKER
    assert exported == {"_" + function for function in functions}
    assert macho.build_version is not None
    assert list(macho.build_version.minos) == [11, 0, 0]
    own_name, *needed = [library.name for library in macho.libraries]
    assert own_name == f"{name}.dylib"
    assert needed == ["/usr/lib/libSystem.B.dylib"]


@pytest.fixture(scope="module")
def functions_3() -> set[str]:
    """All functions of FMI 3.0: the standard demands them from every FMU."""
    header = Path(fmpy.__file__).parent / "c-code" / "fmi3Functions.h"
    return set(re.findall(r"^#define \w+\s+fmi3FullName\((\w+)\)", header.read_text(), re.M))


@each_twin
@pytest.mark.parametrize("platform", ["x86_64-linux", "aarch64-linux"])
def test_linux_exports_all_functions_of_fmi_3(
    twin: str, platform: str, released: Path, functions_3: set[str]
) -> None:
    elf = lief.ELF.parse(binary(released, twin, platform, ".so"))
    assert isinstance(elf, lief.ELF.Binary)
    assert {symbol.name for symbol in elf.exported_symbols} == functions_3
    arm = elf.header.machine_type == lief.ELF.ARCH.AARCH64
    assert arm == (platform == "aarch64-linux")


@each_twin
def test_windows_exports_all_functions_of_fmi_3(
    twin: str, released: Path, functions_3: set[str]
) -> None:
    dll = lief.PE.parse(binary(released, twin, "x86_64-windows", ".dll"))
    assert isinstance(dll, lief.PE.Binary)
    export = dll.get_export()
    assert export is not None
    assert {str(entry.name) for entry in export.entries} == functions_3


@each_twin
@pytest.mark.parametrize("platform", ["x86_64-darwin", "aarch64-darwin"])
def test_macos_exports_all_functions_of_fmi_3(
    twin: str, platform: str, released: Path, functions_3: set[str]
) -> None:
    universal = lief.MachO.parse(binary(released, twin, platform, ".dylib"))
    assert universal is not None
    macho = universal.at(0)
    assert macho is not None
    exported = {str(symbol.name) for symbol in macho.exported_symbols}
    assert exported - BY_THE_LINKER == {"_" + function for function in functions_3}
    # The loader of macOS refuses a library for ARM without a signature.
    assert macho.has_code_signature == (platform == "aarch64-darwin")
