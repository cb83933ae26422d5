"""Tests of the data sheet of a joint, of its export for other tools, and of its use in the FMU."""

import ast
import json
import re
import shutil
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

import fmpy
import numpy as np
import pytest
import rumoca
from fmpy.ssp.ssd import read_ssv

import sigmahat
from command_line import Shell
from recorded_logs import CONFIGURATION, STORED, awas_log, estimated, read_estimate
from sigmahat.cli import main
from sigmahat.files.output import sha256

METHOD = CONFIGURATION + 'method = "FilteredRegression"\nprior.B = 0.2\n'
CASES = {
    "powers that suffice": "rls.n = 3\n",
    "powers that do not": "rls.n = 1\nrls.m = 2\n",
    "a general polynomial": "rls.n = 4\nrls.symmetric = false\ntorque.held = true\n",
}
SUFFIXES = {"ssv": ".ssv", "matlab": ".m", "modelica": ".mo"}
Values = dict[str, Any]


@pytest.fixture(scope="module")
def every(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    log, folder = awas_log(1.0, 0.3, 10.0), tmp_path_factory.mktemp
    return {
        name: estimated(folder("case"), log, METHOD + text, "--out knee")
        for name, text in CASES.items()
    }


@pytest.fixture(params=CASES)
def case(request: pytest.FixtureRequest, every: dict[str, Path]) -> Path:
    return every[request.param]


@pytest.fixture(scope="module")
def original(every: dict[str, Path]) -> Path:
    return every["powers that suffice"]


@pytest.fixture
def knee(original: Path, shell: Shell) -> Shell:
    """A shell in a folder with a log and its results."""
    shutil.copytree(original, Path(), dirs_exist_ok=True)
    return shell


def sheet_of(folder: Path) -> Values:
    sheet: Values = json.loads((folder / "knee" / "joint.json").read_text())
    return sheet


def export(folder: Path, kind: str, out: Path) -> Path:
    path = out / f"knee{SUFFIXES[kind]}"
    assert main(["export", str(folder / "knee"), "--to", kind, "--out", str(path)]) == 0
    return path


# ---- contents of the data sheet -----------------------------------------------------------------


def test_what_it_rests_on(original: Path) -> None:
    sheet = sheet_of(original)
    assert (sheet["format"], sheet["version"]) == ("sigmahat joint data sheet", 2)
    assert sheet["sigmahat"] == sigmahat.__version__
    description = fmpy.read_model_description(sigmahat.fmu("StiffnessEstimator"))
    assert sheet["fmu"]["guid"] == description.guid
    (log,) = sheet["logs"]
    digest = sha256(original / "knee.parquet")
    assert (log["file"], log["ticks"], log["sha256"]) == ("knee.parquet", 10001, digest)
    assert sheet["configuration"] == {"file": "knee.toml", "sha256": sha256(original / "knee.toml")}
    assert sheet["rests_on"]["torque_gain"] == 0.02
    assert sheet["rests_on"]["exact"] == [] and sheet["rests_on"]["absent"] == []


def test_the_stiffness_is_that_of_the_table(original: Path) -> None:
    sheet, table = sheet_of(original), read_estimate(original / "knee")
    end = {name: table[name].to_numpy()[-1] for name in table.column_names if "[" in name}
    at, near = sheet["at_the_end"], partial(pytest.approx, rel=STORED, abs=0.0)
    assert at["sigma"] == near(end["estimate.sigma [N.m/rad]"])
    assert at["phi"] == near(end["estimate.phi [rad]"])
    assert at["set_point"] == near(end["estimate.setPoint [1]"])
    half = 1.96 * end["estimate.sigma_std [N.m/rad]"]
    assert at["interval"] == near([at["sigma"] - half, at["sigma"] + half])
    for name, unit in (("B", "kg.m2"), ("D_theta", "N.m.s/rad"), ("tau_coulomb", "N.m")):
        parameter = sheet["parameters"][name]
        assert parameter["unit"] == unit
        assert parameter["value"] == near(end[f"estimate.{name}_hat [{unit}]"])
    phi = table["estimate.phi [rad]"].to_numpy()
    assert sheet["polynomial"]["phi"] == near([phi.min(), phi.max()])


def test_the_polynomial_is_the_curve(case: Path) -> None:
    """The curve from the last state of the FMU equals the polynomial, evaluated by numpy."""
    sheet = sheet_of(case)
    p, curve = sheet["polynomial"], sheet["curve"]
    eta, powers = np.array(p["eta"]), np.array(p["powers_of_phi"])
    assert len({point["set_point"] for point in curve}) == 5 and len(curve) > 5 * 41
    for point in curve:
        assert point["interval"][0] < point["sigma"] < point["interval"][1]
        slope = powers * point["phi"] ** np.maximum(powers - 1, 0.0)
        sigma = slope @ eta @ point["set_point"] ** np.array(p["powers_of_set_point"], float)
        assert sigma == pytest.approx(point["sigma"], rel=1e-9)


def test_intervals_of_the_parameters(tmp_path: Path) -> None:
    """An interval comes from `identify`, or else from the prior; an exact value has no interval.
    Each interval contains the value of its parameter."""
    identified = (
        '[identified]\nB = {value = 2.3e-5, half_width = 1e-6, unit = "kg.m2"}\n'
        'D_theta = {value = "cannot tell", half_width = 1e-4, unit = "N.m.s/rad"}\n'
        'tau_noise = 1e-3\ndamping = {value = 5.0, half_width = 0.1, unit = "N.m.s/rad"}\n'
    )
    text = METHOD + "prior.delay = 0\n" + identified
    folder = estimated(tmp_path, awas_log(1.0, 0.3, 2.0), text, "--out knee")
    parameters = sheet_of(folder)["parameters"]
    kinds = {name: (p["interval"], p["interval_from"]) for name, p in parameters.items()}
    assert kinds["B"] == (pytest.approx([2.2e-5, 2.4e-5]), "identify")
    assert kinds["D_theta"] == (pytest.approx([1.2e-3 * (1 - 0.392), 1.2e-3 * 1.392]), "prior")
    assert kinds["tau_coulomb"] == (pytest.approx([-0.0392, 0.0392]), "prior")
    assert kinds["delay"] == (None, "exact") == kinds["gamma"]
    assert kinds["eccentric"][0][0] == 0.0
    assert kinds["damping"] == ([parameters["damping"]["value"], 5.1], "identify")
    intervals = [(p["value"], p["interval"]) for p in parameters.values() if p["interval"]]
    assert all(low <= value <= high for value, (low, high) in intervals)


# ---- into the FMU -------------------------------------------------------------------------------


def for_fmpy(start: Values) -> Values:
    """Replaces names of enumeration items by numbers, because FMPy only accepts the numbers."""
    variables = fmpy.read_model_description(sigmahat.fmu("StiffnessEstimator")).modelVariables
    kinds = {v.name: v.declaredType for v in variables if v.type == "Enumeration"}
    items = {n: {item.name: int(item.value) for item in t.items} for n, t in kinds.items()}
    return {n: items[n].get(v, v) if n in items else v for n, v in start.items()}


def from_ssv(path: Path) -> Values:
    parameters = read_ssv(str(path), validate=True).parameters
    read: dict[str, Callable[[str], Any]] = {"Real": float, "Integer": int}
    read["Boolean"] = lambda text: text == "true"
    return {p.name: read.get(p.type, str)(p.value) for p in parameters}


def test_the_fmu_begins_with_what_was_learned_to_the_last_bit(case: Path, tmp_path: Path) -> None:
    """An SSV file from the data sheet sets the FMU to the last estimated curve.

    Before the first sample, the FMU evaluates the curve at phi = 0 and theta_c = 0.
    """
    sheet = sheet_of(case)
    start = from_ssv(export(case, "ssv", tmp_path))
    path, T = sigmahat.fmu("StiffnessEstimator"), 1e-3
    values = for_fmpy(start)
    outputs = fmpy.simulate_fmu(path, start_values=values, stop_time=T, output_interval=T)[0]
    eta = np.array(sheet["polynomial"]["eta"])
    for (i, j), coefficient in np.ndenumerate(eta):
        assert outputs[f"eta[{i},{j}]"] == coefficient
    # THEN the stiffness equals the data sheet and the closed form, both exactly.
    row = eta[sheet["polynomial"]["powers_of_phi"].index(1)]
    sigma = 0.0
    for coefficient in row[::-1]:
        sigma = sigma * start["setPoint.offset"] + coefficient
    assert outputs["sigma"] == sigma == sheet["check"]["sigma"]
    assert outputs["tau_e"] == sheet["check"]["tau_e"]


# ---- files for other tools ----------------------------------------------------------------------


Read = Callable[[Path], Values]


def from_matlab(path: Path) -> Values:
    """Returns the variables that the lines of a MATLAB function set."""
    lines = path.read_text().splitlines()
    assert lines[0] == f"function p = {path.stem}" and lines[-1] == "end"
    found: Values = {}
    for line in lines[1:-1]:
        if not line.startswith("%"):
            name, value = re.fullmatch(r"p\.([\w.]+) = ([^;%]+|\[.*\]);(?: % \S+)?", line).groups()  # type: ignore[union-attr]
            found[name] = literal(value)
    return with_curve(found)


def from_modelica(path: Path) -> Values:
    """Returns the values of a Modelica record as a compiler reads them, without its matrices."""
    text = path.read_text()
    model = rumoca.Session().loads(f"{text}model M {path.stem} own; end M;", model="M")
    values = {name: model.parameters[name] for name in model.parameters.names}
    curve = literal(re.findall(r"eta_0\[\d+, \d+\] = (\[.*\])", text)[0])
    assert list(np.shape(curve)) == values["own.rls.eta_0"].dims
    names = {name: name.removeprefix("own.").replace("'model'", "model") for name in values}
    found = {names[name]: each.value for name, each in values.items()}
    return with_curve({**found, "rls.eta_0": curve})


def literal(text: str) -> Any:
    if text.startswith("["):
        return [[float(x) for x in row.split(",")] for row in text[1:-1].split(";")]
    return {"true": True, "false": False}[text] if text[0] in "tf" else ast.literal_eval(text)


def with_curve(found: Values) -> Values:
    rows = found.pop("rls.eta_0")
    curve = {f"rls.eta_0[{i},{j}]": x for i, row in enumerate(rows) for j, x in enumerate(row)}
    return {**found, **curve}


@pytest.mark.parametrize(("kind", "read"), [("matlab", from_matlab), ("modelica", from_modelica)])
def test_a_file_has_every_start_value_to_the_last_bit(
    kind: str, read: Read, case: Path, tmp_path: Path
) -> None:
    assert read(export(case, kind, tmp_path)) == for_fmpy(sheet_of(case)["start_values"])


def test_the_ssv_has_every_start_value_that_importers_agree_on(case: Path, tmp_path: Path) -> None:
    """The SSV file contains Booleans and enumerations that differ from the defaults of the FMU."""
    path = export(case, "ssv", tmp_path)
    found, expected = from_ssv(path), sheet_of(case)["start_values"]
    assert found["method"] == "FilteredRegression"
    assert found.items() <= expected.items()
    defaults = {"modality": "Residual", "rls.symmetric": True, "torque.held": False}
    defaults |= {"filter.kind": "ModifiedKalman", "filter.weighting": "Normalized"}
    defaults |= {"deformation": "Raw", "rls.kind": "Enhanced"}
    assert {n: x for n, x in expected.items() if n not in found}.items() <= defaults.items()
    assert not found.items() & defaults.items()


def test_a_file_says_where_it_is_from(knee: Shell) -> None:
    for kind, suffix in SUFFIXES.items():
        knee.run(f"export knee/joint.json --to {kind}")
        text = Path(f"knee/joint{suffix}").read_text()
        assert f"learned from knee.parquet, SHA-256 {sha256(Path('knee.parquet'))}" in text
        assert f"sigmahat {sigmahat.__version__}" in text


def test_names_cannot_end_a_comment_or_a_text(knee: Shell) -> None:
    sheet, here = sheet_of(Path()), Path().absolute()
    sheet["logs"][0]["file"] = 'a--->\n<!DOCTYPE x>"; end knee;\r\n%}\nquit /* é'
    Path("knee/joint.json").write_text(json.dumps(sheet))
    knee.run("""export knee --to ssv --out 'knee "left" <1> & é.ssv'""")
    (path,) = Path().glob("*.ssv")
    assert read_ssv(str(path), validate=True).name == path.stem == 'knee "left" <1> & é'
    for kind, read in {"matlab": from_matlab, "modelica": from_modelica}.items():
        assert read(export(here, kind, here)) == for_fmpy(sheet["start_values"])


# ---- wrong arguments ----------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ("nothere --to ssv", "nothere: No such file or directory; name the folder or the"),
        (". --to ssv", "joint.json: No such file"),
        ("knee.toml --to ssv", "expected the joint.json that `sigmahat estimate` wrote"),
        ("knee/state.json --to ssv", "got format 'sigmahat learned state'"),
        ("knee --to matlab --out my-joint.m", "'my-joint': expected letters"),
        ("knee --to matlab --out 2nd.m", "a letter first"),
        ("knee --to modelica --out model.mo", "no keyword"),
        ("knee --to ssv --out a\x01b.ssv", "'a\\x01b': expected characters"),
        ("knee --to ssv --out no/x.ssv", "cannot write no/x.ssv: No such file"),
        ("knee --to ssv --out knee", "is a directory"),
    ],
)
def test_wrong_arguments(arguments: str, words: str, knee: Shell) -> None:
    assert words in knee.refused(f"export {arguments}")


