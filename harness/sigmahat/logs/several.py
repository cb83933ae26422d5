"""Output of `sigmahat estimate` for a log of several joints: a table with rows for each joint.

Each joint also has a folder of its name, with all that `estimate` writes for one joint.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from sigmahat.files.tables import write_csv
from sigmahat.joint.curve import stiffness_in_the_middle
from sigmahat.logs.estimate import Estimate

JOINTS = "joints.csv"
"""Name of the file in the folder of results."""
_TITLES = (
    *("joint", "setPoint", "phi [rad]", "sigma [N.m/rad]", "sigma low [N.m/rad]"),
    *("sigma high [N.m/rad]", "confident"),
)


def write_joints(found: Mapping[str, Estimate], folder: Path) -> None:
    """Writes the stiffness of each joint in the middle of its data, for each setting."""
    write_csv(folder / JOINTS, _TITLES, _rows(found))


def _rows(found: Mapping[str, Estimate]) -> Iterator[list[Any]]:
    for name, each in found.items():
        for branch in each.curve.branches:
            phi, sigma, interval = stiffness_in_the_middle(branch)
            sure = "yes" if each.doubt_at_end == "None" else f"no: {each.doubt_at_end}"
            yield [name, branch.set_point, phi, sigma, *(interval or (None, None)), sure]
