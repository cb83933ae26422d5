"""Times of whole commands and threads: python bench/processes.py --help.

It needs a machine that does nothing else, and takes some minutes.
"""

from __future__ import annotations

import argparse
import os
import shutil
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace
from itertools import chain
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet

import sigmahat
from report import update
from sigmahat.fmi.instance import Slave
from sigmahat.fmi.opened import installed
from sigmahat.fmi.sample_loop import Recorder, SampleLoop, step_times
from sigmahat.runs.scenario import T

PORTS = ("theta", "q", "theta_c", "tau")
OUTPUTS = ("sigma", "sigma_std", "tau_e")
CONFIGURATION = """
[time]
column = "t"
{ports}
[parameters]
method = "{method}"
"""
ROUNDS = 3


@dataclass(frozen=True)
class Row:
    """A line of the table."""

    what: str
    asked: str
    measured: str


@dataclass(frozen=True)
class Process:
    """What a process took."""

    wall: float
    """[s]"""
    memory: float
    """Largest resident set [GB]."""


def measured(*command: str | Path) -> Process:
    """Runs a command. Raises CalledProcessError if it fails."""
    begin, memory = time.perf_counter(), 0.0
    started = subprocess.Popen(command, stdout=subprocess.DEVNULL)
    while started.poll() is None:
        memory = max(memory, _memory(started.pid))
        time.sleep(0.02)
    wall = time.perf_counter() - begin
    if started.returncode:
        raise subprocess.CalledProcessError(started.returncode, list(map(str, command)))
    return Process(wall, memory)


def _memory(process: int) -> float:
    """Largest resident set so far [GB]. That of wait4 would contain what this process has."""
    try:
        status = Path(f"/proc/{process}/status").read_text(encoding="ascii")
    except OSError:  # it has just ended
        return 0.0
    lines = (line.split() for line in status.splitlines())
    return next((int(words[1]) * 1024 / 1e9 for words in lines if words[0] == "VmHWM:"), 0.0)


def sigmahat_command() -> Path:
    """The command of this environment."""
    return Path(sys.executable).with_name("sigmahat")


def measurements(samples: int) -> dict[str, np.typing.NDArray[np.float64]]:
    """Measurements of table1, forward and backward in turns, at 1 kHz."""
    plant = sigmahat.scenario("table1").plant
    record = [f"{name}_measured" for name in PORTS]
    run = sigmahat.simulate(replace(plant, record=record), {}, T, 100_000).plant
    rows = np.arange(10_000, 100_000)
    rows = np.resize(np.concatenate([rows, rows[::-1]]), samples)
    return {name: run[f"{name}_measured"][rows] for name in PORTS}


def estimate(folder: Path) -> Iterator[Row]:
    """An hour at 1 kHz through `sigmahat estimate`, beside the loop in C alone."""
    samples = 3_600_000
    log = folder / "hour.parquet"
    columns = measurements(samples)
    pa.parquet.write_table(pa.table({"t": T * np.arange(samples), **columns}), log)
    table = np.column_stack([columns[name] for name in PORTS])
    ports = "\n".join(f'[ports.{name}]\ncolumn = "{name}"' for name in PORTS)
    for method in ("Paper2011", "FilteredRegression"):
        configuration = folder / f"{method}.toml"
        configuration.write_text(CONFIGURATION.format(ports=ports, method=method))
        runs, loops = [], []
        for k in range(ROUNDS):
            loops.append(bare_loop(method, table))
            out = folder / f"{method}-{k}"
            command = ("estimate", log, "--config", configuration, "--out", out, "--quiet")
            runs.append(measured(sigmahat_command(), *command))
            shutil.rmtree(out)
        loop, wall = statistics.median(loops), statistics.median(run.wall for run in runs)
        memory = max(run.memory for run in runs)
        yield Row(
            f"estimate, 1 h at 1 kHz, {method}",
            f"<= {2 * loop + 2:.1f} s (2 x {loop:.2f} s + 2 s); 0.5 GB",
            f"{wall:.1f} s; {memory:.2f} GB",
        )


def bare_loop(method: str, table: np.typing.NDArray[np.float64]) -> float:
    """Time of the loop in C alone over all samples [s]."""
    fmu = installed("StiffnessEstimator")
    t = T * np.arange(len(table), dtype=np.float64)
    with Slave(fmu, "bare") as slave:
        slave.initialize({"method": method})
        loop = SampleLoop()
        loop.set_real(slave, fmu.references(PORTS, "input"), table)
        loop.step(slave, step_times(t, T))
        Recorder(slave, OUTPUTS, len(t)).add_to(loop)
        begin = time.perf_counter()
        loop.run(0, len(t))
        return time.perf_counter() - begin


def sweep(folder: Path) -> Iterator[Row]:
    """1000 runs of table1 with all its estimations, in a process for each processor."""
    one = sigmahat.scenario("table1")
    judged = replace(one, plant=replace(one.plant, record=["sigma"]))
    sigmahat.run(judged, seed=1)
    begin = time.perf_counter()
    for seed in range(1, 21):
        sigmahat.run(judged, seed)
    alone = (time.perf_counter() - begin) / 20
    runs = 1000
    arguments = ("sweep", "--scenario", "table1", "--seeds", str(runs), "--out", folder / "sweep")
    took = measured(sigmahat_command(), *arguments, "--quiet")
    cores = os.cpu_count() or 1
    efficiency = runs * alone / (cores * took.wall)
    yield Row(
        f"sweep of {runs} runs of table1, {cores} processors",
        "<= 60 s; efficiency 0.85",
        f"{took.wall:.1f} s; {efficiency:.2f} (a run alone: {alone * 1e3:.0f} ms)",
    )


def compare(folder: Path) -> Iterator[Row]:
    """The comparison of both methods over 20 seeds."""
    took = measured(
        *(sigmahat_command(), "compare", "--seeds", "20", "--out", folder / "compare", "--quiet")
    )
    yield Row("compare --seeds 20", "<= 60 s", f"{took.wall:.1f} s")


def threads(count: int = 1000) -> Iterator[Row]:
    """Many estimators in one process, in one thread and in two."""
    samples = 20_000
    columns = measurements(samples)
    estimators = [sigmahat.Estimator({}, OUTPUTS) for _ in range(count)]

    def seconds(workers: int) -> float:
        begin = time.perf_counter()
        with ThreadPoolExecutor(workers) as pool:
            for _ in pool.map(lambda each: each.run(**columns), estimators):
                pass
        return time.perf_counter() - begin

    seconds(2)
    ratio = statistics.median(seconds(1) / seconds(2) for _ in range(ROUNDS))
    size = estimators[0].size / 1000
    yield Row(
        f"{count} estimators over {samples} samples, two threads against one",
        ">= 1.9 x",
        f"{ratio:.2f} x; {size:.0f} kB each",
    )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--page", type=Path, help="Markdown page whose table is replaced")
    arguments = parser.parse_args()
    lines = ["| quantity | asked | measured |", "|---|---|---|"]
    with tempfile.TemporaryDirectory(prefix="sigmahat-bench-") as name:
        folder = Path(name)
        for row in chain(estimate(folder), sweep(folder), compare(folder), threads()):
            lines.append(f"| {row.what} | {row.asked} | {row.measured} |")
            print(lines[-1], flush=True)
    if arguments.page:
        update(arguments.page, "processes", "\n".join(lines) + "\n")


if __name__ == "__main__":
    main()
