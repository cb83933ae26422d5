"""The report of a log begins with the result, and has the same numbers as the command."""

import json
import re
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pyarrow as pa
import pytest
from pydantic import TypeAdapter

from browser import DATA, ROWS, Page, opened
from command_line import Shell, working_in
from recorded_logs import REGRESSION, awas_log, write_log
from sigmahat.checks.findings import Finding, Kind, Severity
from sigmahat.recording.notes import RecordingNote
from sigmahat.result.curve import CURVE
from sigmahat.show.style import limits

GAP = slice(20_000, 20_200)
SPIKE = 5.0
SKIPPED = 201 + 119  # the samples after the spike, which is the first one after the gap, for 0.12 s
FINDING = Finding(Kind.JUMP, Severity.WRONG, "ports.q.column", 50.0, "deg", about="<q>")
NOTES = TypeAdapter(list[RecordingNote])


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Folder with a log of 60 s that has a gap, a missing value and a row with a wrong value."""
    folder = tmp_path_factory.mktemp("log")
    log = awas_log(1.0, 0.3, 60.0)
    log["q"][GAP.stop] += SPIKE
    log["tau"][40_000] = np.nan
    columns = {name: np.delete(values, GAP) for name, values in log.items()}
    with working_in(folder):
        write_log(columns, Path("knee.parquet"), REGRESSION + "prior.B = 0.2\n")
        answer = Shell().run("estimate knee.parquet --out out --json")
        Path("answer.json").write_text(answer)
        notes = json.loads(Path("out/estimate.json").read_text())
        notes["findings"] = [FINDING.as_dict()]
        Path("out/estimate.json").write_text(json.dumps(notes))
        Shell().run("report out")
    return folder


@pytest.fixture(scope="module")
def page(folder: Path) -> Iterator[Page]:
    with opened(folder / "out" / "report.html") as page:
        yield page


def test_the_band_is_that_of_the_file(folder: Path, page: Page) -> None:
    table = pa.csv.read_csv(folder / "out" / CURVE)
    first = table["setPoint [1]"].to_numpy() == table["setPoint [1]"].to_numpy()[0]
    for plot, name in enumerate(("tau_e [N.m]", "sigma [N.m/rad]")):
        quantity, unit = name.split(" ")
        trace = f"trace-{plot}-0"
        for end in ("", "low", "high"):
            drawn = page.run(DATA, trace, f"{trace}-{end}".removesuffix("-"))
            column = f"{quantity} {end} {unit}" if end else name
            assert np.array_equal(drawn, table[column].to_numpy()[first])


def test_ticks_notes_parameters_and_findings(folder: Path, page: Page) -> None:
    answer = json.loads((folder / "answer.json").read_text())
    sheet = json.loads((folder / "out" / "joint.json").read_text())
    assert answer["skipped"] == SKIPPED
    text = page.run("return document.body.textContent")
    parameters = page.run(ROWS, "Joint and motor")
    findings = page.run(ROWS, "Checks")
    every = page.run(ROWS, "Parameters of the estimator")
    assert f"{SKIPPED} of {answer['ticks']} ticks skipped, a tick every 0.001 s" in text
    for note in NOTES.validate_python(answer["notes"]):
        assert note.in_words in text
    assert findings == ["wrong ports.q.column: <q> jumps by 50 deg, as a counter that starts again"]
    inertia = sheet["parameters"]["B"]
    low, high = inertia["interval"]
    (row,) = (row for row in parameters if " B " in row)
    assert f"{inertia['value']:.4g} kg·m² {low:.4g} to {high:.4g}" in row
    assert "method FilteredRegression" in every
    assert not any("eta_0" in row for row in every)


def test_a_spike_after_a_gap_does_not_set_a_scale(page: Page) -> None:
    ranges = page.run("""
        return Bokeh.documents[0].roots().map(p =>
          [p.below[0].axis_label, p.left[0].axis_label,
           p.x_range.start, p.x_range.end, p.y_range.start, p.y_range.end]);""")
    deformation = [r for r in ranges if r[1].startswith("deformation")]
    assert len(deformation) == 1
    assert max(map(abs, deformation[0][4:])) < 0.3 < SPIKE
    assert all(max(map(abs, r[2:4])) < 0.3 for r in ranges if r[0].startswith("deformation"))


def test_limits_keep_what_belongs_to_the_signal() -> None:
    x = np.sin(np.linspace(0, 20, 10_001))
    assert limits(x) == (x.min(), x.max())
    spiked = np.append(x, [1e6, np.nan])
    low, high = limits(spiked)
    assert low == x.min() and x.max() < high < 3
    assert limits(np.array([np.nan])) == (0.0, 1.0)
    step = np.append(np.zeros(10_000), 1.0)  # a single step is no outlier
    assert limits(step) == (0.0, 1.0)


@pytest.mark.parametrize(
    ("name", "text", "words"),
    [
        ("estimate.json", "{", "cut off|no JSON|something else"),
        ("joint.json", None, "name the folder or the joint.json"),
        (CURVE, "a,b\n1,2\n", "expected a stiffness curve"),
        ("estimate.points.csv", "a,b\n1,2\n", "no numbers in column"),
        ("estimate.json", '{"format": "x"}', "expected the estimate.json"),
        ("estimate.json", ('"kind": "rows"', '"kind": "x"'), "damaged: notes"),
        ("estimate.json", ('"severity": "wrong"', '"severity": "x"'), "damaged: findings"),
        ("estimate.json", ('"version": 3', '"version": 2'), "expected version 3 .* got 2"),
    ],
)
def test_a_damaged_file_is_named(
    name: str, text: str | tuple[str, str] | None, words: str, folder: Path, shell: Shell
) -> None:
    for path in (folder / "out").iterdir():
        if path.suffix != ".html":
            Path(path.name).symlink_to(path)
    Path(name).unlink()
    if isinstance(text, tuple):
        text = (folder / "out" / name).read_text().replace(*text)
    if text is not None:
        Path(name).write_text(text)
    line = shell.refused("report .")
    assert name in line and re.search(words, line)
