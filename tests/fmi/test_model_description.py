"""The XML files of the FMUs: against what the FMUs do, and for FMI 3.0 against the schemas."""

import math
import re
import zipfile
from pathlib import Path
from typing import Any

import fmpy
import pint
import pytest
from lxml import etree

import sigmahat
from fmi_instance import OK, Instance, unpacked
from fmi_runs import ESTIMATORS, PLANTS, Fmi

FMUS = ESTIMATORS + PLANTS
SCHEMAS = Path(fmpy.__file__).parent / "schema" / "fmi3"
FILES = {
    "modelDescription.xml": "fmi3ModelDescription.xsd",
    "sources/buildDescription.xml": "fmi3BuildDescription.xsd",
    "terminalsAndIcons/terminalsAndIcons.xml": "fmi3TerminalsAndIcons.xsd",
}

DISPLAYED = {
    **{"rad": "deg", "rad/s": "deg/s", "m": "mm", "s": "ms", "kg.m2": "g.cm2"},
    **{"N/m": "N/mm", "m/rad": "mm/rad"},
}
"""Display units, which masters show instead of a unit."""
UNITS: Any = pint.UnitRegistry()


@pytest.fixture(scope="module", params=FMUS)
def fmu(request: pytest.FixtureRequest) -> Path:
    return sigmahat.fmu(request.param)


def read(fmu: Path, name: str = "modelDescription.xml") -> Any:
    with zipfile.ZipFile(fmu) as archive:
        return etree.fromstring(archive.read(name))


def quantity(unit: str) -> Any:
    """Pint quantity 1 of a unit such as kg.m2, which pint calls kg*m**2."""
    return UNITS.Quantity(1.0, re.sub(r"(?<=[A-Za-z])(\d)", r"**\1", unit.replace(".", "*")))


def test_base_units_agree_with_the_names_of_the_units(fmu: Path) -> None:
    for unit in read(fmu).iterfind("UnitDefinitions/Unit"):
        base = unit.find("BaseUnit").attrib.items()
        product = math.prod((quantity(name) ** int(power) for name, power in base), start=UNITS(""))
        assert quantity(unit.get("name")).to_base_units().units == product.units, unit.get("name")


def test_factors_of_display_units_are_right(fmu: Path) -> None:
    root = read(fmu)
    units = {unit.get("name"): unit for unit in root.iterfind("UnitDefinitions/Unit")}
    for name in DISPLAYED.keys() & units.keys():
        (shown,) = units[name].iterfind("DisplayUnit")
        factor = quantity(name).to(quantity(shown.get("name")).units).magnitude
        assert float(shown.get("factor")) == pytest.approx(factor, rel=1e-15)
        assert shown.get("name") == DISPLAYED[name]
    for real in root.iterfind("ModelVariables/ScalarVariable/Real"):
        assert real.get("displayUnit") == DISPLAYED.get(real.get("unit"))


# The contract: masters write the items of enumerations as numbers.
ITEMS = {
    "method": "Paper2011 FilteredRegression",
    "modality": "Residual Sensor Model",
    "filter.kind": "ModifiedKalman Kalman FiniteDifference",
    "filter.weighting": "Normalized AsPrinted",
    "deformation": "Raw Filtered",
    "rls.kind": "Enhanced Standard ConstantFactor",
    "doubt": "None NoClaim NotExcited Misfit OutOfRange FrictionOutsidePrior InertiaOutsidePrior"
    " NegativeStiffness Change HeldInputs Outlier",
}


def test_an_enumeration_has_the_items_of_the_contract() -> None:
    variables = {v.name: v for v in unpacked(sigmahat.fmu("StiffnessEstimator"))[0].modelVariables}
    for name, expected in ITEMS.items():
        items = variables[name].declaredType.items
        assert [item.name for item in items] == expected.split()
        assert [int(item.value) for item in items] == list(range(1, len(items) + 1))


