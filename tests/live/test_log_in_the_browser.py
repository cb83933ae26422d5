"""A log that is dropped on the page: estimated as in Python, or refused in one line."""

import io
import re
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

import sigmahat
from live_page import LivePage, csv, live_page
from recorded_logs import Array, awas_log
from sigmahat.fmi.model import Value

KNEE_FILE = Path(__file__).parents[2] / "examples" / "tutorial" / "knee.csv"
KNEE = KNEE_FILE.read_text(encoding="utf-8")
KNEE_FIELDS = {"theta per": 4096, "theta gear": 100, "tau per": 0.1, "motor.gamma": ""}
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
def page(site: Path) -> Iterator[LivePage]:
    with live_page(site / "live") as page:
        yield page
        assert page.page.complaints() == []
        assert all(url.startswith("file:") for url in page.page.requests())


def parameters(page: LivePage) -> dict[str, Value]:
    """Data that the page gives to the estimator, in the form for `sigmahat.Estimator`."""
    start = dict(page.page.run("return log.starts(log.read())"))
    return {**start, "method": "FilteredRegression", "modality": "Residual"}


def test_the_log_of_the_tutorial(page: LivePage) -> None:
    assert page.drops(KNEE, "knee.csv") == ""
    assert page.estimates(KNEE_FIELDS) == ""
    found = page.columns_of_run(["sigma", "sigma_std"])
    t, counts, degrees, current = np.loadtxt(KNEE_FILE, delimiter=",", skiprows=1).T
    theta = np.unwrap(counts, period=65536) / 4096 * 2 * np.pi / 100
    given = parameters(page)
    assert given["motor.gamma"] == 100  # the gear ratio of theta
    assert given["samplePeriod"] == pytest.approx(t[1] - t[0])
    expected = sigmahat.Estimator(given, RECORD).run(theta, np.radians(degrees), 0.1 * current)
    for name, values in found.items():
        size = np.ptp(expected[name][1000:])
        assert np.max(np.abs(values - expected[name])[1000:]) < 1e-9 * size, name
    curve = page.arrays(_CURVES)
    phi, sigma, std = (curve[f"{name} 0"] for name in ("phi", "sigma", "std"))
    # The script record.py made this log with the spring tau_e = 300 phi + 25000 phi^3.
    assert np.all(np.abs(sigma - (300 + 75000 * phi**2)) < 3 * std)
    torque = np.abs(curve["torque 0"] - (300 * phi + 25000 * phi**3))
    assert np.all(torque <= 3 * curve["torqueStd 0"] + 1e-9)
    assert np.count_nonzero(phi == 0) == 1 and std.max() < 50
    assert re.match(ANSWER, page.text("answer")), page.text("answer")
    half = (expected["doubt"] == "None")[len(t) // 2 :]
    assert f"the estimator was confident {100 * np.mean(half):.3g} % of" in page.text("answer")


def test_a_negative_stiffness_is_not_confident_and_is_drawn(page: LivePage) -> None:
    assert page.drops(KNEE, "knee.csv") == ""
    assert page.estimates({**KNEE_FIELDS, "tau reversed": True}) == ""
    value, rest = page.text("answer").removeprefix("Stiffness, with 95 % band: ").split(" ", 1)
    assert float(value.replace("\N{MINUS SIGN}", "-")) < 0
    assert "(NegativeStiffness: 100 %)" in rest  # of the second half
    assert "(not confident: NegativeStiffness)" in rest and "(confident)" not in rest
    low, high = page.page.run("return answer.plots[0].content.y")
    sigma = page.columns_of_run(["sigma"])["sigma"]
    assert low < np.min(sigma[len(sigma) // 2 :]) and high >= 0


def test_a_value_has_the_decimals_of_its_band(page: LivePage) -> None:
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


def test_an_answer_is_one_to_the_settings_that_are_shown(page: LivePage) -> None:
    for change in ({"motor.B": 1e-5}, {"q unit": "deg"}, {"theta column": "time_s"}):
        assert page.drops(KNEE, "knee.csv") == "" and page.text("answer") == ""
        assert page.estimates(KNEE_FIELDS) == "" and page.text("answer") != ""
        page.fills(change)
        assert page.text("answer") == "", change


def test_parameters_of_one_file_are_not_those_of_the_next(page: LivePage) -> None:
    shown = []
    for _ in range(2):
        assert page.drops(KNEE, "knee.csv") == ""
        shown.append(page.page.run("return log.typed()"))
        page.fills({"motor.B": 1, "noise.tau": 2, "rls.symmetric": False})
    assert shown[0] == shown[1]


def test_a_log_with_a_motor_that_sets_the_stiffness(page: LivePage) -> None:
    columns = awas_log(0.4, 0.3)
    assert page.drops(csv(columns)) == ""
    names = {"time": "t", "theta": "theta", "q": "q", "tau": "tau", "theta_c": "theta_c"}
    for port, column in names.items():
        assert page.page.run("return log.chosen(arguments[0]).column", port) == column
    assert page.estimates({"motor.gamma": 50, "rls.m": 3}) == ""
    ports = (columns[name] for name in ("theta", "q", "tau", "theta_c"))
    expected = sigmahat.Estimator(parameters(page)).run(*ports)
    (sigma,) = page.columns_of_run(["sigma"]).values()
    error = np.abs(sigma - expected["sigma"])[1000:]
    assert np.max(error) < 1e-9 * np.ptp(expected["sigma"][1000:])
    curves = page.arrays(_CURVES)
    settings = [curves[f"setPoint {i}"][0] for i in range(3)]
    assert settings[0] < settings[1] < settings[2]
    for i, setting in enumerate(settings):  # (29), of the lever arm in mm
        phi, found, std = (curves[f"{name} {i}"] for name in ("phi", "sigma", "std"))
        true = 2 * 14220 * (setting / 1000) ** 2 * np.cos(2 * phi)
        assert np.all(np.abs(found - true) < 3 * std)


def test_decimal_commas_quotes_and_units(page: LivePage) -> None:
    t = 0.001 * np.arange(200)
    lines = ["Zeit_ms;Motor_Winkel_deg;Abtrieb_Winkel_deg;Drehmoment_mNm"]
    lines += [f'{1000 * x:g};"{x:.6f}";{2 * x:.6f};{50 * x:.6f}'.replace(".", ",") for x in t]
    assert page.drops("\r\n".join(lines)) == ""
    script = "const { signals, T } = log.read(); return { ...signals, T: [T] }"
    found = page.arrays(script)
    np.testing.assert_allclose(found["T"], 0.001)
    np.testing.assert_allclose(found["theta"], np.radians(np.round(t, 6)), rtol=1e-12)
    np.testing.assert_allclose(found["q"], 2 * np.radians(np.round(t, 6)), rtol=1e-12)
    np.testing.assert_allclose(found["tau"], 0.05 * np.round(t, 6), rtol=1e-12)


@pytest.mark.parametrize("above", ["sep=;\r\n", "# of today; by me\n#\n\n", "sep=;\n# of today\n"])
def test_lines_above_the_names_are_skipped(above: str, page: LivePage) -> None:
    rows = "".join(f"{k};0,5;1;2\n" for k in range(200))
    assert page.drops(f"{above}t;theta;q;tau\n{rows}") == ""
    assert page.text("log-name") == "log.csv: 200 rows"
    found = page.arrays("return { theta: log.table.column('theta') }")
    assert found["theta"].tolist() == [0.5] * 200


def test_names_behind_a_hash_as_numpy_writes_them(page: LivePage) -> None:
    text = io.StringIO()
    np.savetxt(text, np.ones((200, 4)), header="of today\nt\ttheta\tq\ttau", delimiter="\t")
    assert page.drops(text.getvalue().replace(".", ",")) == ""
    assert page.page.run("return log.table.names") == ["t", "theta", "q", "tau"]
    assert page.arrays("return { q: log.table.column('q') }")["q"].tolist() == [1.0] * 200


def test_the_page_has_every_unit_that_names_tell(page: LivePage) -> None:
    script = """
    const known = Object.values(PORTS).flatMap(({ units }) => Object.keys(units));
    return Object.keys(WORDS.unit).filter((unit) => !known.includes(unit));
    """
    assert page.page.run(script) == []


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
def test_a_bad_file_is_refused_in_one_line(text: str, expected: str, page: LivePage) -> None:
    message = page.drops(text)
    assert message.startswith("log.csv: ") and "\n" not in message
    assert re.search(expected, message), message


def test_a_huge_file_is_refused_before_it_is_read(page: LivePage) -> None:
    script = "try { checkSize({ size: 3e9 }); } catch (error) { return error.message; }"
    assert page.page.run(script).startswith("expected at most 100 MB, the file has 3000 MB")


def test_a_bad_column_is_named(page: LivePage) -> None:
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
    assert page.drops(csv({**good(), "q": 1e9 * good()["tau"]})) == ""
    assert page.estimates({"motor.gamma": 50}).endswith("or fill it in.")
    assert "guessed" not in page.estimates({"range.phi": 1e9})
    # A negative gear ratio is valid: the guess of the largest torque uses the magnitude of the
    # ratio.
    assert page.drops(csv(good())) == "" and page.estimates({"motor.gamma": -50}) == ""
