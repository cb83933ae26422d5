"""Measures all times in one run and writes tables: python bench/run.py --help."""

import argparse
import ctypes
import time
from pathlib import Path

import numpy as np

import subjects
from report import Times, table
from sigmahat.fmi.instance import installed
from subjects import Subject

ROUNDS = 101
SAMPLES = 10000  # one period of the torques


def verify(library: ctypes.CDLL) -> None:
    """Checks that all subjects compute the same results.

    Raises AssertionError, which names the subject with other results.
    """
    for size in subjects.SIZES:
        F, y = subjects.regression(size, 2000)
        closed_form = np.linalg.solve(np.eye(size) / subjects.P_0 + F.T @ F, F.T @ y)
        for make in subjects.MAKES:
            rls = subjects.recursion(library, make, size)
            rls.run(F, y)
            np.testing.assert_allclose(rls.outputs, closed_form, 0, 1e-9, err_msg=make)

    z = subjects.measurements(500)
    tick = subjects.tick(library, "Paper2011")
    tick.run(z)
    fmu = installed("StiffnessEstimator")
    steps = subjects.Steps(fmu, subjects.MEASUREMENTS, subjects.OUTPUTS, z)
    steps.run()
    np.testing.assert_array_equal(steps.outputs, tick.outputs)


def measure(every: list[Subject], rounds: int) -> Times:
    """Measures the time for one unit of work of each subject in each round [ns].

    The time is NaN in a round in which the subject did not run.
    """
    times = {subject.name: np.full(rounds, np.nan) for subject in every}
    for k in range(rounds):
        # Each round begins with another subject, so that the order varies.
        for subject in every[k % len(every) :] + every[: k % len(every)]:
            if k % subject.every == 0:
                # Not timed: a subject that follows another one with the same data would otherwise
                # find caches and branch predictors warm, and the first of them would not.
                subject.batch()
                begin = time.perf_counter_ns()
                subject.batch()
                times[subject.name][k] = (time.perf_counter_ns() - begin) / subject.count
    return times


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--build", type=Path, required=True, help="folder in which bench was built")
    parser.add_argument("--out", type=Path, help="folder for the tables")
    parser.add_argument("--check", action="store_true", help="only check that every subject works")
    arguments = parser.parse_args()
    library = ctypes.CDLL(str(arguments.build / "libsigmahat_bench.so"))
    verify(library)
    samples = 100 if arguments.check else SAMPLES
    z = subjects.measurements(samples)
    every = [
        *(s for n in subjects.SIZES for s in subjects.least_squares(library, n, samples // 5)),
        *subjects.ticks(library, z),
        *subjects.plant(samples),
        *subjects.objects(z),
        *subjects.whole(z),
        subjects.table1(15 * samples // 10),
    ]
    times = measure(every, 1 if arguments.check else ROUNDS)
    if arguments.check:
        print(f"{len(times)} subjects work")
        return
    text = table(times)
    print(text)
    if arguments.out:
        arguments.out.mkdir(parents=True, exist_ok=True)
        (arguments.out / "bench.md").write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main()
