"""Tests of the released FMUs: size, reproducible bytes, binaries, and results of FMU checkers."""

import os
import re
import shutil
import sys
from functools import cache
from pathlib import Path
from zipfile import ZipFile

import fmpy
import lief
import pytest
from fmpy.validation import validate_fmu
from fmu_manipulation_toolbox.cli.fmutool import fmutool

import controllers
import fmi_functions
import sigmahat
from gate import missing, need
from released_fmus import FMUS, INTEGERS, TWINS, Run
from sigmahat.plant_fmu import archive
from sigmahat_build import cross_compiler

run_of = cache(Run)


@pytest.mark.parametrize("name", FMUS + TWINS + INTEGERS)
def test_it_has_at_most_1_mb_and_no_path_of_the_build_machine(name: str, released: Path) -> None:
    fmu = released / f"{name}.fmu"
    assert fmu.stat().st_size <= 1e6
    places = [str(path).encode() for path in (Path.home(), released.resolve().parent)]
    with ZipFile(fmu) as opened:
        for entry in opened.namelist():
            assert not any(place in opened.read(entry) for place in places), entry


@pytest.mark.slow("an FMU is compiled again for every platform")
def test_a_second_build_gives_identical_bytes(released: Path, build: Path, tmp_path: Path) -> None:
    name, again = "AwasPlant_FMI3.fmu", tmp_path / "again.fmu"
    cross_compiler.release(build / "fmi3" / name, again, build / "cross-compiler")
    assert again.read_bytes() == (released / name).read_bytes()


@pytest.mark.parametrize("name", FMUS)
def test_the_released_binary_gives_the_results_of_the_host_build(name: str, released: Path) -> None:
    run = run_of(released / f"{name}.fmu")
    run.assert_same(run.simulate(sigmahat.fmu(name)))


# FMPy compiles the sources of an FMU in another way than the release does.
@pytest.mark.parametrize("name", ["StiffnessEstimator", "AwasPlant_FMI3"])
def test_fmpy_rebuilds_it_from_its_sources(name: str, released: Path, tmp_path: Path) -> None:
    run = run_of(released / f"{name}.fmu")
    folder = Path(fmpy.extract(str(run.fmu), unzipdir=str(tmp_path / "unpacked")))
    files = [f for f in folder.rglob("*") if f.is_file()]
    contents = {f.relative_to(folder).as_posix(): f for f in files}
    rebuilt = tmp_path / f"{name}.fmu"
    archive.write(rebuilt, {n: f for n, f in contents.items() if not n.startswith("binaries/")})
    # FMPy builds with Ninja from the Python environment, because make may be missing.
    environment = {
        "PATH": f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}",
        "CMAKE_GENERATOR": "Ninja",
    }
    command = [sys.executable, "-m", "fmpy", "compile", str(rebuilt)]
    controllers.run(*command, environment=environment)
    run.assert_same(run.simulate(rebuilt))


# Checkers of the archive and its model description


@pytest.mark.parametrize("name", FMUS + TWINS + INTEGERS)
def test_fmpy_and_the_manipulation_toolbox_find_no_error(
    name: str, released: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    fmu = str(released / f"{name}.fmu")
    assert validate_fmu(fmu) == []
    monkeypatch.setattr(sys, "argv", ["fmutool", "-input", fmu, "-check"])
    fmutool()
    text = "".join(capsys.readouterr())
    version = 3 if "_FMI3" in name else 2
    assert f"This FMU seems to be compliant with FMI-{version}.0." in text
    assert f"No semantic error against the FMI-{version} standard." in text
    assert "WARNING" not in text and "ERROR" not in text, text


@pytest.mark.parametrize("name", ["AntagonisticStiffnessEstimator", "RealJointPlant"])
def test_vdmcheck2_finds_no_error(name: str, released: Path, build: Path, tmp_path: Path) -> None:
    jars = build / "checkers" / "vdmcheck2"
    if not (jars / "vdmcheck2.jar").exists():
        missing("VDMCheck2", "mvn -f tests/checkers/pom.xml dependency:copy-dependencies")
    for jar in jars.glob("*.jar"):
        shutil.copy(jar, tmp_path)
    for jar_with_files in ("static-model.jar", "vdmcheck2.jar"):  # VDMCheck2 needs their files
        with ZipFile(jars / jar_with_files) as archive:
            archive.extractall(tmp_path)
    fmu = released.resolve() / f"{name}.fmu"
    text = controllers.run(need("java"), "-jar", "vdmcheck2.jar", fmu, cwd=tmp_path)
    # VDMCheck2 reports files as missing that FMI 3 requires, but not FMI 2.0.
    lines = [line for line in text.splitlines() if not line.startswith("FMU has no ")]
    assert lines[-1] == "No errors found."
    assert all(line == "Checking modelDescription.xml" for line in lines[:-1]), text


# Exported functions and required libraries of the binaries in FMUs and wheels

BY_THE_LINKER = {"__mh_dylib_header", "___dso_handle"}  # from the linker of macOS
WHEEL = f"python/sigmahat-{sigmahat.__version__}-py3-none-{{}}.whl"
ARCHITECTURES = ("x86_64", "aarch64")


def places(system: str, folder: str, tag: str, *architectures: str) -> list[tuple[str, str]]:
    """Returns all archives with a binary for a system, and the first part of the binary's name."""
    twins = [(f"{n}.fmu", f"binaries/{a}-{system}/") for n in TWINS for a in architectures]
    wheel = (WHEEL.format(tag), "sigmahat/fmus/sigmahat_native")
    return [*((f"{n}.fmu", f"binaries/{folder}/") for n in FMUS), *twins, wheel]


LINUX = places("linux", "linux64", "manylinux_2_17_x86_64", *ARCHITECTURES)
WINDOWS = places("windows", "win64", "win_amd64", "x86_64")
MACOS = places("darwin", "darwin64", "macosx_11_0_x86_64", *ARCHITECTURES)


def functions(archive: str) -> set[str]:
    """Returns all functions that the FMI standard or the header of the C library declares."""
    if archive.endswith(".whl"):
        headers = (Path(__file__).parents[2] / "harness" / "native").glob("*.h")
        text = "".join(header.read_text() for header in headers)
        return set(re.findall(r"^SH_EXPORT .*?(\w+)\(", text, re.M))
    prefix = "fmi3" if archive.endswith("_FMI3.fmu") else "fmi2"
    return {f"{prefix}{name}" for name in fmi_functions.functions(prefix)}


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
