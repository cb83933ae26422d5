"""Names, causalities, units and start values, on which masters rely, against the contract."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import fmpy
import pytest

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


@pytest.mark.parametrize("name", ITEMS)
def test_an_enumeration_has_the_items_of_the_contract(name: str, variables: dict[str, Any]) -> None:
    items = variables[name].declaredType.items
    assert [item.name for item in items] == ITEMS[name]
    assert [int(item.value) for item in items] == list(range(1, len(items) + 1))
    assert all(item.description for item in items)
