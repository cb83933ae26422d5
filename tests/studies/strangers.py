"""Fuzzes what reads logs, configurations and plans, for as long as is asked; run by hand.

    PYTHONPATH=tests/helpers python tests/studies/strangers.py --minutes 30 --keep findings

Prints every finding: an input after which a command ends otherwise than with an answer or one line
of error, or takes over 5 s of a processor or 1 GB. Its files are kept in the folder --keep. At the
end it prints the number of inputs, the longest time and the largest memory.
"""

from __future__ import annotations

import argparse
import random
import time
from collections import Counter
from pathlib import Path

from hypothesis import HealthCheck, Phase, given, seed, settings

from confined import Confined
from strange_files import TRIALS, Trial

_AT_A_TIME = 100  # inputs between two looks at the clock


def main() -> None:
    """Reads the arguments, and fuzzes."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--minutes", type=float, default=30.0)
    parser.add_argument("--keep", type=Path, required=True, help="folder for findings")
    arguments = parser.parse_args()
    end = time.monotonic() + 60.0 * arguments.minutes
    inputs, findings, longest, largest = Counter[str](), Counter[str](), 0.0, 0.0
    with Confined() as confined:

        def show(trial: Trial) -> None:
            nonlocal longest, largest
            done = trial.run(confined)
            inputs[f"{trial.arguments[0]}: {'an answer' if done.status < 2 else 'refused'}"] += 1
            longest, largest = max(longest, done.seconds), max(largest, done.megabytes)
            complaint = done.complaint()
            if complaint is not None and not findings[complaint[-200:]]:
                folder = arguments.keep / f"{len(findings)}-{trial.arguments[0]}"
                folder.mkdir(parents=True)
                for name, content in trial.files.items():
                    (folder / name).write_bytes(content)
                print(f"{folder}: {' '.join(trial.arguments)}: {complaint}", flush=True)
            findings.update([] if complaint is None else [complaint[-200:]])

        options = settings(
            max_examples=_AT_A_TIME,
            deadline=None,
            database=None,
            phases=[Phase.generate],
            suppress_health_check=list(HealthCheck),
        )
        while time.monotonic() < end:
            options(seed(random.getrandbits(64))(given(TRIALS)(show)))()
            print(f"{inputs.total()} inputs, {len(findings)} findings", flush=True)
    print(f"{dict(inputs)}; at most {longest:.2f} s and {largest:.0f} MB; {dict(findings)}")


if __name__ == "__main__":
    main()
