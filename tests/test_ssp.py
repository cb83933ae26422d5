"""The system sigmahat-awas.ssp: valid, reproducible, and what FMPy makes of it."""

from __future__ import annotations

import hashlib
import zipfile
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from fmpy.ssp.simulation import simulate_ssp
from fmpy.ssp.ssd import read_ssd, read_ssv
from lxml import etree

import sigmahat
from fmi_master import run, torques
from sigmahat.cosimulation import simulate
from sigmahat.export import system
from sigmahat.scenarios import T, scenario
from sigmahat.slave import Fmu

TABLE1 = scenario("table1")
RESIDUAL = TABLE1.estimators["RESIDUAL"]
STEPS = 1500  # the first half of the motion to one side
TEMPLATES = Path(__file__).parent.parent / "modelDescription" / "system"
NAMESPACES = {
    "ssd": "http://ssp-standard.org/SSP1/SystemStructureDescription",
    "ssc": "http://ssp-standard.org/SSP1/SystemStructureCommon",
    "ssv": "http://ssp-standard.org/SSP1/SystemStructureParameterValues",
}


@pytest.fixture(scope="module")
def ssp() -> Path:
    path = sigmahat.fmu("StiffnessEstimator").with_name("sigmahat-awas.ssp")
    assert path.is_file()
    return path


def read(ssp: Path, name: str) -> Any:
    with zipfile.ZipFile(ssp) as archive:
        return etree.fromstring(archive.read(name))


def test_valid_against_the_schema(ssp: Path) -> None:
    assert read_ssd(str(ssp), validate=True).version == "1.0"
    assert read_ssv(str(ssp), "resources/table1.ssv", validate=True).name == "table1"


def test_holds_the_fmus_of_the_build(ssp: Path) -> None:
    with zipfile.ZipFile(ssp) as archive:
        for name in ("AwasPlant", "StiffnessEstimator"):
            assert archive.read(f"resources/{name}.fmu") == sigmahat.fmu(name).read_bytes()


def test_same_bytes_again(ssp: Path, tmp_path: Path) -> None:
    again = tmp_path / "again.ssp"
    plant, estimator = sigmahat.fmu("AwasPlant"), sigmahat.fmu("StiffnessEstimator")
    system.write(again, plant, estimator, TEMPLATES)
    assert hashlib.sha256(again.read_bytes()).digest() == hashlib.sha256(ssp.read_bytes()).digest()


def test_every_connection_has_its_ends_with_one_unit(ssp: Path) -> None:
    root = read(ssp, "SystemStructure.ssd").find("ssd:System", NAMESPACES)
    owners = [(None, root), *((e.get("name"), e) for e in root.find("ssd:Elements", NAMESPACES))]
    units = {
        (owner, c.get("name"), c.get("kind")): c.find("ssc:Real", NAMESPACES).get("unit")
        for owner, element in owners
        for c in element.iterfind("ssd:Connectors/ssd:Connector", NAMESPACES)
    }
    connections = root.findall("ssd:Connections/ssd:Connection", NAMESPACES)
    ends = set()
    for c in connections:
        source, sink = c.get("startElement"), c.get("endElement")
        start = (source, c.get("startConnector"), "output" if source else "input")
        end = (sink, c.get("endConnector"), "input" if sink else "output")
        assert units[start] == units[end]
        ends |= {start, end}
    assert ends == set(units)  # no connector is left open
    wires = {
        c.get("endConnector"): c.get("startConnector")
        for c in connections
        if c.get("endElement") == "estimator"
    }
    assert wires == RESIDUAL.connections


def test_parameters_are_those_of_the_scenario(ssp: Path) -> None:
    found = {}
    for p in read(ssp, "resources/table1.ssv").iterfind("ssv:Parameters/*", NAMESPACES):
        found[p.get("name")] = p[0].get("value")
    for element, name, start in (
        ("plant", "AwasPlant", TABLE1.plant.start),
        ("estimator", "StiffnessEstimator", RESIDUAL.start),
    ):
        with Fmu(sigmahat.fmu(name)) as fmu:
            for parameter, value in fmu.parameters(start).items():
                text = found.pop(f"{element}.{parameter}", None)
                if fmu.variables[parameter].type == "Enumeration" or "eta_0" in parameter:
                    assert text is None and value == fmu.parameters({})[parameter]
                elif fmu.variables[parameter].type == "Boolean":
                    assert text == str(bool(value)).lower()
                else:
                    assert text is not None and float(text) == value
    assert found == {}


def test_a_scenario_with_another_enumeration_is_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(RESIDUAL.start, "modality", "Sensor")
    with pytest.raises(ValueError, match="modality: the SSP leaves it at Residual"):
        system.write(
            tmp_path / "x.ssp",
            sigmahat.fmu("AwasPlant"),
            sigmahat.fmu("StiffnessEstimator"),
            TEMPLATES,
        )


def test_fmpy_gives_what_its_rules_say(ssp: Path) -> None:
    """FMPy's master, written anew from its three rules (docs/how-to/fmpy.md): bit-identical."""
    result = simulate_ssp(
        str(ssp),
        stop_time=STEPS * T,
        step_size=T,
        parameter_set=read_ssv(str(ssp), "resources/table1.ssv"),
        input={
            name: lambda t, signal=signal: float(signal(np.array(t)))
            for name, signal in TABLE1.plant.inputs.items()
        },
    )
    own = run(torques(result["time"]), late=True, linear=False, times=result["time"])
    # FMPy notes the plant at the end of the step, under the time of its begin.
    np.testing.assert_array_equal(result["plant.sigma"][:-1], own["plant.sigma"][1:])
    np.testing.assert_array_equal(result["estimator.sigma"], own["estimator.sigma"])
    np.testing.assert_array_equal(result["sigma_hat"], own["estimator.sigma"])
    assert own["estimator.sigma"].any()


def test_without_those_rules_it_is_the_run_of_the_harness() -> None:
    """The same calls with torques in time and linear, as `sigmahat reproduce` has them."""
    recording = simulate(TABLE1.plant, {"RESIDUAL": RESIDUAL}, T, STEPS)
    own = run(torques(recording.t), late=False, linear=True, times=recording.t)
    np.testing.assert_array_equal(recording.plant["sigma"], own["plant.sigma"])
    np.testing.assert_array_equal(recording.estimators["RESIDUAL"]["sigma"], own["estimator.sigma"])
    assert own["estimator.sigma"].any()