@pytest.mark.parametrize(
    ("of_sheet", "of_start", "words"),
    [
        ({"version": 1}, {}, "expected version 2 of the format, got 1"),
        ({"polynomial": None}, {}, "damaged: polynomial"),
        ({"mine": 1}, {}, "damaged: mine"),
        ({"doubt": "x y"}, {}, "damaged: doubt: expected a word, got 'x y'; run"),
        ({"misfit": float("inf")}, {}, "misfit: Input should be a finite number, got inf"),
        ({"parameters": {}}, {}, "parameters: expected the parameter gamma"),
        (
            {"configuration": {"file": "a", "sha256": 1000 * "x"}},
            {},
            f"expected a SHA-256: 64 hexadecimal digits, got '{79 * 'x'}...; run",
        ),
        ({}, {"rls.eta_0[7,0]": 1.0}, "expected a full matrix of coefficients"),
        ({}, {"motor.b": 1.0}, "did you mean 'motor.B'"),
        ({}, {"motor.B": "1; quit"}, "expected Real"),
        ({}, {"method": "Regression"}, "did you mean 'FilteredRegression'"),
        ({}, {"rls.n": 2.5}, "expected Integer"),
    ],
)
def test_a_sheet_that_does_not_fit_is_refused(
    of_sheet: Values, of_start: Values, words: str, knee: Shell
) -> None:
    sheet = sheet_of(Path())
    sheet["start_values"] |= of_start
    Path("knee/joint.json").write_text(json.dumps(sheet | of_sheet))
    assert words in knee.refused("export knee --to ssv")


NO_SHEETS = {
    "lists in lists": 100_000 * "[",
    "objects in objects": 100_000 * '{"a":',
    "too many digits": f'{{"version": {5000 * "9"}}}',
    "too long": 10_000_001 * " ",
}


@pytest.mark.parametrize("text", NO_SHEETS.values(), ids=NO_SHEETS)
def test_a_file_that_is_no_sheet_is_refused(text: str, shell: Shell) -> None:
    Path("joint.json").write_text(text)
    assert "expected the joint.json" in shell.refused("export . --to ssv")


def test_a_file_that_exists_is_kept(knee: Shell) -> None:
    Path("mine.m").write_text("mine")
    command = "export knee --to matlab --out mine.m"
    assert "mine.m exists; --force overwrites it" in knee.refused(command)
    assert knee.run(f"{command} --force --quiet") == ""
    assert Path("mine.m").read_text().startswith("function p = mine")
