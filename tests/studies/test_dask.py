"""Tests of sweeps on a local Dask cluster, which is started with the commands of a user."""

import json
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import distributed
import pytest

from command_line import Shell
from sigmahat.experiments.engine import execute
from sigmahat.experiments.pool import WorkerError
from sigmahat.studies.sweep import Sweep
from sigmahat.studies.sweep_grid import read_grid
from sweeps import QUICK, records, start, wait_until, written

DASK = [sys.executable, "-m", "dask"]
HERE = ["--host", "127.0.0.1", "--no-dashboard", "--scheduler-file", "scheduler.json"]


@contextmanager
def background(*arguments: str, cwd: Path) -> Iterator[subprocess.Popen[bytes]]:
    process = subprocess.Popen(
        [*DASK, *arguments], cwd=cwd, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
    )
    try:
        yield process
    finally:
        process.kill()
        process.wait()


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Folder of the Dask cluster."""
    return tmp_path_factory.mktemp("cluster")


@pytest.fixture(scope="module")
def scheduler(folder: Path) -> Iterator[subprocess.Popen[bytes]]:
    """Process of one scheduler for all tests, without workers. The last test kills it."""
    with background("scheduler", "--port", "0", *HERE, cwd=folder) as process:
        yield process


@pytest.fixture(scope="module")
def address(scheduler: subprocess.Popen[bytes], folder: Path) -> str:
    """Address of the scheduler, after the scheduler has started."""
    file = folder / "scheduler.json"
    wait_until(lambda: file.exists() and bool(file.read_text()), scheduler)
    address: str = json.loads(file.read_text())["address"]
    return address


@contextmanager
def worker(folder: Path, name: str, runs: int = 1) -> Iterator[subprocess.Popen[bytes]]:
    """Process of a worker that executes `runs` simulations in parallel."""
    options = ["--nthreads", str(runs), "--no-nanny", "--name", name, "--local-directory", name]
    with background("worker", *HERE, *options, cwd=folder) as process:
        yield process


def wait_for_workers(address: str, count: int) -> None:
    """Waits until `count` workers are connected to the scheduler."""
    with distributed.Client(address, timeout=300, set_as_default=False) as client:
        client.wait_for_workers(count, timeout=300)


@pytest.mark.complete
@pytest.mark.slow("the sweep waits for a slow scheduler, and for workers, before it gives up")
def test_a_scheduler_that_is_slow_and_without_workers(
    scheduler: subprocess.Popen[bytes], address: str, shell: Shell
) -> None:
    # GIVEN a scheduler that stops for longer than the time-out for a missing scheduler
    scheduler.send_signal(signal.SIGSTOP)
    process = start(f"{QUICK} --scheduler {address} --out out")
    time.sleep(6)
    assert process.poll() is None
    scheduler.send_signal(signal.SIGCONT)
    # THEN the sweep finds the scheduler, and reports that it has no workers.
    output, errors = process.communicate(timeout=300)
    assert (process.returncode, output) == (2, "")
    (line,) = errors.splitlines()
    assert f"start one with `dask worker {address}`" in line
    assert not Path("out").exists()


@pytest.mark.complete
@pytest.mark.slow("a cluster of processes is started")
def test_one_of_two_workers_killed(address: str, folder: Path, shell: Shell) -> None:
    command = f"{QUICK} --seeds 16"
    with worker(folder, "one") as one, worker(folder, "two", runs=2):
        wait_for_workers(address, 2)
        process = start(f"{command} --scheduler {address} --out cluster")
        # WHEN one worker is killed while both workers are busy
        out = Path("cluster")
        wait_until(lambda: written(out) >= 3, process)
        one.kill()
        done_before = written(out)
        output, errors = process.communicate(timeout=600)
    assert (process.returncode, errors) == (0, "")
    assert 3 <= done_before < 16
    # THEN the results contain every run exactly once, as without a cluster.
    assert len(records(out)) == 16
    assert shell.run(f"{command} --out here").splitlines()[:-1] == output.splitlines()[:-1]
    for name in ("sweep.parquet", "summary.csv", "distributions.svg"):
        assert Path("cluster", name).read_bytes() == Path("here", name).read_bytes()


@pytest.mark.slow("a cluster of processes is started")
def test_the_scheduler_is_lost(
    scheduler: subprocess.Popen[bytes], address: str, folder: Path, shell: Shell
) -> None:
    out = Path("out")
    with worker(folder, "three"):
        wait_for_workers(address, 1)
        process = start(f"{QUICK} --seeds 200 --scheduler {address} --out out")
        wait_until(lambda: written(out) >= 3, process)
        scheduler.kill()
        output, errors = process.communicate(timeout=300)
    assert (process.returncode, output) == (2, "")
    (line,) = errors.splitlines()
    assert line == (
        f"sigmahat: error: lost connection to the Dask scheduler at {address}; "
        "run the command again for the missing runs"
    )
    assert 3 <= len(records(out)) < 200


def test_a_worker_with_other_fmus() -> None:
    (first,) = Sweep(read_grid(("table1",), 1, ("RESIDUAL",))).jobs
    with pytest.raises(WorkerError, match="install the same sigmahat on both"):
        execute(first, "of other FMUs")
    assert not execute(first, first.identity).failures
