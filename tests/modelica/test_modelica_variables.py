"""Names, units, start values and descriptions of the Modelica package are those of the FMUs."""

from __future__ import annotations

import re
from functools import cache
from typing import Any
from xml.etree.ElementTree import Element

import pymoca.ast
import pytest

import sigmahat
from modelica_package import NO_NOISE, REPOSITORY, classes, compiled, in_modelica
from sigmahat.export.templates import render, variables

PLANTS = {
    "AwasPlant": ["tau", "tau_c", "tau_ext"],
    "FlexibleJointPlant": ["tau", "tau_ext"],
    "AntagonisticVsaPlant": ["tau_1", "tau_2", "tau_ext"],
    "RealJointPlant": ["tau", "r", "D_theta_change", "tau_coulomb_change", "tau_ext"],
}
each_plant = pytest.mark.parametrize("plant", PLANTS)
LARGEST = 1e-15  # relative, of a start value that is computed


@cache
def fmu(name: str) -> dict[str, Element]:
    """The variables of a model description."""
    template = REPOSITORY / "modelDescription" / f"{name}.xml"
    return {str(v.get("name")): v for v in variables(render(template, sigmahat.__version__))}


def of(name: str, causality: str) -> dict[str, Element]:
    """Without the sines of the plants: in Modelica a source is connected."""
    return {
        n: v
        for n, v in fmu(name).items()
        if v.get("causality") == causality and not n.startswith("signal.")
    }


def general(description: str) -> str:
    """A description without the name of the motor: the record of a motor is that of every motor.

    Also without what has no place in Modelica, where sources are connected, and without what the
    limits say already.
    """
    description = re.sub(r"; signal\.\w+ is added to it$|; above 0$", "", description)
    text = re.sub(r" of (the )?(principal |secondary )?motor( \d)?(?=[, ;]|$)", "", description)
    text = re.sub(r"transmission \d", "the transmission", text)
    return re.sub(r"(theta_dot)_\d", r"\1", text)


def unit(v: Element) -> str:
    return v[0].get("unit") or "1"


@cache
def plant_model(plant: str) -> Any:
    inputs = " ".join(f"p.{name} = 0;" for name in PLANTS[plant])
    text = f"model Test Sigmahat.Plants.{plant} p({NO_NOISE}); equation {inputs} end Test;"
    return compiled(text)


def values(text: str, names: list[str]) -> dict[str, float]:
    """Values of parameters in a model whose text ends with its declarations, computed ones too."""
    ports = " ".join(f"Real v{i} = {name};" for i, name in enumerate(names))
    model = compiled(text.replace("equation", f"{ports} equation", 1))
    result = model.simulate(t=(0.0, 1e-3), dt=1e-3)
    return {name: float(result[f"v{i}"][0]) for i, name in enumerate(names)}


def start(v: Element) -> float:
    text = str(v[0].get("start"))
    return float({"true": "1", "false": "0"}.get(text, text))


def assert_same(given: Any, v: Element) -> None:
    """A parameter as rumoca sees it, without its value if that is computed."""
    assert general(given.description) == general(str(v.get("description")))
    assert (given.unit or "1") == unit(v)
    assert given.value is None or given.value == start(v)
    limits = {name: v[0].get(name) for name in ("min", "max")}
    own = {"min": given.min, "max": given.max}
    assert own == {name: value and float(value) for name, value in limits.items()}


@each_plant
def test_parameters_of_a_plant(plant: str) -> None:
    model, expected = plant_model(plant), of(plant, "parameter")
    own = {name.removeprefix("p."): model.parameters[name] for name in model.parameters.names}
    own = {name: each for name, each in own.items() if not name.startswith("noise_2.")}
    assert set(own) == {in_modelica(name) for name in expected} | {"noise.side"}
    # Its description in the FMU is of communication steps, which Modelica does not have.
    period = expected["noise.samplePeriod"]
    period.set("description", own["noise.samplePeriod"].description)
    for name, v in expected.items():
        assert_same(own[in_modelica(name)], v)
    computed = [name for name in expected if own[in_modelica(name)].value is None]
    inputs = " ".join(f"p.{name} = 0;" for name in PLANTS[plant])
    text = f"model Test Sigmahat.Plants.{plant} p({NO_NOISE}); equation {inputs} end Test;"
    found = values(text, [f"p.{in_modelica(name)}" for name in computed])
    for name in computed:
        assert found[f"p.{in_modelica(name)}"] == pytest.approx(start(expected[name]), rel=LARGEST)


