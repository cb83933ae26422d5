"""Exported functions and required libraries of the released binaries, read from the files."""

import re
from pathlib import Path
from zipfile import ZipFile

import fmpy
import lief
import pytest

import sigmahat
from released_fmus import FMUS, TWINS

# Functions of the header that are not for co-simulation.
MODEL_EXCHANGE = {
    *("fmi2EnterEventMode", "fmi2NewDiscreteStates", "fmi2EnterContinuousTimeMode"),
    *("fmi2CompletedIntegratorStep", "fmi2SetTime", "fmi2SetContinuousStates"),
    *("fmi2GetDerivatives", "fmi2GetEventIndicators", "fmi2GetContinuousStates"),
    "fmi2GetNominalsOfContinuousStates",
}
BY_THE_LINKER = {"__mh_dylib_header", "___dso_handle"}  # symbols of a library of macOS
WHEEL = f"python/sigmahat-{sigmahat.__version__}-py3-none-{{}}.whl"
ARCHITECTURES = ("x86_64", "aarch64")


def places(system: str, folder: str, tag: str, *architectures: str) -> list[tuple[str, str]]:
    """Archives with a binary for a system, and the begin of its name."""
    twins = [(f"{n}.fmu", f"binaries/{a}-{system}/") for n in TWINS for a in architectures]
    wheel = (WHEEL.format(tag), "sigmahat/fmus/sigmahat_native")
    return [*((f"{n}.fmu", f"binaries/{folder}/") for n in FMUS), *twins, wheel]


LINUX = places("linux", "linux64", "manylinux_2_17_x86_64", *ARCHITECTURES)
WINDOWS = places("windows", "win64", "win_amd64", "x86_64")
MACOS = places("darwin", "darwin64", "macosx_11_0_x86_64", *ARCHITECTURES)


def functions(archive: str) -> set[str]:
    """All functions that the standard, or the header of the library in a wheel, declares."""
    if archive.endswith(".whl"):
        headers = (Path(__file__).parents[2] / "harness" / "native").glob("*.h")
        text = "".join(header.read_text() for header in headers)
        return set(re.findall(r"^SH_EXPORT .*?(\w+)\(", text, re.M))
    version = 3 if archive.endswith("_FMI3.fmu") else 2
    header = Path(fmpy.__file__).parent / "c-code" / f"fmi{version}Functions.h"
    pattern = rf"^#define \w+\s+fmi{version}FullName\((\w+)\)"
    return set(re.findall(pattern, header.read_text(), re.M)) - MODEL_EXCHANGE


def binary(released: Path, archive: str, place: str) -> object:
    with ZipFile(released / archive) as opened:
        (name,) = (each for each in opened.namelist() if each.startswith(place))
        return lief.parse(list(opened.read(name)))


@pytest.mark.parametrize(("archive", "place"), LINUX)
def test_linux(archive: str, place: str, released: Path) -> None:
    elf = binary(released, archive, place)
    assert isinstance(elf, lief.ELF.Binary)
    assert {symbol.name for symbol in elf.exported_symbols} == functions(archive)
    arm = elf.header.machine_type == lief.ELF.ARCH.AARCH64
    assert arm == ("aarch64" in place)
    assert set(elf.libraries) <= {"libc.so.6", "libm.so.6", *(["ld-linux-aarch64.so.1"] * arm)}
    needed = (
        n for library in elf.symbols_version_requirement for n in library.get_auxiliary_symbols()
    )
    for version in needed:
        numbers = [int(part) for part in re.findall(r"\d+", str(version))]
        assert numbers[:2] <= [2, 17], version


@pytest.mark.parametrize(("archive", "place"), WINDOWS)
def test_windows(archive: str, place: str, released: Path) -> None:
    dll = binary(released, archive, place)
    assert isinstance(dll, lief.PE.Binary)
    export = dll.get_export()
    assert export is not None
    assert {str(entry.name) for entry in export.entries} == functions(archive)
    imported = [str(library.name) for library in dll.imports]
    assert imported
    for library in imported:
        assert re.fullmatch(r"KERNEL32\.dll|msvcrt\.dll|api-ms-win-crt-[-a-z0-9]+\.dll", library)


@pytest.mark.parametrize(("archive", "place"), MACOS)
def test_macos(archive: str, place: str, released: Path) -> None:
    macho = binary(released, archive, place)
    assert isinstance(macho, lief.MachO.Binary)
    exported = {str(symbol.name) for symbol in macho.exported_symbols} - BY_THE_LINKER
    assert exported == {f"_{name}" for name in functions(archive)}
    assert macho.build_version is not None and list(macho.build_version.minos) == [11, 0, 0]
    _, *needed = [library.name for library in macho.libraries]
    assert needed == ["/usr/lib/libSystem.B.dylib"]
    # The loader of macOS refuses a library for ARM without a signature.
    assert "aarch64" not in place or macho.has_code_signature
