"""The items of enumerations, which masters write as numbers, against the contract."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import fmpy
import pytest

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


@pytest.mark.parametrize("name", ITEMS)
def test_an_enumeration_has_the_items_of_the_contract(name: str, variables: dict[str, Any]) -> None:
    items = variables[name].declaredType.items
    assert [item.name for item in items] == ITEMS[name]
    assert [int(item.value) for item in items] == list(range(1, len(items) + 1))
    assert all(item.description for item in items)
