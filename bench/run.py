"""Measures all times in one run and writes tables and a figure: python bench/run.py --help."""

from __future__ import annotations

import argparse
import ctypes
import shutil
import subprocess
import tempfile
import time
from pathlib import Path

import numpy as np

import loops
import subjects
from report import Footprint, Times, figure, table, update
from subjects import Array, Fmus, Library, Subject

ROUNDS = 101
SAMPLES = 10000  # one period of the torques


def verify(library: Library, native: Library, fmus: Fmus) -> None:
    """Checks that all subjects compute the same results.

    Raises AssertionError, which names the subject that does not.
    """
    for size in subjects.SIZES:
        data = subjects.regression(size, 2000)
        information = np.eye(size) / subjects.P_0 + data.F.T @ data.F
        closed_form = np.linalg.solve(information, data.F.T @ data.y)
        recursions = subjects.recursions(library, size) | subjects.native_recursions(native, size)
        for make, rls in recursions.items():
            rls.run(data)
            tolerance = 0.05 if make == "liquid" else 1e-9  # single precision, other P_0
            np.testing.assert_allclose(rls.eta, closed_form, 0, tolerance, err_msg=make)

    z = subjects.measurements(500)
    tick = subjects.Ticks(library, "Paper2011")
    tick.run(z)
    for where, tolerance in ((fmus.estimator, 0.0), (fmus.pythonfmu, 1e-3)):
        inputs, outputs = subjects.MEASUREMENTS, subjects.OUTPUTS
        master = subjects.Master(library, where, inputs, outputs)
        master.run(z)
        loader = subjects.Fmpy(where)
        loader.run(z.tolist())
        np.testing.assert_allclose(master.outputs, tick.outputs, tolerance, 0, err_msg=str(where))
        np.testing.assert_array_equal(loader.outputs, master.outputs)


def measure(every: list[Subject], rounds: int) -> Times:
    """Time for one piece of work of each subject in each round [ns].

    NaN in a round in which the subject did not run.
    """
    times = {subject.name: np.full(rounds, np.nan) for subject in every}
    for subject in every:
        subject.batch()  # warms caches and branch predictors, loads files
    for k in range(rounds):
        # Each round begins with another subject, so the order is not always the same.
        for subject in every[k % len(every) :] + every[: k % len(every)]:
            if k % subject.every == 0:
                begin = time.perf_counter_ns()
                subject.batch()
                times[subject.name][k] = (time.perf_counter_ns() - begin) / subject.count
    return times


def all_subjects(library: Library, native: Library, fmus: Fmus, samples: int) -> list[Subject]:
    """All subjects whose time is measured."""
    z: Array = subjects.measurements(samples)
    few = samples // 5
    return [
        subjects.peak(library, samples),
        *(s for n in subjects.SIZES for s in subjects.least_squares(library, n, few)),
        *(s for n in subjects.SIZES for s in subjects.native_least_squares(native, n, few)),
        *subjects.ticks(library, fmus, z),
        *subjects.plant(library, fmus, samples),
        *loops.pair(library, fmus, samples),
        *loops.objects(z),
        *loops.whole(z),
        *subjects.table1(15 * samples // 10),
    ]


def footprint(build: Path, method: str, library: Library) -> Footprint:
    """Instructions, stack and memory of one tick of a method."""
    program = str(build / "sigmahat_bench_footprint")

    def output(*command: str) -> str:
        return subprocess.run(command, check=True, capture_output=True, text=True).stdout

    instructions = None
    if shutil.which("valgrind"):
        ticks = 10000
        with tempfile.TemporaryDirectory() as folder:
            written = Path(folder) / "callgrind"
            output(
                *("valgrind", "--tool=callgrind", "--toggle-collect=sh_estimator_tick"),
                *(f"--callgrind-out-file={written}", program, method, str(ticks)),
            )
            summary = next(
                line for line in written.read_text().splitlines() if line.startswith("summary:")
            )
        instructions = int(summary.split()[1]) / ticks
    code = 0
    if shutil.which("size"):
        listed = output("size", str(build / "libsigmahat_bench_estimator.a")).splitlines()[1:]
        code = sum(int(line.split()[0]) for line in listed)
    sizes = (ctypes.c_int * 3)()
    library.function("tick_bytes")(sizes)
    return Footprint(instructions, int(output(program, method)), code, list(sizes))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--build", type=Path, required=True, help="folder in which bench was built")
    parser.add_argument("--out", type=Path, help="folder for the tables and the figure")
    parser.add_argument(
        "--page",
        type=Path,
        help="Markdown page whose tables are replaced; the figure goes to its folder images/",
    )
    parser.add_argument("--check", action="store_true", help="only check that every subject works")
    arguments = parser.parse_args()
    library = Library(arguments.build / "libsigmahat_bench.so")
    native = Library(arguments.build / "libsigmahat_bench_native.so")
    with tempfile.TemporaryDirectory(prefix="sigmahat-bench-") as name:
        fmus = subjects.unpack(Path(name))
        verify(library, native, fmus)
        every = all_subjects(library, native, fmus, 100 if arguments.check else SAMPLES)
        times = measure(every, 1 if arguments.check else ROUNDS)
    footprints = {
        method: footprint(arguments.build, method, library) for method in subjects.METHODS
    }
    if arguments.check:
        print(f"{len(times)} subjects work")
        return
    text = table(times, footprints)
    print(text)
    if arguments.out:
        arguments.out.mkdir(parents=True, exist_ok=True)
        (arguments.out / "bench.md").write_text(text, encoding="utf-8")
        figure(times).savefig(arguments.out / "bench.png", dpi=150)
        print(f"Figure: {arguments.out / 'bench.png'}")
    if arguments.page:
        update(arguments.page, "bench", text)
        figure(times).savefig(arguments.page.parent / "images" / "bench.png", dpi=150)


if __name__ == "__main__":
    main()
