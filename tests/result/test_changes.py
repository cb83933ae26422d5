"""Time and size of a change of the stiffness in a log, as printed text and in the report."""

import json
from pathlib import Path

import numpy as np
import pytest

from browser import opened
from command_line import Shell
from recorded_logs import REGRESSION, read_estimate, recorded, write_log
from regression_joint import Joint
from sigmahat.result.curve_of_log import since_change
from sigmahat.result.headline import StiffnessChange
from sigmahat.result.replayed_log import Changes

MARKS = """
return [...Bokeh.documents[0]._all_models.values()]
  .filter(m => m.type === "Span").map(m => m.location);
"""


def test_a_step_has_its_time_its_size_and_its_mark(shell: Shell) -> None:
    joint = Joint(duration=24.0, stiffness=lambda t: np.where(t < 12.0, 1.0, 0.5))
    write_log(recorded(joint), Path("log.parquet"), REGRESSION)
    (change,) = shell.json("estimate log.parquet --out out")["changes"]
    assert 12.0 < change["t"] < 17.0
    assert change["relative"] == pytest.approx(-0.5, abs=0.05)
    words = f"the stiffness changed by {100 * change['relative']:+.0f} % at {change['t']:.4g} s"
    (written,) = json.loads(Path("out/estimate.json").read_text())["changes"]
    assert StiffnessChange(**written).in_words == words
    # THEN the table of estimates has no coefficients, and the report marks the time of the change
    assert not any("eta[" in name for name in read_estimate(Path("out")).column_names)
    shell.run("report out --quiet")
    with opened(Path("out/report.html").absolute()) as page:
        marks = np.array(page.run(MARKS))
        assert len(marks) > 3 and np.allclose(marks, change["t"])
        text = page.run("return document.body.textContent")
    assert words in text and "Dotted lines mark changes of the stiffness" in text


def test_the_size_needs_a_confident_estimate_before_and_after() -> None:
    """GIVEN a stiffness of 10 + 2 phi setPoint, which changes to 30 + 2 phi setPoint."""
    changes = Changes({"rls.n": 3, "rls.m": 2, "rls.symmetric": False}, 0.5)
    outputs = {name: np.zeros(8) for name in changes.names} | {
        "eta[1,0]": np.repeat([10.0, 30.0], 4),
        "eta[2,1]": np.ones(8),
        "change_age": np.array([-1.0, -1.0, -1.0, -1.0, 0.0, 0.0, 0.5, 0.0]),
        "confident": np.array([False, True, False, False, False, False, True, False]),
        "phi": np.full(8, 2.0),
        "setPoint": np.full(8, 2.0),
    }
    # THEN the restart at 2.5 s belongs to the change at 2 s, as the estimate had not adapted yet
    for part in (slice(0, 5), slice(5, 8)):
        changes.add({name: values[part] for name, values in outputs.items()})
    first, second = changes.found
    assert first.t == 2.0 and first.relative == pytest.approx(38.0 / 18.0 - 1)
    assert first.in_words == "the stiffness changed by +111 % at 2 s"
    assert second.t == 3.5 and second.relative is None
    assert second.in_words == "the stiffness changed at 3.5 s, by how much is not known"


def test_deformations_of_before_the_last_change_are_not_in_the_data() -> None:
    outputs = {
        "change_age": np.array([-1.0, -1.0, 0.0, 0.5, 0.0, 0.5]),
        "phi": np.arange(6.0),
        "valid": np.ones(6, dtype=bool),
        "a": np.array([1.0, 1.0, 1.0, 1.0, 0.0, 1.0]),
    }
    assert list(since_change(outputs)["phi"]) == [4.0, 5.0]
    # WHEN no sample was used after the change, THEN all deformations remain in the data.
    outputs["a"][5] = 0.0
    assert list(since_change(outputs)["phi"]) == list(range(6))
    outputs["change_age"][:] = -1.0
    assert list(since_change(outputs)["phi"]) == list(range(6))
    # WHEN the stiffness changed in an earlier log, THEN all deformations of the new log are used
    outputs["change_age"][:] = np.arange(7.0, 13.0)
    assert list(since_change(outputs)["phi"]) == list(range(6))
