"""Parameters of the Modelica package, as a compiler sees them, are those of the FMUs."""

from __future__ import annotations

from typing import Any

import pytest

import sigmahat
from modelica_package import NO_NOISE, REPOSITORY, compiled, in_modelica
from sigmahat.export.templates import render, variables

MODELS = {
    "AwasPlant": ["tau", "tau_c", "tau_ext"],
    "FlexibleJointPlant": ["tau", "tau_ext"],
    "AntagonisticVsaPlant": ["tau_1", "tau_2", "tau_ext"],
    "RealJointPlant": ["tau", "r", "D_theta_change", "tau_coulomb_change", "tau_ext"],
}
SETTINGS = """model Test
  extends Sigmahat.Estimators.Settings;
  parameter Sigmahat.Estimators.Parameters.Motor motor;
  Real x(start=0, fixed=true);
equation
  der(x) = 1;
end Test;"""


def parameters(fmu: str) -> dict[str, Any]:
    """Unit, start value and limits of each parameter by its name in the package."""
    found = {}
    for v in variables(
        render(REPOSITORY / "modelDescription" / f"{fmu}.xml", sigmahat.__version__)
    ):
        name, kind = str(v.get("name")), v[0]
        if v.get("causality") == "parameter" and not name.startswith(("signal.", "rls.eta_0")):
            start = {"true": "1", "false": "0"}.get(kind.attrib["start"], kind.attrib["start"])
            limits = [kind.get(limit) and float(kind.attrib[limit]) for limit in ("min", "max")]
            found[in_modelica(name)] = (kind.get("unit", "1"), float(start), *limits)
    return found


def own(model: Any, prefix: str = "") -> dict[str, Any]:
    every = {n.removeprefix(prefix): model.parameters[n] for n in model.parameters.names}
    return {n: (v.unit or "1", v.value, v.min, v.max) for n, v in every.items()}


@pytest.mark.parametrize("plant", MODELS)
def test_parameters_of_a_plant(plant: str) -> None:
    """Plants share records, whose start values must be those of each of them."""
    inputs = " ".join(f"p.{name} = 0;" for name in MODELS[plant])
    text = f"model Test Sigmahat.Plants.{plant} p({NO_NOISE}); equation {inputs} end Test;"
    found = own(compiled(text), "p.")
    expected = parameters(plant)
    assert {n: found[n] for n in expected} == expected
    extra = {n for n in found if not n.startswith("noise_2.")} - expected.keys()
    assert extra == {"noise.side"}


def test_parameters_of_the_estimator() -> None:
    found = own(compiled(SETTINGS))
    expected = parameters("StiffnessEstimator")
    del expected["encoder.theta_c"]  # no method uses it, and the block does not have it
    assert {n: found[n] for n in expected} == expected
    assert found.keys() - expected.keys() == {"startTime", "rls.eta_0"}
