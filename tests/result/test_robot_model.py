"""Robot models with a joint of a data sheet as two hinges; other parsers read their numbers."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from lxml import etree
from urdf_parser_py.urdf import URDF

from command_line import Shell
from recorded_logs import CONFIGURATION, awas_log, estimated
from sigmahat.cli import main

FILES = {"mjcf": "joint.xml", "sdf": "joint.sdf", "urdf": "joint.urdf", "drake": "joint.drake.sdf"}
Sheet = dict[str, Any]
SETTING = 'method = "FilteredRegression"\nprior.B = 0.2\nprior.tau_coulomb = 0.01\n'


@pytest.fixture(scope="module")
def results(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Folder with results of an AwAS whose spring is a general polynomial with all powers."""
    configuration = CONFIGURATION + SETTING + "rls.n = 4\nrls.symmetric = false\n"
    folder = tmp_path_factory.mktemp("knee")
    out = estimated(folder, awas_log(1.0, 0.3, 10.0), configuration, "--out .")
    for kind in FILES:
        assert main(["export", str(out), "--to", kind, "--quiet"]) == 0
    return out


@pytest.fixture
def sheet(results: Path) -> Sheet:
    read: Sheet = json.loads((results / "joint.json").read_text())
    return read


def torque(sheet: Sheet, phi: Any) -> Any:
    """Sum of eta[i][j] set-point^powers_of_set_point[j] phi^powers_of_phi[i], as documented."""
    p, setting = sheet["polynomial"], sheet["at_the_end"]["set_point"]
    of_phi = np.array(p["eta"]) @ setting ** np.array(p["powers_of_set_point"], float)
    return of_phi @ phi ** np.array(p["powers_of_phi"])[:, None]


def test_the_spring_of_mjcf_is_the_polynomial(results: Path, sheet: Sheet) -> None:
    tree: Any = etree.parse(results / FILES["mjcf"])
    hinge = tree.find(".//joint[@name='joint_flexibility']")
    stiffness = [float(each) for each in hinge.get("stiffness").split()]
    low, high = sheet["polynomial"]["phi"]
    phi = np.linspace(low, high, 50)
    x = phi - float(hinge.get("springref"))
    found = sum(k * x ** (i + 1) for i, k in enumerate(stiffness))
    np.testing.assert_allclose(found, torque(sheet, phi), atol=1e-9 * np.abs(found).max())


def test_the_other_formats_have_the_nearest_line(results: Path, sheet: Sheet) -> None:
    low, high = sheet["polynomial"]["phi"]
    phi = np.linspace(low, high, 201)
    slope, offset = np.polyfit(phi, torque(sheet, phi), 1)
    of_sdf = (".//spring_stiffness", ".//spring_reference")
    of_urdf = (".//springStiffness", ".//springReference")
    for kind, places in (("sdf", of_sdf), ("drake", of_sdf), ("urdf", of_urdf)):
        tree: Any = etree.parse(results / FILES[kind])
        stiffness, reference = (float(tree.find(place).text) for place in places)
        assert stiffness == pytest.approx(slope, rel=1e-9)
        assert reference == pytest.approx(-offset / slope, rel=1e-6)


def test_a_parser_of_urdf_reads_the_motor(sheet: Sheet, shell: Shell) -> None:
    """GIVEN a gear ratio below 0, THEN inertia and friction are those above 0."""
    parameters = sheet["parameters"]
    parameters["gamma"] |= {"value": -7.0, "interval": None}
    parameters["tau_coulomb"] |= {"value": 0.5, "interval": None}
    Path("joint.json").write_text(json.dumps(sheet))
    shell.run("export . --to urdf")
    robot = URDF.from_xml_file(FILES["urdf"])
    motor = robot.joint_map["joint_motor"].dynamics
    assert motor.damping == pytest.approx(49 * parameters["D_theta"]["value"])
    assert motor.friction == pytest.approx(3.5)
    rotor = robot.link_map["joint_rotor"].inertial.inertia
    assert rotor.izz == pytest.approx(49 * parameters["B"]["value"])


def test_ranges_contain_the_values(results: Path, sheet: Sheet) -> None:
    tree: Any = etree.parse(results / FILES["mjcf"])
    ranges = {
        n.get("name"): [float(x) for x in n.get("data").split()] for n in tree.iter("numeric")
    }
    motor = tree.find(".//joint[@name='joint_motor']")
    low, high = ranges["joint_motor.armature"]
    assert low <= float(motor.get("armature")) <= high
    low, high = ranges["joint_flexibility.stiffness.factor"]
    widths = [(each["interval"], each["sigma"]) for each in sheet["curve"]]
    assert 0 < 1 - low <= max((b - a) / 2 / sigma for (a, b), sigma in widths)
    assert high - 1 == pytest.approx(1 - low)


def test_a_file_says_where_it_is_from(results: Path, sheet: Sheet) -> None:
    for name in FILES.values():
        text = (results / name).read_text()
        assert sheet["logs"][0]["sha256"] in text
        assert "joint_flexibility.stiffness.factor = 1 1, 95 % from" in text
        assert "A placeholder" in text


def test_a_sheet_without_motion_is_refused(sheet: Sheet, shell: Shell) -> None:
    sheet["polynomial"]["phi"] = None
    Path("joint.json").write_text(json.dumps(sheet))
    assert "expected data of a joint that moved" in shell.refused("export . --to mjcf")
