"""The released FMUs as archives: size, and identical bytes from every build."""

import os
import sys
from functools import cache
from pathlib import Path
from zipfile import ZipFile

import fmpy
import pytest

import controllers
import sigmahat
from released_fmus import FMUS, TWINS, Run
from sigmahat.export import archive, cross_compiler

run_of = cache(Run)


@pytest.mark.parametrize("name", FMUS + TWINS)
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


# The release compiles all of them from their sources, too; this is another way to do it.
@pytest.mark.parametrize("name", ["StiffnessEstimator", "AwasPlant_FMI3"])
def test_fmpy_rebuilds_it_from_its_sources(name: str, released: Path, tmp_path: Path) -> None:
    run = run_of(released / f"{name}.fmu")
    folder = Path(fmpy.extract(str(run.fmu), unzipdir=str(tmp_path / "unpacked")))
    files = [f for f in folder.rglob("*") if f.is_file()]
    contents = {f.relative_to(folder).as_posix(): f for f in files}
    rebuilt = tmp_path / f"{name}.fmu"
    archive.write(rebuilt, {n: f for n, f in contents.items() if not n.startswith("binaries/")})
    # With the build tool of the environment, because make may be missing.
    environment = {
        "PATH": f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}",
        "CMAKE_GENERATOR": "Ninja",
    }
    command = [sys.executable, "-m", "fmpy", "compile", str(rebuilt)]
    controllers.run(*command, environment=environment)
    run.assert_same(run.simulate(rebuilt))
