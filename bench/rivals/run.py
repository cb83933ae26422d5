"""Runs all methods on all joints, writes results and tables: python -m rivals.run --help.

Needs the folders bench/ and harness/ on the path, as in cmake --workflow --preset rivals.
"""

import argparse
import sys
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor
from functools import partial
from pathlib import Path

from rivals.draw import KINDS
from rivals.methods import METHODS
from rivals.score import RESULT, Result, judge, page
from rivals.simulation import make
from sigmahat.files.tables import write_csv


def run_joint(methods: Sequence[str], joint: tuple[str, int]) -> list[Result]:
    """Computes the results of all methods on the joint of the given kind and seed."""
    log = make(*joint)
    return [judge(name, METHODS[name], log) for name in methods]


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
    results: list[Result] = []
    with ProcessPoolExecutor(arguments.jobs) as pool:
        for found in pool.map(partial(run_joint, arguments.methods), joints):
            results += found
            print(found[0]["kind"], found[0]["seed"], file=sys.stderr, flush=True)
    text = page(results)
    arguments.out.mkdir(parents=True, exist_ok=True)
    rows = ([result.get(name) for name in RESULT] for result in results)
    write_csv(arguments.out / "rivals.csv", RESULT, rows)
    (arguments.out / "rivals.md").write_text(text, encoding="utf-8")
    print(text)


if __name__ == "__main__":
    main()
