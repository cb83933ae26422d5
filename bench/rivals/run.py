"""Runs all methods on all joints, writes results and table: python -m rivals.run --help.

Needs the folders bench/ and harness/ on the path; cmake --workflow --preset rivals sees to it.
"""

from __future__ import annotations

import argparse
import itertools
import sys
from functools import partial
from pathlib import Path

from rivals.methods import METHODS
from rivals.score import Result, page, score
from rivals.simulation import make
from sigmahat.files.tables import write_csv
from sigmahat.runs.engine import run_all


def run_joint(seed: int) -> list[Result]:
    """Results of all methods on the joint with this seed."""
    log = make(seed)
    results = []
    for method, estimate in METHODS.items():
        found = estimate(log)
        about = {"seed": seed, "method": method, "seconds": found.seconds}
        results.append({**about, **score(log, found)})
    return results


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
    parser.add_argument("--out", type=Path, required=True, help="folder for results and table")
    arguments = parser.parse_args()
    first, last = arguments.seeds
    jobs = [partial(run_joint, seed) for seed in range(first, last + 1)]
    done = itertools.count(1)

    def progress(_: int) -> None:
        print(f"{next(done)} of {len(jobs)}", file=sys.stderr, flush=True)

    results = [each for joint in run_all(jobs, progress=progress) for each in joint]
    text = page(results)
    arguments.out.mkdir(parents=True, exist_ok=True)
    write_csv(arguments.out / "rivals.csv", list(results[0]), (list(r.values()) for r in results))
    (arguments.out / "rivals.md").write_text(text, encoding="utf-8")
    print(text)


if __name__ == "__main__":
    main()