def known_values(fmu: Instance) -> dict[str, list[float]]:
    """For every input and parameter: values to try besides the present one."""
    values: dict[str, list[float]] = {}
    for name, v in fmu.variables.items():
        if v.causality == "output":
            continue
        if name == "range.knee_2" and not fmu.get("rls.symmetric"):
            continue  # with the largest orders, these columns are too many
        if v.type == "Boolean":
            values[name] = [0, 1]
        elif v.type == "Enumeration":
            values[name] = [int(item.value) for item in v.declaredType.items]
        elif v.type == "Integer":
            values[name] = [1, 2, float(v.max or 3)]
        else:
            present = fmu.get(name) or 0.1
            values[name] = [0.4321 * present, 1.2345 * present]
    return values


EFFECTIVE = {
    "spring.gap": 1e-3,  # the spring is engaged
    # below the deformation, and above it when it is 1.2345 times as large
    **{"spring.knee_1": 0.3, "spring.knee_2": 0.3, "range.knee": 0.0, "range.knee_2": 0.0},
    **{"spring.step_at": 0.0, "spring.step_for": 0.0},  # so that it has changed at the start
}


def distinct(fmu: Instance, choices: dict[str, int]) -> dict[str, float]:
    """Start values with which no parameter is without effect because another one is zero."""
    start: dict[str, float] = {}
    for k, (name, v) in enumerate(fmu.variables.items()):
        if name in ("rls.n", "rls.m"):
            start[name] = float(v.max)
        elif v.causality == "parameter" and v.type == "Real" and float(v.start) == 0:
            start[name] = 0.3 + 0.01 * k
    given = {**EFFECTIVE, **choices}
    return start | {name: given[name] for name in given.keys() & fmu.variables.keys()}


def observed(path: Path, choices: dict[str, int]) -> dict[str, set[str]]:
    """By output: the inputs and parameters that change its value in initialisation mode."""
    with Instance(path) as fmu:
        outputs = [n for n, v in fmu.variables.items() if v.causality == "output"]
        fmu.set_all(distinct(fmu, choices))
        assert fmu.enter() == OK
        depends: dict[str, set[str]] = {name: set() for name in outputs}
        before = fmu.get_all(outputs)
        for known, values in known_values(fmu).items():
            present = fmu.get(known)
            for value in values:
                fmu.set_all({known: value})
                for name, old, new in zip(outputs, before, fmu.get_all(outputs), strict=True):
                    if new != old:
                        depends[name].add(known)
            fmu.set_all({known: present})
            assert fmu.get_all(outputs) == before
    return depends


def test_initial_unknowns_depend_on_what_changes_them(fmu: Path) -> None:
    """Every variable that has an effect is listed, and no other one.

    A Boolean or an enumeration changes only if a threshold is crossed, so for these only the first
    is checked.
    """
    root = read(fmu)
    variables = root.findall("ModelVariables/ScalarVariable")
    names = [v.get("name") for v in variables]
    declared = {}
    for unknown in root.iterfind("ModelStructure/InitialUnknowns/Unknown"):
        indices = unknown.get("dependencies").split()
        assert unknown.get("dependenciesKind").split() == ["dependent"] * len(indices)
        declared[names[int(unknown.get("index")) - 1]] = {names[int(i) - 1] for i in indices}
    # Every basis, method and modality is used in one of these runs.
    choices = [(0, 1, 1), (0, 1, 2), (1, 1, 2), (0, 2, 1), (1, 2, 1)]
    if fmu.stem in PLANTS:
        choices = choices[:1]
    names_of_choices = ("rls.symmetric", "method", "modality")
    runs = [observed(fmu, dict(zip(names_of_choices, c, strict=True))) for c in choices]
    steps = {v.get("name") for v in variables if v[0].tag in ("Boolean", "Enumeration")}
    for name in runs[0]:
        found = set().union(*(run[name] for run in runs))
        if name in steps:
            assert found <= declared[name], name
        else:
            assert (found - declared[name], declared[name] - found) == (set(), set()), name
    assert declared.keys() == runs[0].keys()


