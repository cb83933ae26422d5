"""The joint of a data sheet as two hinges: its numbers, read back by other parsers."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from lxml import etree
from urdf_parser_py.urdf import URDF

from command_line import refused
from recorded_logs import CONFIGURATION, awas_log, write_log
from sigmahat.cli import main

FILES = {"mjcf": "joint.xml", "sdf": "joint.sdf", "urdf": "joint.urdf", "drake": "joint.drake.sdf"}
SETTING = 'method = "FilteredRegression"\nprior.B = 0.2\nprior.tau_coulomb = 0.01\n'


@pytest.fixture(scope="module")
def results(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Of an AwAS whose spring is a general polynomial, so that all of it has to be shown."""
    folder = tmp_path_factory.mktemp("knee")
    log = write_log(awas_log(1.0, 0.3), folder / "knee.parquet")
    configuration = CONFIGURATION + SETTING + "rls.n = 4\nrls.symmetric = false\n"
    (folder / "knee.toml").write_text(configuration)
    config = ["--config", str(folder / "knee.toml")]
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("sigmahat.logs.estimate._save_figure", lambda *_: None)
        assert main(["estimate", str(log), *config, "--out", str(folder / "out"), "--quiet"]) == 0
    return folder / "out"


def sheet_of(results: Path) -> dict[str, Any]:
    sheet: dict[str, Any] = json.loads((results / "joint.json").read_text())
    return sheet


def exported(results: Path, kind: str) -> Path:
    assert main(["export", str(results), "--to", kind, "--force", "--quiet"]) == 0
    return results / FILES[kind]


def torque(sheet: dict[str, Any], phi: Any) -> Any:
    """As the page says: sum of eta[i][j] set-point^powers_of_set_point[j] phi^powers_of_phi[i]."""
    p, setting = sheet["polynomial"], sheet["at_the_end"]["set_point"]
    terms = [
        row[j] * setting ** p["powers_of_set_point"][j] * phi ** p["powers_of_phi"][i]
        for i, row in enumerate(p["eta"])
        for j in range(len(row))
    ]
    return np.sum(terms, axis=0)


def test_the_spring_of_mjcf_is_the_polynomial(results: Path) -> None:
    tree: Any = etree.parse(exported(results, "mjcf"))
    hinge = tree.find(".//joint[@name='joint_flexibility']")
    stiffness = [float(each) for each in hinge.get("stiffness").split()]
    sheet = sheet_of(results)
    low, high = sheet["polynomial"]["phi"]
    phi = np.linspace(low, high, 50)
    x = phi - float(hinge.get("springref"))
    found = sum(k * x ** (i + 1) for i, k in enumerate(stiffness))
    np.testing.assert_allclose(found, torque(sheet, phi), atol=1e-9 * np.abs(found).max())


def test_the_other_formats_have_the_nearest_line(results: Path) -> None:
    sheet = sheet_of(results)
    low, high = sheet["polynomial"]["phi"]
    phi = np.linspace(low, high, 201)
    slope, offset = np.polyfit(phi, torque(sheet, phi), 1)
    for kind, places in {
        "sdf": (".//spring_stiffness", ".//spring_reference"),
        "drake": (".//spring_stiffness", ".//spring_reference"),
        "urdf": (".//springStiffness", ".//springReference"),
    }.items():
        tree: Any = etree.parse(exported(results, kind))
        stiffness, reference = (float(tree.find(place).text) for place in places)
        assert stiffness == pytest.approx(slope, rel=1e-9)
        assert reference == pytest.approx(-offset / slope, rel=1e-6)


def test_a_parser_of_urdf_reads_the_motor_behind_its_gear(results: Path) -> None:
    parameters = sheet_of(results)["parameters"]
    robot = URDF.from_xml_file(str(exported(results, "urdf")))
    gamma = parameters["gamma"]["value"]
    motor = robot.joint_map["joint_motor"].dynamics
    assert motor.damping == pytest.approx(gamma**2 * parameters["D_theta"]["value"])
    coulomb = max(gamma * parameters["tau_coulomb"]["value"], 0)
    assert motor.friction == pytest.approx(coulomb)
    rotor = robot.link_map["joint_rotor"].inertial.inertia
    assert rotor.izz == pytest.approx(gamma**2 * parameters["B"]["value"])


def test_friction_has_no_direction(results: Path, tmp_path: Path) -> None:
    sheet = sheet_of(results)
    for name in ("gamma", "tau_coulomb"):
        value = -7.0 if name == "gamma" else 0.5
        sheet["parameters"][name] |= {"value": value, "interval": None}
    (tmp_path / "joint.json").write_text(json.dumps(sheet))
    robot = URDF.from_xml_file(str(exported(tmp_path, "urdf")))
    assert robot.joint_map["joint_motor"].dynamics.friction == pytest.approx(3.5)


def test_ranges_contain_the_values(results: Path) -> None:
    tree: Any = etree.parse(exported(results, "mjcf"))
    ranges = {
        n.get("name"): [float(x) for x in n.get("data").split()] for n in tree.iter("numeric")
    }
    motor = tree.find(".//joint[@name='joint_motor']")
    low, high = ranges["joint_motor.armature"]
    assert low <= float(motor.get("armature")) <= high
    low, high = ranges["joint_flexibility.stiffness.factor"]
    widths = [(each["interval"], each["sigma"]) for each in sheet_of(results)["curve"]]
    assert 0 < 1 - low <= max((b - a) / 2 / sigma for (a, b), sigma in widths)
    assert high - 1 == pytest.approx(1 - low)


@pytest.mark.parametrize("kind", list(FILES))
def test_a_file_says_where_it_is_from_and_how_certain_it_is(kind: str, results: Path) -> None:
    text = exported(results, kind).read_text()
    assert sheet_of(results)["logs"][0]["sha256"] in text
    assert "joint_flexibility.stiffness.factor = 1 1, 95 % from" in text
    assert "A placeholder" in text


def test_a_sheet_without_motion_is_refused(results: Path, tmp_path: Path, capsys: Any) -> None:
    sheet = sheet_of(results)
    sheet["polynomial"]["phi"] = None
    (tmp_path / "joint.json").write_text(json.dumps(sheet))
    line = refused(capsys, "export", str(tmp_path), "--to", "mjcf")
    assert "expected the sheet of a joint that moved" in line
    assert not (tmp_path / "joint.xml").exists()
