"""The released FMUs as archives: contents, size, and identical bytes from every build."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path
from zipfile import ZipFile

import fmpy
import pytest

import sigmahat
from released_fmus import FMUS, TWINS, Run
from sigmahat.export import archive, cross_compiler

each_fmu = pytest.mark.parametrize("name", FMUS)
each_version = pytest.mark.parametrize("name", FMUS + TWINS)


def binaries(fmu: Path) -> set[str]:
    with ZipFile(fmu) as opened:
        return {name for name in opened.namelist() if name.startswith("binaries/")}


@each_fmu
def test_a_released_fmu_contains_the_binaries_of_all_platforms(name: str, released: Path) -> None:
    assert binaries(released / f"{name}.fmu") == {
        f"binaries/linux64/{name}.so",
        f"binaries/win64/{name}.dll",
        f"binaries/darwin64/{name}.dylib",
    }


@pytest.mark.parametrize("twin", TWINS)
def test_a_released_twin_contains_the_binaries_of_more_platforms(twin: str, released: Path) -> None:
    name = twin.removesuffix("_FMI3")
    assert binaries(released / f"{twin}.fmu") == {
        f"binaries/x86_64-linux/{name}.so",
        f"binaries/x86_64-windows/{name}.dll",
        f"binaries/x86_64-darwin/{name}.dylib",
        f"binaries/aarch64-linux/{name}.so",
        f"binaries/aarch64-darwin/{name}.dylib",
    }


@each_version
def test_a_released_fmu_has_at_most_1_mb(name: str, released: Path) -> None:
    assert (released / f"{name}.fmu").stat().st_size <= 1e6


@each_version
def test_it_contains_no_path_of_the_build_machine(name: str, released: Path) -> None:
    places = [str(path).encode() for path in (Path.home(), released.resolve().parent)]
    with ZipFile(released / f"{name}.fmu") as opened:
        for entry in opened.namelist():
            assert not any(place in opened.read(entry) for place in places), entry


@pytest.mark.parametrize("name", ["StiffnessEstimator", "AwasPlant_FMI3"])
@pytest.mark.slow("an FMU is compiled again for every platform")
def test_a_second_build_gives_identical_bytes(
    name: str, released: Path, build: Path, tmp_path: Path
) -> None:
    again = tmp_path / "again.fmu"
    own = build / "fmi3" / f"{name}.fmu" if name in TWINS else sigmahat.fmu(name)
    cross_compiler.release(own, again, build / "cross-compiler")
    assert again.read_bytes() == (released / f"{name}.fmu").read_bytes()


@each_fmu
def test_the_released_binary_gives_the_results_of_the_host_build(name: str, released: Path) -> None:
    run = Run(released / f"{name}.fmu")
    run.assert_same(run.simulate(sigmahat.fmu(name)))


# The release compiles all of them from their sources, too; this is another way to do it.
@pytest.mark.parametrize("name", ["StiffnessEstimator", "AwasPlant", "AwasPlant_FMI3"])
def test_fmpy_rebuilds_it_from_its_sources(name: str, released: Path, tmp_path: Path) -> None:
    run = Run(released / f"{name}.fmu")
    folder = Path(fmpy.extract(str(run.fmu), unzipdir=str(tmp_path / "unpacked")))
    files = [f for f in folder.rglob("*") if f.is_file()]
    contents = {f.relative_to(folder).as_posix(): f for f in files}
    rebuilt = tmp_path / f"{name}.fmu"
    archive.write(rebuilt, {n: f for n, f in contents.items() if not n.startswith("binaries/")})
    done = subprocess.run(
        [sys.executable, "-m", "fmpy", "compile", str(rebuilt)],
        env={  # with the build tool of the environment, because make may be missing
            **os.environ,
            "PATH": f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}",
            "CMAKE_GENERATOR": "Ninja",
        },
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stdout + done.stderr
    run.assert_same(run.simulate(rebuilt))