def test_no_output_depends_on_an_input_at_a_communication_point(fmu: Path) -> None:
    root = read(fmu)
    unknowns = root.findall("ModelStructure/Outputs/Unknown")
    assert [u.get("dependencies") for u in unknowns] == [""] * len(unknowns)
    with Instance(fmu) as instance:
        variables = instance.variables.items()
        outputs = [name for name, v in variables if v.causality == "output"]
        assert [int(u.get("index")) - 1 for u in unknowns] == [
            i for i, (_, v) in enumerate(variables) if v.causality == "output"
        ]
        instance.initialise()
        for k in range(3):
            assert instance.step(k * 1e-3, 1e-3) == OK
            before = instance.get_all(outputs)
            for name, v in variables:
                if v.causality == "input":
                    instance.set_all({name: 0.2 + k})
                    assert instance.get_all(outputs) == before


# The twins for FMI 3.0


def test_every_file_obeys_its_schema(fmu: Path, fmi3: Fmi) -> None:
    for file, schema in FILES.items():
        etree.XMLSchema(file=str(SCHEMAS / schema)).assertValid(read(fmi3.path(fmu.stem), file))


def items_of(variable: Any) -> list[tuple[str, ...]]:
    return [(item.name, item.value, item.description) for item in variable.declaredType.items]


def test_variables_are_those_of_fmi_2(fmu: Path, fmi3: Fmi) -> None:
    old: Any = fmpy.read_model_description(str(fmu))
    new: Any = fmpy.read_model_description(str(fmi3.path(fmu.stem)))
    assert (old.guid, old.modelName) == (new.guid, new.modelName)
    *others, time = new.modelVariables
    assert (time.name, time.causality) == ("time", "independent")
    types = {"Real": "Float64", "Integer": "Int32"}
    keys = "name valueReference causality variability initial start unit nominal min max"
    for first, variable in zip(old.modelVariables, others, strict=True):
        assert variable.type == types.get(first.type, first.type)
        assert list(variable.dimensions) == []
        for key in (*keys.split(), "displayUnit", "description"):
            assert getattr(variable, key) == getattr(first, key), (first.name, key)
        if first.type == "Enumeration":
            assert items_of(variable) == items_of(first)


def test_outputs_depend_on_what_they_depend_on_in_fmi_2(fmu: Path, fmi3: Fmi) -> None:
    old, new = read(fmu), read(fmi3.path(fmu.stem))
    for part, tag in (("Outputs", "Output"), ("InitialUnknowns", "InitialUnknown")):
        expected = {
            int(u.get("index")) - 1: {int(i) - 1 for i in u.get("dependencies").split()}
            for u in old.iterfind(f"ModelStructure/{part}/Unknown")
        }
        found = {
            int(u.get("valueReference")): set(map(int, u.get("dependencies").split()))
            for u in new.iterfind(f"ModelStructure/{tag}")
        }
        assert found == expected and found


@pytest.mark.parametrize("plant", PLANTS)
def test_the_terminals_of_a_plant_and_its_estimator_belong_together(plant: str, fmi3: Fmi) -> None:
    terminals, estimator = [], ESTIMATORS[plant == "AntagonisticVsaPlant"]
    for name in (plant, estimator):
        root = read(fmi3.path(name), "terminalsAndIcons/terminalsAndIcons.xml")
        (terminal,) = root.iterfind("Terminals/Terminal")
        assert (terminal.get("name"), terminal.get("matchingRule")) == ("measurements", "bus")
        members = {m.get("memberName"): m.get("variableName") for m in terminal}
        causality = {
            v.get("name"): v.get("causality") for v in read(fmi3.path(name)).find("ModelVariables")
        }
        assert {causality[variable] for variable in members.values()} == {
            "output" if name == plant else "input"
        }
        terminals.append(set(members))
    assert terminals[0] <= terminals[1]
    assert {"q"} < terminals[0]
