"""Runs all methods on all joints, writes results and tables: python -m rivals.run --help.

Needs the folders bench/ and harness/ on the path; cmake --workflow --preset rivals sees to it.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterable, Sequence
from concurrent.futures import ProcessPoolExecutor
from functools import partial
from pathlib import Path

from rivals.joints.catalogue import KINDS, make
from rivals.methods import METHODS
from rivals.score import Result, judge, write_results
from rivals.table import page


def run_joint(methods: Sequence[str], joint: tuple[str, int]) -> list[Result]:
    """Results of the methods on the joint of this kind and seed."""
    log = make(*joint)
    return [judge(name, METHODS[name], log) for name in methods]


def run(joints: Iterable[tuple[str, int]], methods: Sequence[str], jobs: int) -> list[Result]:
    """Results of the methods on all joints, in this order, in so many processes."""
    every: list[Result] = []
    with ProcessPoolExecutor(jobs) as pool:
        for results in pool.map(partial(run_joint, methods), joints):
            every += results
            print(results[0].kind, results[0].seed, file=sys.stderr, flush=True)
    return every


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
    arguments = parser.parse_args()
    first, last = arguments.seeds
    joints = [(kind, seed) for kind in arguments.kinds for seed in range(first, last + 1)]
    results = run(joints, arguments.methods, arguments.jobs)
    text = page(results)
    arguments.out.mkdir(parents=True, exist_ok=True)
    write_results(arguments.out / "rivals.csv", results)
    (arguments.out / "rivals.md").write_text(text, encoding="utf-8")
    print(text)


if __name__ == "__main__":
    main()
