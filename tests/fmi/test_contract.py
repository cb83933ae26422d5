"""Names, causalities, units and start values, on which masters rely, against the contract."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import fmpy
import pytest

B = 0.0025 / (2 * math.pi)
NO_UNIT = ""
# name: causality, variability (None: any), unit, start (None: any)
INPUTS = {
    "theta": "rad",
    "q": "rad",
    "theta_c": "rad",
    "tau": "N.m",
    "tau_e_sensor": "N.m",
}
OUTPUTS = {
    "sigma": "N.m/rad",
    "tau_e": "N.m",
    "tau_e_residual": "N.m",
    "theta_dot": "rad/s",
    "phi": "rad",
    "setPoint": "1",
    "a": "1",
    "rho": "1",
    "epsilon": "N.m",
    "sigma_std": "N.m/rad",
    "tau_e_std": "N.m",
    "change_age": "s",
}
PARAMETERS = {
    "samplePeriod": ("fixed", "s", 1e-3),
    "method": ("fixed", None, 1),
    "modality": ("tunable", None, 1),
    "motor.B": ("tunable", "kg.m2", 2.3e-5),
    "motor.D_theta": ("tunable", "N.m.s/rad", 1e-3),
    "motor.gamma": ("tunable", "1", 50),
    "residual.K_I": ("tunable", "1/s", 300),
    "filter.kind": ("fixed", None, 1),
    "filter.weighting": ("fixed", None, 1),
    "filter.V_a": ("tunable", None, None),
    "filter.V_max": ("tunable", None, 10),
    "filter.V_min": ("tunable", None, 0.1),
    "filter.alpha": ("tunable", None, 6),
    "filter.R": ("tunable", None, 10),
    "filter.P_0": ("fixed", NO_UNIT, 1),
    "encoder.theta": ("fixed", "1", 40000),
    "encoder.q": ("fixed", "1", 40000),
    "encoder.theta_c": ("fixed", "1", 1024),
    "deformation": ("fixed", None, 1),
    "setPoint.offset": ("fixed", "1", 100),
    "setPoint.scale": ("fixed", "1/rad", -B * 1000),
    "rls.kind": ("fixed", None, 1),
    "rls.symmetric": ("fixed", None, 1),
    "rls.n": ("fixed", None, 6),
    "rls.m": ("fixed", None, 3),
    "rls.P_0": ("fixed", NO_UNIT, 1e20),
    "rls.c": ("fixed", "1", 1e-20),
    "rls.a": ("fixed", "1", 0.1),
    "model.k_s": ("tunable", "N/m", 14220),
    "model.r_0": ("tunable", "m", 0.1),
    "model.b": ("tunable", "m/rad", B),
    "torque.held": ("tunable", None, 0),
    "regression.memory": ("tunable", "s", 20),
}
ONE, COUNTS = "1", "1"
ITEMS = {
    "method": ["Paper2011", "FilteredRegression"],
    "modality": ["Residual", "Sensor", "Model"],
    "filter.kind": ["ModifiedKalman", "Kalman", "FiniteDifference"],
    "filter.weighting": ["Normalized", "AsPrinted"],
    "deformation": ["Raw", "Filtered"],
    "rls.kind": ["Enhanced", "Standard", "ConstantFactor"],
    "doubt": [
        *("None", "NoClaim", "NotExcited", "Misfit", "OutOfRange"),
        *("FrictionOutsidePrior", "InertiaOutsidePrior", "NegativeStiffness"),
        "Change",
    ],
}


@pytest.fixture(scope="module")
def description(estimator_fmu: Path) -> Any:
    return fmpy.read_model_description(str(estimator_fmu))


@pytest.fixture(scope="module")
def variables(description: Any) -> dict[str, Any]:
    return {v.name: v for v in description.modelVariables}


def test_inputs_and_outputs_are_those_of_the_contract(variables: dict[str, Any]) -> None:
    for name, unit in INPUTS.items():
        variable = variables[name]
        assert (variable.causality, variable.unit, float(variable.start)) == ("input", unit, 0.0)
    for name, unit in OUTPUTS.items():
        assert (variables[name].causality, variables[name].unit) == ("output", unit)
    for name in ("sigma", "tau_e", "tau_e_residual", "theta_dot"):
        assert float(variables[name].start) == 0.0
    for i in range(8):
        for j in range(5):
            assert variables[f"eta[{i},{j}]"].causality == "output"
            assert variables[f"rls.eta_0[{i},{j}]"].variability == "fixed"
            # The unit is N.m over powers of rad, which differ.
            assert variables[f"eta[{i},{j}]"].unit is None
            assert variables[f"rls.eta_0[{i},{j}]"].unit is None
            assert float(variables[f"rls.eta_0[{i},{j}]"].start) == 0.0
    for name in ("valid", "confident"):
        assert (variables[name].type, variables[name].causality) == ("Boolean", "output")


def start_of(variable: Any) -> float:
    """Start value as a number. FMPy gives it as text."""
    if variable.type == "Boolean":
        return {"false": 0.0, "true": 1.0}[variable.start]
    return float(variable.start)


@pytest.mark.parametrize("name", PARAMETERS)
def test_a_parameter_is_that_of_the_contract(name: str, variables: dict[str, Any]) -> None:
    variability, unit, start = PARAMETERS[name]
    variable = variables[name]
    assert (variable.causality, variable.variability) == ("parameter", variability)
    assert unit is None or (variable.unit or NO_UNIT) == unit
    assert start is None or start_of(variable) == pytest.approx(start, rel=1e-15)


@pytest.mark.parametrize("name", ITEMS)
def test_an_enumeration_has_the_items_of_the_contract(name: str, variables: dict[str, Any]) -> None:
    items = variables[name].declaredType.items
    assert [item.name for item in items] == ITEMS[name]
    assert [int(item.value) for item in items] == list(range(1, len(items) + 1))
    assert all(item.description for item in items)
