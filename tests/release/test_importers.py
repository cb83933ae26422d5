"""Other importers and Windows give the same trajectories of the released FMUs as FMPy."""

import os
import subprocess
from functools import cache
from pathlib import Path

import fmpy
import numpy as np
import pytest

from c_programs import DRIVERS, FMU_SOURCES
from gate import missing, need
from released_fmus import STEP, Run
from sigmahat.plant_fmu.compiler import HEADERS
from sigmahat_build.cross_compiler import compile_files

run_of = cache(Run)


@pytest.fixture(params=["AntagonisticStiffnessEstimator", "RealJointPlant"])
def run(request: pytest.FixtureRequest, released: Path) -> Run:
    """A simulation in FMPy of the estimator or the plant that has the most variables."""
    return run_of(released / f"{request.param}.fmu")


def test_libcosim_gives_the_same_trajectories(run: Run, capfd: pytest.CaptureFixture[str]) -> None:
    try:
        from libcosimpy.CosimExecution import CosimExecution
        from libcosimpy.CosimLogging import CosimLogLevel, log_output_level
        from libcosimpy.CosimManipulator import CosimManipulator
        from libcosimpy.CosimObserver import CosimObserver
        from libcosimpy.CosimSlave import CosimLocalSlave
    except ImportError:
        missing("libcosimpy", "pip install libcosimpy==0.0.6, on Linux with Python 3.11 or newer")
    log_output_level(CosimLogLevel.WARNING)
    execution = CosimExecution.from_step_size(round(STEP * 1e9))  # in ns
    slave = execution.add_local_slave(CosimLocalSlave(str(run.fmu.resolve()), "fmu"))
    manipulator = CosimManipulator.create_override()
    observer = CosimObserver.create_last_value()
    assert execution.add_manipulator(manipulator) and execution.add_observer(observer)
    inputs = [v.valueReference for v in run.inputs]
    outputs = [v.valueReference for v in run.outputs]
    rows = [observer.last_real_values(slave, outputs)]
    for held in run.signals[:-1]:
        assert manipulator.slave_real_values(slave, inputs, held.tolist())
        assert execution.step()
        rows.append(observer.last_real_values(slave, outputs))
    text = capfd.readouterr()
    own_limit = "FMI 2.0 Enumeration variable type not supported"
    assert [line for line in (text.out + text.err).splitlines() if own_limit not in line] == []
    # libcosim does not read the initial values of the outputs from the FMU.
    run.assert_same(np.array([run.trajectory[0], *rows[1:]]))


def assert_same_in(
    fmu: Path, target: str, binary: str, emulator: list[str], build: Path, folder: Path
) -> None:
    """Simulates an FMU in an emulator with drivers/master.c, which loads the unpacked FMU.

    target  target platform of the cross compiler
    binary  file of the binary in the FMU
    """
    run, program = run_of(fmu), folder / "binaries" / Path(binary).with_name("master.exe")
    fmpy.extract(str(fmu), unzipdir=str(folder))
    # The compiler needs minutes to build its C library, and then stores the result in a cache.
    # With -s and outside of the sources, as in the release, the compiler can use its cache.
    options = ["-std=c99", "-O2", "-s", f"-DSH_FMI={run.description.fmiVersion[0]}"]
    options += [f"-I{HEADERS}", f"-I{FMU_SOURCES}", "-o", str(program), str(DRIVERS / "master.c")]
    link = [f"binaries/{binary}", "-Wl,-rpath,$ORIGIN"]  # Windows searches the folder
    compile_files(target, [*options, *link], build / "cross-compiler", folder)
    done = subprocess.run(
        [
            *(*emulator, str(program)),
            *(run.description.guid, repr(STEP), str(len(run.inputs))),
            *(str(v.valueReference) for v in run.inputs + run.outputs),
        ],
        input="\n".join(",".join(map(repr, row)) for row in run.signals[:-1].tolist()),
        cwd=folder,
        env={
            **os.environ,
            "WINEPREFIX": str((build / "wine").resolve()),  # not the Wine folder of the user
            "WINEDLLOVERRIDES": "mscoree,mshtml=",  # no offer to download Mono or Gecko
            "WINEDEBUG": "-all",
        },
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stderr
    # The processes of Wine also write messages to the same stream, for example at their end.
    own = ("wine: ", "wine client error:")
    assert [line for line in done.stderr.splitlines() if not line.startswith(own)] == []
    run.assert_same(np.array([line.split(",") for line in done.stdout.split()], np.float64))


@pytest.mark.parametrize(
    ("name", "binary"),
    [
        ("RealJointPlant", "win64/RealJointPlant.dll"),
        ("StiffnessEstimator_FMI3", "x86_64-windows/StiffnessEstimator.dll"),
    ],
)
@pytest.mark.slow("Wine starts and steps an FMU through a whole run")
def test_the_windows_binary_gives_the_same_trajectories(
    name: str, binary: str, released: Path, build: Path, tmp_path: Path
) -> None:
    wine = [need("wine64", folder="/usr/lib/wine")]  # folder on Debian
    fmu = released / f"{name}.fmu"
    assert_same_in(fmu, "x86_64-windows-gnu", binary, wine, build, tmp_path)


@pytest.mark.parametrize("name", ["AwasPlant", "StiffnessEstimator"])
def test_the_binary_for_arm_gives_the_same_trajectories(
    name: str, released: Path, build: Path, tmp_path: Path
) -> None:
    emulator, libraries = need("qemu-aarch64"), Path("/usr/aarch64-linux-gnu")
    if not libraries.is_dir():
        missing("the C library for aarch64", "apt-get install libc6-dev-arm64-cross")
    fmu, qemu = released / f"{name}_FMI3.fmu", [emulator, "-L", str(libraries)]
    assert_same_in(fmu, "aarch64-linux-gnu.2.34", f"aarch64-linux/{name}.so", qemu, build, tmp_path)
