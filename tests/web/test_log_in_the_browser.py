"""A log that is dropped on the page: estimated as in Python, or refused in one line."""

import io
import re
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from selenium.webdriver.common.keys import Keys

import sigmahat
from recorded_logs import Array, awas_log
from sigmahat import guess
from sigmahat.files import toml_file
from sigmahat.fmi.model import Value
from web_page import WebPage, csv, web_page

KNEE_FILE = Path(__file__).parents[2] / "examples" / "tutorial" / "knee.csv"
KNEE = KNEE_FILE.read_text(encoding="utf-8")
NONE = " none"
"""The choice that there is no such column."""
KNEE_FIELDS = {
    "gear ratio": 100,
    **{"time column": "time_s", "time unit": "s"},
    **{"theta column": "motor_counts", "theta unit": "counts", "theta per": 4096},
    **{"theta counter": 16, "theta side": "motor", "theta direction": "same"},
    **{"q column": "link_deg", "q unit": "deg"},
    **{"tau column": "current_A", "tau unit": "A", "tau per": 0.1},
    **{"tau side": "motor", "tau direction": "same", "theta_c column": NONE},
}
"""The choices for the log of the tutorial."""
FIELDS = {
    "gear ratio": 50,
    **{"time column": "time", "time unit": "s"},
    **{"theta column": "theta", "theta unit": "rad"},
    **{"theta side": "joint", "theta direction": "same"},
    **{"q column": "q", "q unit": "rad"},
    **{"tau column": "tau", "tau unit": "N.m", "tau side": "motor", "tau direction": "same"},
    "theta_c column": NONE,
}
"""The choices for a log whose columns have the names and units of the signals."""
RECORD = ["sigma", "sigma_std", "doubt"]
ANSWER = r"Stiffness, with 95 % band: \d+\.\d ± \d\d\.\d N·m/rad at 0 rad \(confident\)\. "
"""Beginning of the result for KNEE."""
_CURVES = """
return Object.fromEntries(log.run.curves().flatMap((curve, i) => Object.entries(curve)
  .map(([name, values]) => [`${name} ${i}`, values.length ? values : [values]])));
"""


def good() -> dict[str, Array]:
    t = 0.001 * np.arange(200)
    return {"time": t, "theta": np.sin(t), "q": 1.002 * np.sin(t), "tau": 0.05 * np.cos(t)}


@pytest.fixture(scope="module")
def page(site: Path) -> Iterator[WebPage]:
    with web_page(site / "web") as page:
        yield page
        assert page.page.complaints() == []
        assert all(url.startswith("file:") for url in page.page.requests())


def parameters(page: WebPage) -> dict[str, Value]:
    """Data that the page gives to the estimator, in the form for `sigmahat.Estimator`."""
    start = dict(page.page.run("return log.starts(log.read())"))
    return {**start, "method": "FilteredRegression", "modality": "Residual"}


