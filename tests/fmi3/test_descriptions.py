"""The XML files of the twins, against the schemas of FMI 3.0, and against the FMUs of FMI 2.0."""

from __future__ import annotations

import zipfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import fmpy
import pytest
from fmpy.validation import validate_fmu
from lxml import etree

import sigmahat
from fmi_runs import ESTIMATORS, PLANTS
from sigmahat.export.arrays import arrays

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
def test_every_file_obeys_its_schema_and_fmpy_finds_no_problem(name: str, twin: Twin) -> None:
    for file, schema in FILES.items():
        etree.XMLSchema(file=str(SCHEMAS / schema)).assertValid(read(twin(name), file))
    assert validate_fmu(str(twin(name))) == []


@every_fmu
def test_the_archive_has_what_the_standard_names(name: str, twin: Twin) -> None:
    with zipfile.ZipFile(twin(name)) as archive:
        files = set(archive.namelist())
    sources = read(twin(name), "sources/buildDescription.xml").xpath("//SourceFile/@name")
    assert {f"sources/{source}" for source in sources} == {f for f in files if f.endswith(".c")}
    assert {"terminalsAndIcons/icon.png", "terminalsAndIcons/icon.svg"} < files
    assert {"documentation/index.html", "documentation/licenses/license.txt"} < files
    assert f"binaries/{fmpy.platform_tuple}/{name}{fmpy.sharedLibraryExtension}" in files
    assert not any("fmi2" in source for source in sources)


@every_fmu
def test_variables_are_those_of_fmi_2(name: str, twin: Twin) -> None:
    old: Any = fmpy.read_model_description(str(sigmahat.fmu(name)))
    new: Any = fmpy.read_model_description(str(twin(name)))
    assert (old.guid, old.modelName) == (new.guid, new.modelName)
    of_old = {v.name: v for v in old.modelVariables}
    of_new = {v.name: v for v in new.modelVariables}
    assert of_new.pop("time").causality == "independent"
    found = arrays(list(of_old))
    assert [a.name for a in found] == list(of_new)
    types = {"Real": "Float64", "Integer": "Int32"}
    for array, variable in zip(found, of_new.values(), strict=True):
        first = list(of_old.values())[array.first]
        assert variable.type == types.get(first.type, first.type)
        assert [int(d.start) for d in variable.dimensions] == list(array.dimensions)
        for key in ("valueReference", "causality", "variability", "initial", "unit", "nominal"):
            assert getattr(variable, key) == getattr(first, key), (array.name, key)
        for key in ("min", "max", "displayUnit"):
            assert getattr(variable, key) == getattr(first, key), (array.name, key)
        if first.type == "Enumeration":
            items = [[(i.name, i.value, i.description) for i in v.declaredType.items]
                     for v in (first, variable)]  # fmt: skip
            assert items[0] == items[1]
        shared = variable.description == first.description
        assert variable.description and shared == (not array.dimensions)


@every_fmu
def test_initial_values_depend_on_what_they_depend_on_in_fmi_2(name: str, twin: Twin) -> None:
    old, new = read(sigmahat.fmu(name)), read(twin(name))
    names = [v.get("name") for v in old.iterfind("ModelVariables/ScalarVariable")]
    by_reference = {v.get("valueReference"): v.get("name") for v in new.find("ModelVariables")}
    whole = {n: a.name for a in arrays(names) for n in names[a.first : a.first + a.length]}
    expected: dict[str, set[str]] = {}
    for unknown in old.iterfind("ModelStructure/InitialUnknowns/Unknown"):
        known = {whole[names[int(i) - 1]] for i in unknown.get("dependencies").split()}
        expected.setdefault(whole[names[int(unknown.get("index")) - 1]], set()).update(known)
    found = {
        by_reference[u.get("valueReference")]: {
            by_reference[r] for r in u.get("dependencies").split()
        }
        for u in new.iterfind("ModelStructure/InitialUnknown")
    }
    assert found == expected
    outputs = {by_reference[o.get("valueReference")] for o in new.iterfind("ModelStructure/Output")}
    assert outputs == {
        v.get("name") for v in new.find("ModelVariables") if v.get("causality") == "output"
    }


@pytest.mark.parametrize(
    ("plant", "estimator"),
    [("AwasPlant", ESTIMATORS[0]), ("FlexibleJointPlant", ESTIMATORS[0]),
     ("RealJointPlant", ESTIMATORS[0]), ("AntagonisticVsaPlant", ESTIMATORS[1])],
)  # fmt: skip
def test_the_terminals_of_a_plant_and_its_estimator_belong_together(
    plant: str, estimator: str, twin: Twin
) -> None:
    terminals = []
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


@pytest.mark.parametrize(
    "names",
    [["a[1]", "a[2]"], ["a[0]", "b", "a[1]"], ["a[0,0]", "a[0,1]", "a[1,1]"], ["a[0]", "a[2]"]],
)
def test_elements_that_form_no_array_are_refused(names: list[str]) -> None:
    with pytest.raises(ValueError, match=r"a\b.*: expected"):
        arrays(names)
