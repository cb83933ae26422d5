"""Runs all methods on all joints, writes results and tables: python -m rivals.run --help.

After an interruption, the same command does the missing joints. Needs the folders bench/ and
harness/ on the path, as in cmake --workflow --preset rivals.
"""

import argparse
import sys
from functools import partial
from pathlib import Path

from rivals.draw import KINDS
from rivals.methods import METHODS
from rivals.plan import Rivals
from rivals.simulation import make
from sigmahat.experiments import benchmark
from sigmahat.experiments.engine import study


def made(kind: str, seed: int) -> benchmark.LogWithTruth:
    """Simulates a joint, and returns its log for a benchmark."""
    return make(kind, seed).with_truth


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument(
        "--seeds",
        type=int,
        nargs=2,
        metavar=("FIRST", "LAST"),
        default=(1, 5),
        help="of the joints; default: 1 5, which methods may be developed with",
    )
    parser.add_argument("--kinds", nargs="+", choices=KINDS, default=KINDS)
    parser.add_argument("--methods", nargs="+", choices=METHODS, default=list(METHODS))
    parser.add_argument("--jobs", type=int, default=1, help="processes; default: %(default)s")
    parser.add_argument("--out", type=Path, required=True, help="folder for results and tables")
    parser.add_argument(
        "--logs",
        action="store_true",
        help="write the logs with their truth into the folder, as a benchmark, and run no method",
    )
    arguments = parser.parse_args()
    first, last = arguments.seeds
    seeds = range(first, last + 1)
    if arguments.logs:
        makers = [partial(made, kind, seed) for kind in arguments.kinds for seed in seeds]
        benchmark.write(makers, arguments.out, arguments.jobs)
        return
    plan = Rivals(arguments.kinds, seeds, arguments.methods)
    done = 0

    def show(joints: int) -> None:
        nonlocal done
        done += joints
        print(f"{done} of {len(plan.jobs)} joints", file=sys.stderr, flush=True)

    print(plan.text(study(plan, arguments.out, arguments.jobs, progress=show)))


if __name__ == "__main__":
    main()