def test_the_log_of_the_tutorial(page: WebPage) -> None:
    assert page.drops(KNEE, "knee.csv") == ""
    assert page.estimates(KNEE_FIELDS) == ""
    found = page.columns_of_run(["sigma", "sigma_std"])
    t, counts, degrees, current = np.loadtxt(KNEE_FILE, delimiter=",", skiprows=1).T
    theta = np.unwrap(counts, period=65536) / 4096 * 2 * np.pi / 100
    given = parameters(page)
    assert given["motor.gamma"] == 100  # the gear ratio of theta
    assert given["samplePeriod"] == pytest.approx(t[1] - t[0])
    estimator = sigmahat.Estimator(given, RECORD)
    expected = estimator.run(theta, np.radians(degrees), 0.1 * current)
    for name, values in found.items():
        size = np.ptp(expected[name][1000:])
        assert np.max(np.abs(values - expected[name])[1000:]) < 1e-9 * size, name
    curve = page.arrays(_CURVES)
    phi, sigma, std = (curve[f"{name} 0"] for name in ("phi", "sigma", "sigma_std"))
    for name, values in estimator.evaluate(phi, curve["setPoint 0"][0]).items():
        error = np.max(np.abs(curve[f"{name} 0"] - values))
        assert error < 1e-9 * np.max(np.abs(values)), name
    # The script record.py made this log with the spring tau_e = 300 phi + 25000 phi^3.
    assert np.all(np.abs(sigma - (300 + 75000 * phi**2)) < 3 * std)
    torque = np.abs(curve["tau_e 0"] - (300 * phi + 25000 * phi**3))
    assert np.all(torque <= 3 * curve["tau_e_std 0"] + 1e-9)
    assert np.count_nonzero(phi == 0) == 1 and std.max() < 50
    assert re.match(ANSWER, page.text("answer")), page.text("answer")
    half = (expected["doubt"] == "None")[len(t) // 2 :]
    assert f"the estimator was confident {100 * np.mean(half):.3g} % of" in page.text("answer")


def test_a_negative_stiffness_is_not_confident_and_is_drawn(page: WebPage) -> None:
    assert page.drops(KNEE, "knee.csv") == ""
    assert page.estimates({**KNEE_FIELDS, "tau direction": "opposite"}) == ""
    value, rest = page.text("answer").removeprefix("Stiffness, with 95 % band: ").split(" ", 1)
    assert float(value.replace("\N{MINUS SIGN}", "-")) < 0
    assert "(NegativeStiffness: 100 %)" in rest  # of the second half
    assert "(not confident: NegativeStiffness)" in rest and "(confident)" not in rest
    low, high = page.page.run("return answer.plots[0].content.y")
    sigma = page.columns_of_run(["sigma"])["sigma"]
    assert low < np.min(sigma[len(sigma) // 2 :]) and high >= 0


def test_a_value_has_the_decimals_of_its_band(page: WebPage) -> None:
    for value, half, expected in (
        (303.456, 12.9, "303.5 ± 12.9"),
        (-13.94, 5.474, "-13.94 ± 5.47"),
        (42.7, 1234, "43 ± 1234"),
        (42.7, 9.9996, "42.7 ± 10.0"),
        (0.00123, 0.000012, "0.0012300 ± 0.0000120"),
        (-2.5e7, 3.21e5, "(-2.5000 ± 0.0321)e7"),
    ):
        found = page.page.run("return withBand(...arguments)", value, half)
        assert found.replace("\N{MINUS SIGN}", "-") == expected


def test_an_answer_is_one_to_the_settings_that_are_shown(page: WebPage) -> None:
    for change in ({"motor.B": 1e-5}, {"q unit": "deg"}, {"theta column": "time_s"}):
        assert page.drops(KNEE, "knee.csv") == "" and page.text("answer") == ""
        assert page.estimates(KNEE_FIELDS) == "" and page.text("answer") != ""
        page.fills(change)
        assert page.text("answer") == "", change


def test_parameters_of_one_file_are_not_those_of_the_next(page: WebPage) -> None:
    shown = []
    for _ in range(2):
        assert page.drops(KNEE, "knee.csv") == ""
        shown.append(page.page.run("return parameters.typed()"))
        page.fills({"motor.B": 1, "noise.tau": 2, "rls.symmetric": False})
    assert shown[0] == shown[1]


def test_a_log_with_a_motor_that_sets_the_stiffness(page: WebPage) -> None:
    columns = awas_log(0.4, 0.3)
    assert page.drops(csv(columns)) == ""
    setting = {"theta_c column": "theta_c", "theta_c unit": "rad"}
    page.fills({**FIELDS, "time column": "t", **setting})
    assert page.text("missing") == "Still missing: setPoint.offset, setPoint.scale."
    lever_arm = {"setPoint.offset": 100, "setPoint.scale": -2.5 / (2 * np.pi)}  # in mm
    assert page.estimates({"rls.m": 3, **lever_arm}) == ""
    ports = (columns[name] for name in ("theta", "q", "tau", "theta_c"))
    expected = sigmahat.Estimator(parameters(page)).run(*ports)
    (sigma,) = page.columns_of_run(["sigma"]).values()
    error = np.abs(sigma - expected["sigma"])[1000:]
    assert np.max(error) < 1e-9 * np.ptp(expected["sigma"][1000:])
    curves = page.arrays(_CURVES)
    settings = [curves[f"setPoint {i}"][0] for i in range(3)]
    assert settings[0] < settings[1] < settings[2]
    for i, setting in enumerate(settings):  # (29), of the lever arm in mm
        phi, found, std = (curves[f"{name} {i}"] for name in ("phi", "sigma", "sigma_std"))
        true = 2 * 14220 * (setting / 1000) ** 2 * np.cos(2 * phi)
        assert np.all(np.abs(found - true) < 3 * std)


def test_decimal_commas_quotes_and_units(page: WebPage) -> None:
    t = 0.001 * np.arange(200)
    lines = ["Zeit_ms;Motor_Winkel_deg;Abtrieb_Winkel_deg;Drehmoment_mNm"]
    lines += [f'{1000 * x:g};"{x:.6f}";{2 * x:.6f};{50 * x:.6f}'.replace(".", ",") for x in t]
    assert page.drops("\r\n".join(lines)) == ""
    time, theta, q, tau = lines[0].split(";")
    columns = {"time column": time, "theta column": theta, "q column": q, "tau column": tau}
    units = {"time unit": "ms", "theta unit": "deg", "q unit": "deg", "tau unit": "mN.m"}
    page.fills({**FIELDS, **columns, **units})
    script = "const { signals, T } = log.read(); return { ...signals, T: [T] }"
    found = page.arrays(script)
    np.testing.assert_allclose(found["T"], 0.001)
    np.testing.assert_allclose(found["theta"], np.radians(np.round(t, 6)), rtol=1e-12)
    np.testing.assert_allclose(found["q"], 2 * np.radians(np.round(t, 6)), rtol=1e-12)
    np.testing.assert_allclose(found["tau"], 0.05 * np.round(t, 6), rtol=1e-12)


@pytest.mark.parametrize("above", ["sep=;\r\n", "# of today; by me\n#\n\n", "sep=;\n# of today\n"])
def test_lines_above_the_names_are_skipped(above: str, page: WebPage) -> None:
    rows = "".join(f"{k};0,5;1;2\n" for k in range(200))
    assert page.drops(f"{above}t;theta;q;tau\n{rows}") == ""
    assert page.text("log-name") == "log.csv: 200 rows"
    found = page.arrays("return { theta: log.table.column('theta') }")
    assert found["theta"].tolist() == [0.5] * 200


def test_names_behind_a_hash_as_numpy_writes_them(page: WebPage) -> None:
    text = io.StringIO()
    np.savetxt(text, np.ones((200, 4)), header="of today\nt\ttheta\tq\ttau", delimiter="\t")
    assert page.drops(text.getvalue().replace(".", ",")) == ""
    assert page.page.run("return log.table.names") == ["t", "theta", "q", "tau"]
    assert page.arrays("return { q: log.table.column('q') }")["q"].tolist() == [1.0] * 200


def test_the_page_has_every_unit_that_names_tell(page: WebPage) -> None:
    words = toml_file.read(Path(guess.__file__).with_name("vocabulary.toml")).unwrap()
    script = "return Object.values(SIGNALS).flatMap(({ units }) => Object.keys(units))"
    assert set(words["unit"]) <= set(page.page.run(script))


def test_the_sides_of_the_gear_and_the_directions(page: WebPage) -> None:
    """The encoder may be behind the gear, and the torque before it, or the other way round."""
    assert page.drops(csv(good())) == ""
    script = "const { signals } = log.read(); return signals"
    read = {}
    for side in ("motor", "joint"):
        for direction in ("same", "opposite"):
            sides = {"theta side": side, "tau side": side}
            directions = {"theta direction": direction, "tau direction": direction}
            page.fills({**FIELDS, **sides, **directions})
            read[side, direction] = page.arrays(script)
    for side, theta, tau in (("motor", 1 / 50, 1.0), ("joint", 1.0, 1 / 50)):
        for direction, sign in (("same", 1), ("opposite", -1)):
            found = read[side, direction]
            np.testing.assert_allclose(found["theta"], sign * theta * good()["theta"], rtol=1e-12)
            np.testing.assert_allclose(found["tau"], sign * tau * good()["tau"], rtol=1e-12)
            np.testing.assert_allclose(found["q"], good()["q"], rtol=1e-12)


def test_nothing_is_guessed_and_what_is_missing_is_said(page: WebPage) -> None:
    missing = (
        "Still missing: gear (ratio), time (column, unit), "
        "theta (column, unit, side of the gear, direction), q (column, unit), "
        "tau (column, unit, side of the gear, direction), theta_c (column, unit)."
    )
    for text in (csv(good()), KNEE):  # whatever the columns are called
        assert page.drops(text) == ""
        assert page.text("missing") == missing
        assert page.estimates({}) == missing
        assert page.page.run("return document.activeElement.name") == "gear ratio"
    chosen = {name: value for name, value in KNEE_FIELDS.items() if name != "theta unit"}
    page.fills(chosen)
    assert page.text("missing") == "Still missing: theta (unit)."
    page.fills({"theta unit": "counts", "theta per": ""})
    assert page.text("missing") == "Still missing: theta (counts per turn)."
    page.fills({"theta per": 4096})
    assert page.text("missing") == ""


def test_every_field_has_a_label_and_a_place_for_the_keyboard(page: WebPage) -> None:
    assert page.drops(KNEE, "knee.csv") == ""
    page.fills(KNEE_FIELDS)
    without = """
    return [...document.querySelectorAll("input:enabled, select:enabled")]
      .filter((field) => ![...field.labels].some((label) => label.textContent.trim()))
      .map((field) => field.name || field.id);
    """
    assert page.page.run(without) == []
    page.page.run("log.form.elements['gear ratio'].focus()")
    shown = """
    return [...log.form.elements].filter((field) => field.willValidate && !field.disabled)
      .map((field) => field.name);
    """
    names = page.page.run(shown)
    visited = []
    for _ in names:
        visited.append(page.page.run("return document.activeElement.name"))
        page.page.driver.switch_to.active_element.send_keys(Keys.TAB)
    assert visited == names


# ---- refused -------------------------------------------------------------------------------------


NAMES, ROWS = "t,theta,q,tau\n", "1,2,3,4\n" * 200


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("", "expected a CSV file with numbers, the file is empty"),
        ("#\n# of today\n", "the file is empty"),
        ("Dear all,\nsee you\n", 'expected at least 4 columns .* got 2: "Dear all,"'),
        ("0,1,2,3\n" * 200, "names of the columns above the numbers, got the number 0"),
        (NAMES + "a,b,c,d\n" * 200, 'numbers in at least 4 columns, got "a,b,c,d" in row 2'),
        (NAMES + "s,rad,rad,Nm\n" + ROWS, r"row 2 has no numbers \(units\?\): delete"),
        ("# of today\n" + NAMES + "s,rad,rad,Nm\n" + ROWS, "row 3 has no numbers"),
        (NAMES + "1,2,3,4\n" * 5, "100 to 1 million rows below the names, got 5"),
        ('time,"theta, motor",q,tau,x\n' + ROWS, "row 2: expected 5 cells, .* got 4"),
        ("t,q,q,tau\n" + ROWS, 'name of its own for each column, got "q" twice'),
        ("PK\3\4\0\0\n", "expected text with separated values, got a binary file"),
    ],
    ids=lambda text: text[:9],
)
def test_a_bad_file_is_refused_in_one_line(text: str, expected: str, page: WebPage) -> None:
    message = page.drops(text)
    assert message.startswith("log.csv: ") and "\n" not in message
    assert re.search(expected, message), message


def test_a_huge_file_is_refused_before_it_is_read(page: WebPage) -> None:
    script = "try { checkSize({ size: 3e9 }); } catch (error) { return error.message; }"
    assert page.page.run(script).startswith("expected at most 100 MB, the file has 3000 MB")


def test_a_bad_column_is_named(page: WebPage) -> None:
    t, tau = good()["time"], good()["tau"]
    hole, uneven = np.where(t == t[50], np.nan, tau), np.where(t == t[70], 0.0712, t)
    steps = "expected steps of about 0.001 s as in the mean, got 0.0022 s in row 72;"
    for name, values, expected in (
        ("tau", 0 * tau, "tau: expected a torque that changes, got 0 N·m in all rows"),
        ("tau", hole, 'row 52, column tau: expected a finite number, got "nan"'),
        ("time", -t, "time: expected times that rise, got 0 s first"),
        ("time", 0 * t, "time: expected times that rise, got 0 s first and 0 s last"),
        ("time", uneven, f"time: {steps}"),
    ):
        assert page.drops(csv({**good(), name: values})) == ""
        assert page.estimates(FIELDS).startswith(expected)
    text = "time,theta,q,tau,notes\n" + "".join(f"{k},0.5,1,2,good\n" for k in range(200))
    assert page.drops(text) == ""
    expected = 'row 2, column notes: expected a finite number, got "good"'
    assert page.estimates({**FIELDS, "tau column": "notes"}) == expected
    for q, expected in (
        (good()["theta"], "theta and q do not differ: choose another column"),
        (good()["theta"] + 0.1, "theta and q: expected a deformation that changes, got "),
    ):
        assert page.drops(csv({**good(), "q": q})) == ""
        assert page.estimates(FIELDS).startswith(expected)


@pytest.mark.parametrize(
    ("fields", "expected"),
    [
        ({"tau column": ""}, "Still missing: tau (column)."),
        ({"gear ratio": ""}, "Still missing: gear (ratio)."),
        ({"gear ratio": 0}, "gear ratio: expected a number above 0, got 0"),
        ({"gear ratio": -50}, "gear ratio: expected a number above 0, got -50"),
        ({"q unit": "counts"}, "Still missing: q (counts per turn, counter)."),
        (
            {"q unit": "counts", "q per": 0, "q counter": "never"},
            "q: expected a number above 0 for counts per turn, got 0",
        ),
        ({"q zero": ""}, "Still missing: q (value at zero)."),
        ({"rls.n": 2.5}, "rls.n: expected a whole number, got 2.5"),
        ({"rls.n": 9}, "rls.n: expected 1 to 8, got 9"),  # the estimator says it
        ({"motor.B": -1}, "motor.B: expected >= 1e-15, got -1"),
        ({"q column": "theta"}, "theta and q have the same column, theta: choose another one"),
        (
            {"theta_c column": "tau"},
            "Still missing: theta_c (unit), setPoint.offset, setPoint.scale.",
        ),
        ({"time unit": "us"}, "Is the unit of the time right?"),
        ({"time unit": "ns"}, "samplePeriod: expected >= 1e-9, got 1e-12"),
        (
            {"gear ratio": 1e-9, "theta side": "motor"},
            "range.phi: expected 1e-6 to 1e6, got 237226998",
        ),
    ],
    ids=lambda value: "-".join(value) if isinstance(value, dict) else "",
)
def test_a_bad_field_is_named(fields: dict[str, object], expected: str, page: WebPage) -> None:
    assert page.drops(csv(good())) == ""
    assert expected in page.estimates({**FIELDS, **fields})


def test_what_comes_from_the_log_is_called_so(page: WebPage) -> None:
    assert page.drops(csv({**good(), "q": 1e9 * good()["tau"]})) == ""
    assert page.estimates(FIELDS).endswith("or fill it in.")
    assert "from the log" not in page.estimates({"range.phi": 1e9})
