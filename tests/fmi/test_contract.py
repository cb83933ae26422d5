"""The items of enumerations, which masters write as numbers, against the contract."""

from __future__ import annotations

from fmi_instance import unpacked
from sigmahat import fmu

ITEMS = {
    "method": "Paper2011 FilteredRegression",
    "modality": "Residual Sensor Model",
    "filter.kind": "ModifiedKalman Kalman FiniteDifference",
    "filter.weighting": "Normalized AsPrinted",
    "deformation": "Raw Filtered",
    "rls.kind": "Enhanced Standard ConstantFactor",
    "doubt": "None NoClaim NotExcited Misfit OutOfRange FrictionOutsidePrior InertiaOutsidePrior"
    " NegativeStiffness Change",
}


def test_an_enumeration_has_the_items_of_the_contract() -> None:
    variables = {v.name: v for v in unpacked(fmu("StiffnessEstimator"))[0].modelVariables}
    for name, expected in ITEMS.items():
        items = variables[name].declaredType.items
        assert [item.name for item in items] == expected.split()
        assert [int(item.value) for item in items] == list(range(1, len(items) + 1))
