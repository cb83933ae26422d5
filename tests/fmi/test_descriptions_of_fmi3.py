"""The XML files of the twins, against the schemas of FMI 3.0, and against the FMUs of FMI 2.0."""

import zipfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import fmpy
import pytest
from lxml import etree

import sigmahat
from fmi_runs import ESTIMATORS, PLANTS

every_fmu = pytest.mark.parametrize("name", ESTIMATORS + PLANTS)
Twin = Callable[[str], Path]
SCHEMAS = Path(fmpy.__file__).parent / "schema" / "fmi3"
FILES = {
    "modelDescription.xml": "fmi3ModelDescription.xsd",
    "sources/buildDescription.xml": "fmi3BuildDescription.xsd",
    "terminalsAndIcons/terminalsAndIcons.xml": "fmi3TerminalsAndIcons.xsd",
}


def read(fmu: Path, name: str = "modelDescription.xml") -> Any:
    with zipfile.ZipFile(fmu) as archive:
        return etree.fromstring(archive.read(name))


@every_fmu
def test_every_file_obeys_its_schema(name: str, twin: Twin) -> None:
    for file, schema in FILES.items():
        etree.XMLSchema(file=str(SCHEMAS / schema)).assertValid(read(twin(name), file))


def items_of(variable: Any) -> list[tuple[str, ...]]:
    return [(item.name, item.value, item.description) for item in variable.declaredType.items]


@every_fmu
def test_variables_are_those_of_fmi_2(name: str, twin: Twin) -> None:
    old: Any = fmpy.read_model_description(str(sigmahat.fmu(name)))
    new: Any = fmpy.read_model_description(str(twin(name)))
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


@every_fmu
def test_outputs_depend_on_what_they_depend_on_in_fmi_2(name: str, twin: Twin) -> None:
    old, new = read(sigmahat.fmu(name)), read(twin(name))
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
def test_the_terminals_of_a_plant_and_its_estimator_belong_together(plant: str, twin: Twin) -> None:
    terminals, estimator = [], ESTIMATORS[plant == "AntagonisticVsaPlant"]
    for name in (plant, estimator):
        root = read(twin(name), "terminalsAndIcons/terminalsAndIcons.xml")
        (terminal,) = root.iterfind("Terminals/Terminal")
        assert (terminal.get("name"), terminal.get("matchingRule")) == ("measurements", "bus")
        members = {m.get("memberName"): m.get("variableName") for m in terminal}
        causality = {
            v.get("name"): v.get("causality") for v in read(twin(name)).find("ModelVariables")
        }
        assert {causality[variable] for variable in members.values()} == {
            "output" if name == plant else "input"
        }
        terminals.append(set(members))
    assert terminals[0] <= terminals[1]
    assert {"q"} < terminals[0]
