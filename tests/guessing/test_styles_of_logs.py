"""`sigmahat init` on logs in many styles: from the log to the right stiffness with few edits.

The joints are simulated outside of the package. After `init`, values of the data sheet are filled
in, and at most three other keys may be edited.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
import tomlkit

from log_styles import STYLES, Style
from sigmahat.cli import main
from sigmahat.logs.configuration import read_configuration
from sigmahat.logs.estimate import Estimate, estimate
from sigmahat.logs.readers.formats import open_log

MOST_EDITS = 3
ACCURACY = 0.04
"""A few per cent: what the estimator reaches with these logs is another matter."""


def edited(text: str, values: dict[str, Any]) -> str:
    """A configuration with values for dotted keys; [parameters] is left out of their names."""
    document = tomlkit.parse(text)
    for key, value in values.items():
        group, *names = key.split(".")
        table: Any = document["ports"] if group == "ports" else document["parameters"]
        for name in names[:-1] if group == "ports" else [group, *names[:-1]]:
            table = table.setdefault(name, tomlkit.table())
        table[names[-1]] = value
    return tomlkit.dumps(document)


def answer(style: Style, folder: Path) -> Estimate:
    """All commands from the log to the estimate, as a user types them."""
    log = style.write(style.log(style.motion), folder / style.file)
    chosen = ["--joint", style.joint] if style.joint else []
    assert main(["init", str(log), "--quiet", *chosen]) == 0
    path = folder / f"{log.stem}.toml"
    found = read_document(path)
    ports = {name: (each["column"], each.get("unit")) for name, each in found["ports"].items()}
    assert ports == style.ports
    path.write_text(edited(path.read_text(), {**style.sheet, **style.edits}))
    assert main(["identify", str(log), "--quiet"]) == 0
    (folder / "out").mkdir()
    return estimate(open_log(log), read_configuration(path), folder / "out")


def read_document(path: Path) -> dict[str, Any]:
    return tomlkit.parse(path.read_text()).unwrap()


@pytest.mark.parametrize("style", STYLES, ids=lambda style: style.name)
def test_from_log_to_stiffness(
    style: Style, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    result = answer(style, tmp_path)
    assert len(style.edits) <= MOST_EDITS
    true = style.motion.stiffness
    assert result.sigma == pytest.approx(true[result.ticks - 1], rel=ACCURACY)
