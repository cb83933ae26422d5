"""Makes examples/health/results.jsonl: python -m health.example FILE.

60 logs of a joint that was not used in the study, one a day. From the 41st on, its spring is 6 %
softer.
"""

import hashlib
import sys
from dataclasses import asdict
from datetime import datetime, timedelta, timezone
from pathlib import Path

from health.joints import HEALTHY, TORQUE_GAIN, Wear, drawn_joint
from sigmahat.health.logs import LogResult
from sigmahat.health.read import write_table

JOINT, LOGS, SOFT_FROM = 4, 60, 40
_BEGIN = datetime(2026, 3, 2, 6, 30, tzinfo=timezone.utc)


def main(path: Path) -> None:
    joint, results = drawn_joint(JOINT), []
    for day in range(LOGS):
        wear = HEALTHY if day < SOFT_FROM else Wear(spring=-0.06)
        (estimates, excitation), _ = joint.log(day + 1, wear, motion=1)
        digest = hashlib.sha256(repr(asdict(estimates)).encode()).hexdigest()
        time = _BEGIN + timedelta(days=day)
        place = f"logs/{time:%Y-%m-%d}"
        of_log = ("knee", time, place, [digest], estimates, excitation, TORQUE_GAIN, "None")
        results.append(LogResult(*of_log))
    write_table(results, path)


if __name__ == "__main__":
    main(Path(sys.argv[1]))
