"""Simulates the logs of the study: python -m health.simulate --joints 100 103 --out FOLDER.

Writes one file of JSON Lines a joint, with the estimates of each log. A joint that has its file is
left out. Needs the folders bench/ and harness/ on the path.
"""

import argparse
import json
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from pathlib import Path

from health.joints import HEALTHY, Wear, drawn_joint
from sigmahat.files.output import write_whole

JOINTS = range(100, 108)
"""Numbers of the joints of the study. The method was developed with the joints 0 to 2."""


@dataclass(frozen=True)
class Condition:
    """Logs of one joint under the same condition."""

    wear: Wear
    logs: int
    motion: int | None = None  # as for DrawnJoint.log()


CONDITIONS: Mapping[str, Condition] = {
    "healthy": Condition(HEALTHY, 250),
    "one motion": Condition(HEALTHY, 30, motion=1),
    "another motion": Condition(HEALTHY, 30, motion=2),
    "payload": Condition(Wear(payload=2.0), 30),
    "friction": Condition(Wear(friction=0.3), 30),
    "gain": Condition(Wear(gain=-0.05), 30),
    **{f"spring {share}": Condition(Wear(spring=share), 30) for share in (-0.025, -0.05)},
    **{f"spring {share}": Condition(Wear(spring=share), 30) for share in (-0.075, -0.1)},
    **{f"gap {gap:g}": Condition(Wear(gap=gap), 10) for gap in (2e-4, 4e-4, 6e-4, 8e-4, 1e-3)},
}


def simulate(number: int) -> str:
    """Returns the logs of a joint under all conditions as JSON Lines."""
    joint, log = drawn_joint(number), 0
    lines: list[str] = []
    for name, condition in CONDITIONS.items():
        for _ in range(condition.logs):
            log += 1
            both = joint.log(log, condition.wear, condition.motion)
            line: dict[str, object] = {"joint": number, "log": log, "condition": name}
            for priors, (estimates, excitation) in zip(("unknown", "exact"), both, strict=True):
                line[priors] = {**asdict(estimates), "excitation": asdict(excitation)}
            lines.append(json.dumps(line))
    return "\n".join(lines) + "\n"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--joints", type=int, nargs=2, metavar=("FIRST", "LAST"), required=True)
    parser.add_argument("--out", type=Path, required=True, help="folder for the files")
    arguments = parser.parse_args()
    first, last = arguments.joints
    arguments.out.mkdir(parents=True, exist_ok=True)
    for number in range(first, last + 1):
        path = arguments.out / f"{number}.jsonl"
        if not path.exists():
            write_whole(simulate(number), path)
            print(path, flush=True)


if __name__ == "__main__":
    main()
