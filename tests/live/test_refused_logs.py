"""A log that the page cannot take is refused in one line that says why."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from live_page import LivePage, csv, live_page
from recorded_logs import Array


@pytest.fixture(scope="module")
def page(site: Path) -> Iterator[LivePage]:
    with live_page(site / "live") as page:
        yield page


def good() -> dict[str, Array]:
    """Columns of a log without a fault."""
    t = 0.001 * np.arange(200)
    return {"time": t, "theta": np.sin(t), "q": 1.002 * np.sin(t), "tau": 0.05 * np.cos(t)}


_NAMES = "t,theta,q,tau\n"
REFUSED = {
    "empty": ("", "expected a CSV file with numbers, the file is empty"),
    "blank": ("\n\n", "the file is empty"),
    "prose": ("Dear all,\nsee you\n", 'expected at least 4 columns .* got 2: "Dear all,"'),
    "few columns": ("time,q\n" + "1,2\n" * 200, "expected at least 4 columns .* got 2"),
    "no names": ("0,1,2,3\n" * 200, "names of the columns above the numbers, got the number 0"),
    "text": (_NAMES + "a,b,c,d\n" * 200, 'numbers in at least 4 columns, got "a,b,c,d" in row 2'),
    "units": (
        _NAMES + "s,rad,rad,Nm\n" + "1,2,3,4\n" * 200,
        r"row 2 has no numbers \(units\?\): delete",
    ),
    "comments": ("#\n# of today\n", "the file is empty"),
    "units below a comment": (
        "# of today\n" + _NAMES + "s,rad,rad,Nm\n" + "1,2,3,4\n" * 200,
        "row 3 has no numbers",
    ),
    "short": (_NAMES + "1,2,3,4\n" * 5, "100 to 1 million rows below the names, got 5"),
    "quoted names": (
        'time,"theta, motor",q,tau,x\n' + "1,2,3,4,5,6\n" * 200,
        "row 2: expected 5 cells, one for each name, got 6",
    ),
    "twice": ("t,q,q,tau\n" + "1,2,3,4\n" * 200, 'name of its own for each column, got "q" twice'),
    "binary": ("PK\3\4\0\0\n", "expected text with separated values, got a binary file"),
}
"""What is wrong with a file, and what the page says."""


@pytest.mark.parametrize("case", REFUSED)
def test_a_bad_file_is_refused_in_one_line(case: str, page: LivePage) -> None:
    text, expected = REFUSED[case]
    message = page.drops(text)
    assert message.startswith("log.csv: ") and "\n" not in message
    assert re.search(expected, message), message


def test_a_huge_file_is_refused_before_it_is_read(page: LivePage) -> None:
    script = "try { checkSize({ size: 3e9 }); } catch (error) { return error.message; }"
    assert page.page.run(script).startswith("expected at most 100 MB, the file has 3000 MB")


def with_value(values: Array, place: int, value: float) -> Array:
    """A copy with another value in a place."""
    changed: Array = values.copy()
    changed[place] = value
    return changed


_TIME, _TAU = good()["time"], good()["tau"]
BAD_COLUMNS = {
    "no torque": ({"tau": 0 * _TAU}, "tau: expected a torque that changes, got 0 N·m in all rows"),
    "nan": (
        {"tau": with_value(_TAU, 50, np.nan)},
        'row 52, column tau: expected a finite number, got "nan"',
    ),
    "backwards": ({"time": -_TIME}, "time: expected times that rise, got 0 s first"),
    "constant": ({"time": 0 * _TIME}, "time: expected times that rise, got 0 s first and 0 s last"),
    "uneven": (
        {"time": with_value(_TIME, 70, 0.0712)},
        "time: expected steps of about 0.001 s as in the mean, got 0.0022 s in row 72;",
    ),
}
"""Columns instead of good ones, and how the message begins."""


@pytest.mark.parametrize("case", BAD_COLUMNS)
def test_a_bad_column_is_named(case: str, page: LivePage) -> None:
    columns, expected = BAD_COLUMNS[case]
    assert page.drops(csv({**good(), **columns})) == ""
    assert page.estimates({"motor.gamma": 50}).startswith(expected)


@pytest.mark.parametrize(
    ("fields", "expected"),
    [
        ({"tau column": ""}, "tau: choose its column"),
        ({"theta gear": 0}, "theta: expected a gear ratio above 0, got 0"),
        ({"q unit": "counts", "q per": ""}, "q: expected a number above 0 for counts per turn"),
        ({"q zero": ""}, "q: expected a number as zero"),
        ({"motor.gamma": ""}, "motor.gamma: fill in the gear ratio of your joint"),
        ({"rls.n": 2.5}, "rls.n: expected a whole number, got 2.5"),
        ({"rls.n": 6, "motor.gamma": 0}, "motor.gamma = 0 "),  # the FMU says it
        ({"motor.B": -1}, "Parameter motor.B = -1 is out of its range"),
        ({"q column": "theta"}, "theta and q do not differ: choose another column"),
        ({"q column": "theta", "q zero": 0.1}, "expected a deformation that changes, got "),
        ({"time unit": "us"}, "Is the unit of the time right?"),
        ({"time unit": "ns"}, "Parameter samplePeriod = 1e-12 is out of its range"),
        ({"theta gear": 1e-9}, "range.phi = 237226998 is out of its range"),
    ],
    ids=lambda value: "-".join(value) if isinstance(value, dict) else "",
)
def test_a_bad_field_is_named(fields: dict[str, object], expected: str, page: LivePage) -> None:
    assert page.drops(csv(good())) == ""
    assert expected in page.estimates({"motor.gamma": 50, **fields})


def test_what_is_guessed_is_called_so(page: LivePage) -> None:
    assert page.drops(csv({**good(), "q": 1e9 * _TAU})) == ""
    assert page.estimates({"motor.gamma": 50}).endswith("or fill it in.")
    assert "guessed" not in page.estimates({"range.phi": 1e9})


def test_a_gear_that_turns_backwards(page: LivePage) -> None:
    """A negative gear ratio is one: the guess of the largest torque takes its size."""
    assert page.drops(csv(good())) == ""
    assert page.estimates({"motor.gamma": -50}) == ""