@each_plant
def test_inputs_and_outputs_of_a_plant(plant: str) -> None:
    model = plant_model(plant)
    views = (model.states, model.algebraics, model.outputs)
    own = {name: view[name] for view in views for name in view.names}
    for name, v in (of(plant, "input") | of(plant, "output")).items():
        given = own[f"p.{name}"]
        assert given.description == re.sub("; signal.*", "", str(v.get("description"))), name
        assert (given.unit or "1") == unit(v)


SETTINGS = """model Test
  extends Sigmahat.Estimators.Settings;
  parameter Sigmahat.Estimators.Parameters.Motor motor;
  Real x(start=0, fixed=true);
equation
  der(x) = 1;
end Test;"""


def test_parameters_of_the_estimator() -> None:
    model, expected = compiled(SETTINGS), of("StiffnessEstimator", "parameter")
    own = {name: model.parameters[name] for name in model.parameters.names}
    eta_0 = {name for name in expected if name.startswith("rls.eta_0[")}
    assert own["rls.eta_0"].dims == [8, 5] and len(eta_0) == 40
    # It has no effect, and exists because the published interface of the FMU has it.
    scalars = set(expected) - eta_0 - {"encoder.theta_c"}
    assert set(own) == {in_modelica(name) for name in scalars} | {"startTime", "rls.eta_0"}
    for name in scalars:
        assert_same(own[in_modelica(name)], expected[name])
    computed = [name for name in sorted(scalars) if own[in_modelica(name)].value is None]
    found = values(SETTINGS, [*(map(in_modelica, computed)), "max(abs(rls.eta_0))"])
    assert found["max(abs(rls.eta_0))"] == 0
    for name in computed:
        assert found[in_modelica(name)] == pytest.approx(start(expected[name]), rel=LARGEST)


def test_the_antagonistic_estimator_has_the_parameters_of_its_fmu() -> None:
    one, two = (of(f"{kind}StiffnessEstimator", "parameter") for kind in ("", "Antagonistic"))
    for name, v in two.items():
        shared = one[re.sub(r"^motor_[12]", "motor", name)]
        assert v.attrib == {**shared.attrib, "name": name}
        assert v[0].attrib == shared[0].attrib


def unit_of(symbol: pymoca.ast.Symbol) -> str:
    """The unit of a component, its own or that of its type."""
    own = _unit(symbol.class_modification)
    declared = classes().get(str(symbol.type))
    if own is None and declared is not None and declared.extends:
        own = _unit(declared.extends[0].class_modification)
    return own or "1"


def _unit(modification: pymoca.ast.ClassModification | None) -> str | None:
    for each in modification.arguments if modification else []:
        if str(each.value.component) == "unit":
            return str(each.value.modifications[0].value)
    return None


@pytest.mark.parametrize("name", ["StiffnessEstimator", "AntagonisticStiffnessEstimator"])
def test_inputs_of_an_estimator(name: str) -> None:
    block = classes()[f"Estimators.{name}"]
    inputs = {n: s for n, s in block.symbols.items() if str(s.type) == "Interfaces.RealInput"}
    expected = of(name, "input")
    assert inputs.keys() - {"theta_c"} == expected.keys() - {"theta_c"}
    for n, symbol in inputs.items():
        assert (unit_of(symbol), symbol.comment) == (
            unit(expected[n]),
            expected[n].get("description"),
        )


def test_outputs_of_the_estimator() -> None:
    block = classes()["Estimators.StiffnessEstimator"]
    own = {"setPoint" if n == "setPoint_used" else n: s for n, s in block.symbols.items()}
    expected = {n: v for n, v in of("StiffnessEstimator", "output").items() if "[" not in n}
    assert len(expected) == 24
    for name, v in expected.items():
        assert own[name].comment == v.get("description")
        assert unit_of(own[name]) == unit(v)


def test_enumerations_have_the_items_of_the_fmu() -> None:
    template = REPOSITORY / "modelDescription" / "StiffnessEstimator.xml"
    types = render(template, sigmahat.__version__).findall("TypeDefinitions/SimpleType")
    text = (REPOSITORY / "modelica" / "Sigmahat" / "Types.mo").read_text(encoding="utf-8")
    assert len(types) == len(re.findall("= enumeration", text)) == 7
    for each in types:
        declared = re.search(
            rf'type {each.get("name")} = enumeration\((.*?)\)\s*"([^"]*)";', text, re.S
        )
        assert declared and declared[2] == each.get("description")
        items = re.findall(r'(\w+)\s+"([^"]*)"', declared[1])
        assert items == [(i.get("name"), i.get("description")) for i in each.iterfind(".//Item")]
