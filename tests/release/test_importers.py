"""The released FMUs give the trajectories of FMPy in other importers and on Windows, too."""

from __future__ import annotations

import os
import subprocess
from pathlib import Path

import fmpy
import numpy as np
import pytest

from gate import missing, need
from released_fmus import FMUS, STEP, Run
from sigmahat.export.cross_compiler import HEADERS, compile_files

each_fmu = pytest.mark.parametrize("run", FMUS, indirect=True)


@pytest.fixture(scope="module")
def runs() -> dict[str, Run]:
    return {}


@pytest.fixture
def run(request: pytest.FixtureRequest, released: Path, runs: dict[str, Run]) -> Run:
    """The run of an FMU in FMPy, which all tests of this FMU share."""
    name: str = request.param
    if name not in runs:
        runs[name] = Run(released / f"{name}.fmu")
    return runs[name]


@each_fmu
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
    # libcosim does not read the values before the first step from the FMU.
    run.assert_same(np.array([run.trajectory[0], *rows[1:]]))


def master(fmi: int, target: str, build: Path, program: Path) -> Path:
    """``drivers/master.c`` for a version of FMI and a target of the cross compiler."""
    source = Path(__file__).parents[1] / "drivers" / "master.c"
    # With -s and in a folder outside of the sources as the binaries of the release: so what the
    # compiler made of its C library for them is used again, which takes minutes to make.
    compile_files(
        target,
        ["-std=c99", "-O2", "-s", f"-DSH_FMI={fmi}", f"-I{HEADERS}", source, "-o", program],
        build / "cross-compiler",
        program.parent,
    )
    return program


def assert_same_in(run: Run, command: list[str], build: Path, cwd: Path) -> None:
    """Steps the FMU, unpacked in `cwd`, with a master that takes the arguments of drivers/."""
    done = subprocess.run(
        [
            *command,
            *(run.description.guid, repr(STEP), str(len(run.inputs))),
            *(str(v.valueReference) for v in run.inputs + run.outputs),
        ],
        input="\n".join(",".join(map(repr, row)) for row in run.signals[:-1].tolist()),
        cwd=cwd,
        env={
            **os.environ,
            "WINEPREFIX": str((build / "wine").resolve()),  # a separate one, not that of the user
            "WINEDLLOVERRIDES": "mscoree,mshtml=",  # prevents an offer to download them
            "WINEDEBUG": "-all",
        },
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stderr
    # Wine's own processes write into the same stream, also when its server ends before them.
    own = ("wine: ", "wine client error:")
    assert [line for line in done.stderr.splitlines() if not line.startswith(own)] == []
    run.assert_same(np.array([line.split(",") for line in done.stdout.split()], np.float64))


def wine() -> str:
    # Debian installs it in a folder that is not on the PATH.
    return need("wine64", folder="/usr/lib/wine")


@pytest.fixture(scope="module")
def windows_master(build: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    program = tmp_path_factory.mktemp("windows") / "master.exe"
    return master(2, "x86_64-windows-gnu", build, program)


@each_fmu
@pytest.mark.slow("Wine starts for each FMU and steps it through a whole run")
def test_the_windows_binary_gives_the_same_trajectories(
    run: Run, windows_master: Path, build: Path, tmp_path: Path
) -> None:
    fmpy.extract(str(run.fmu), unzipdir=str(tmp_path))
    library = f"binaries/win64/{run.fmu.stem}.dll"
    assert_same_in(run, [wine(), str(windows_master), library], build, tmp_path)


two_twins = pytest.mark.parametrize("name", ["AwasPlant_FMI3", "StiffnessEstimator_FMI3"])


@two_twins
@pytest.mark.slow("Wine starts and steps an FMU through a whole run")
def test_the_windows_binary_of_a_twin_gives_the_same_trajectories(
    name: str, released: Path, build: Path, tmp_path: Path
) -> None:
    run = Run(released / f"{name}.fmu")
    program = master(3, "x86_64-windows-gnu", build, tmp_path / "master.exe")
    fmpy.extract(str(run.fmu), unzipdir=str(tmp_path))
    library = f"binaries/x86_64-windows/{name.removesuffix('_FMI3')}.dll"
    assert_same_in(run, [wine(), str(program), library], build, tmp_path)


@two_twins
def test_the_binary_for_arm_gives_the_same_trajectories(
    name: str, released: Path, build: Path, tmp_path: Path
) -> None:
    emulator, libraries = need("qemu-aarch64"), Path("/usr/aarch64-linux-gnu")
    if not libraries.is_dir():
        missing("the C library for aarch64", "apt-get install libc6-dev-arm64-cross")
    run = Run(released / f"{name}.fmu")
    program = master(3, "aarch64-linux-gnu.2.34", build, tmp_path / "master")
    fmpy.extract(str(run.fmu), unzipdir=str(tmp_path))
    library = tmp_path / f"binaries/aarch64-linux/{name.removesuffix('_FMI3')}.so"
    assert_same_in(
        run, [emulator, "-L", str(libraries), str(program), str(library)], build, tmp_path
    )
