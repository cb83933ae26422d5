"""Runs all methods on all joints, writes results and tables: python -m rivals.run --help.

Needs the folders bench/ and harness/ on the path; cmake --workflow --preset rivals sees to it.
"""

from __future__ import annotations

import argparse
import math
from collections.abc import Callable, Iterable
from concurrent.futures import ProcessPoolExecutor
from functools import partial
from itertools import product
from pathlib import Path

from rivals.joints import make
from rivals.methods import METHODS
from rivals.records import Estimate, JointLog
from rivals.result import Result, write_results
from rivals.score import score
from rivals.table import page

KINDS = ("series_elastic", "variable_stiffness", "arm")
ENGINES = ("mujoco", "drake")
DEVELOPMENT = (1, 5)
"""Seeds on which methods may be looked at while they are written."""


def judge(method: str, estimate: Callable[[JointLog], Estimate], log: JointLog) -> Result:
    """Result of a method on a log. A method that raises an exception has no answer."""
    result = partial(Result, log.kind, log.engine, log.seed, method)
    try:
        found = estimate(log)
        if found.remark:
            return result(found.seconds, None, found.remark)
        return result(found.seconds, score(log, found), "")
    except Exception as error:  # whatever a rival raises is a row of the table
        return result(math.nan, None, f"{type(error).__name__}: {error}")


def run_joint(joint: tuple[str, str, int]) -> list[Result]:
    """Results of all methods on the joint of this kind, engine and seed."""
    log = make(*joint)
    return [judge(name, estimate, log) for name, estimate in METHODS.items()]


def run(joints: Iterable[tuple[str, str, int]], jobs: int) -> list[Result]:
    """Results of all methods on all joints, in this order, in so many processes."""
    with ProcessPoolExecutor(jobs) as pool:
        return [result for results in pool.map(run_joint, joints) for result in results]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument(
        "--seeds",
        type=int,
        nargs=2,
        metavar=("FIRST", "LAST"),
        default=DEVELOPMENT,
        help="of the joints, from 0 on; default: %(default)s",
    )
    parser.add_argument("--kinds", nargs="+", choices=KINDS, default=KINDS)
    parser.add_argument("--engines", nargs="+", choices=ENGINES, default=ENGINES)
    parser.add_argument("--jobs", type=int, default=1, help="processes; default: %(default)s")
    parser.add_argument("--out", type=Path, required=True, help="folder for results and tables")
    arguments = parser.parse_args()
    first, last = arguments.seeds
    joints = list(product(arguments.kinds, arguments.engines, range(first, last + 1)))
    results = run(joints, arguments.jobs)
    text = page(results)
    arguments.out.mkdir(parents=True, exist_ok=True)
    write_results(arguments.out / "rivals.csv", results)
    (arguments.out / "rivals.md").write_text(text, encoding="utf-8")
    print(text)


if __name__ == "__main__":
    main()
