"""Completes the model description of an FMU from a template and the variables in the template.

This module adds value references, display units, the model structure, source files, and the GUID.
Units that no variable has are removed.
"""

import copy
import hashlib
import re
from collections.abc import Iterable, Sequence
from pathlib import Path
from xml.etree import ElementTree
from xml.etree.ElementTree import Element, SubElement

from sigmahat.export.c_variables import STORAGE, c_table
from sigmahat.export.templates import render, variables


def _add_model_structure(root: Element) -> None:
    """Adds the model structure: outputs, and variables on which their initial values depend.

    At a communication point no output depends on an input: both estimators and plants compute
    outputs in fmi2DoStep alone.
    """
    structure = SubElement(root, "ModelStructure")
    listed = SubElement(structure, "Outputs")
    unknowns = SubElement(structure, "InitialUnknowns")
    indices = {v.attrib["name"]: i for i, v in enumerate(variables(root), start=1)}
    for variable in variables(root):
        if variable.attrib["causality"] != "output":
            continue
        index = str(indices[variable.attrib["name"]])
        known = sorted(indices[name] for name in variable.attrib.pop("depends").split())
        SubElement(listed, "Unknown", index=index, dependencies="")
        SubElement(unknowns, "Unknown", {"index": index, **_dependencies(known)})


def _dependencies(known: Sequence[int]) -> dict[str, str]:
    kinds = " ".join(["dependent"] * len(known))
    return {"dependencies": " ".join(map(str, known)), "dependenciesKind": kinds}


def _complete_units(root: Element) -> None:
    """Removes units that no variable has, and gives each Real the display unit of its unit."""
    for definitions in root.findall("UnitDefinitions"):
        for unit in definitions.findall("Unit"):
            path = f"ModelVariables/ScalarVariable/Real[@unit='{unit.attrib['name']}']"
            reals = root.findall(path)
            if not reals:
                definitions.remove(unit)
            for display in unit.findall("DisplayUnit"):
                for real in reals:
                    real.set("displayUnit", display.attrib["name"])


def complete(root: Element) -> str:
    """Turn a rendered template into a model description; returns its GUID.

    The GUID is a hash of everything in the description, so that another description never
    has the same GUID.
    """
    for reference, variable in enumerate(variables(root)):
        variable.set("valueReference", str(reference))
        variable.attrib.pop("array", None)
    _complete_units(root)
    _add_model_structure(root)
    ElementTree.indent(root)
    canonical = ElementTree.canonicalize(ElementTree.tostring(root, encoding="unicode"))
    digest = hashlib.sha256(canonical.encode()).hexdigest()
    parts = (digest[:8], digest[8:12], digest[12:16], digest[16:20], digest[20:32])
    guid = "{" + "-".join(parts) + "}"
    root.set("guid", guid)
    return guid


def write(
    template: Path, out: Path, version: str, struct: str, storage: str, sources: Iterable[Path]
) -> None:
    """Write ``modelDescription.xml`` and ``variables.h`` of a template into a folder.

    struct   C type that holds the variables
    storage  how the type holds them, a key of ``c_variables.STORAGE``

    The folder ``fmi3`` gets the three files that describe the FMU for FMI 3.0. ``sources`` are the
    C files of both versions; files in a folder ``fmi2`` or ``fmi3`` are for that version only.
    """
    out.mkdir(parents=True, exist_ok=True)
    root = render(template, version)
    sources = [file for file in sources if file.suffix == ".c"]  # only these are compiled
    listed = SubElement(root.findall("CoSimulation")[0], "SourceFiles")
    for name in (file.name for file in for_version(sources, 2)):
        SubElement(listed, "File", name=name)
    write_completed(root, struct, storage, out / "modelDescription.xml", out / "variables.h")
    names = [file.name for file in for_version(sources, 3)]
    (out / "fmi3").mkdir(exist_ok=True)
    _write_xml(for_fmi3(root), out / "fmi3/modelDescription.xml")
    _write_xml(build_description(template.stem, names), out / "fmi3/buildDescription.xml")
    _write_xml(terminals_and_icons(root), out / "fmi3/terminalsAndIcons.xml")


def write_completed(root: Element, struct: str, storage: str, xml: Path, table: Path) -> None:
    """Complete a rendered template; write it, and its table of variables in C, as ``write``."""
    guid = complete(root)
    table.write_text(c_table(root, struct, STORAGE[storage](root), guid), encoding="utf-8")
    _write_xml(root, xml)


def _write_xml(root: Element, file: Path) -> None:
    ElementTree.indent(root)
    ElementTree.ElementTree(root).write(file, encoding="UTF-8", xml_declaration=True)


def for_version(files: Iterable[Path], fmi: int) -> list[Path]:
    """Selects the files for FMI 2.0 or 3.0, without files in the folder of the other version."""
    return [file for file in files if file.parent.name != {2: "fmi3", 3: "fmi2"}[fmi]]


def with_headers(files: Iterable[Path]) -> list[Path]:
    """Returns files and all headers that the files include, directly or indirectly.

    Other headers come with the importer (FMI) or the compiler. Raises ``ValueError`` for two files
    of one name: the FMU has all files in one folder.
    """
    waiting = list(files)
    folders = sorted({file.parent for file in waiting})
    found: dict[str, Path] = {}
    while waiting:
        file = waiting.pop()
        if file.name not in found:
            found[file.name] = file
            for name in re.findall(r'^#include "(.+)"', file.read_text("utf-8"), re.MULTILINE):
                waiting += [folder / name for folder in folders if (folder / name).is_file()]
        elif found[file.name] != file:
            raise ValueError(f"expected one file {file.name}, got {found[file.name]} and {file}")
    return list(found.values())


_TYPES = {"Real": "Float64", "Integer": "Int32", "Boolean": "Boolean", "Enumeration": "Enumeration"}


def for_fmi3(root: Element) -> Element:
    """Creates the model description of FMI 3.0 from the complete description of FMI 2.0."""
    made = Element("fmiModelDescription", {**root.attrib, "fmiVersion": "3.0"})
    made.set("instantiationToken", made.attrib.pop("guid"))
    (identifier,) = (e.attrib["modelIdentifier"] for e in root.findall("CoSimulation"))
    able = ("GetAndSetFMUState", "SerializeFMUState", "HandleVariableCommunicationStepSize")
    can = {f"can{what}": "true" for what in able}
    SubElement(made, "CoSimulation", {"modelIdentifier": identifier, **can})
    for part in ("UnitDefinitions", "TypeDefinitions", "LogCategories", "DefaultExperiment"):
        made.extend(map(copy.deepcopy, root.findall(part)))
    for definitions in made.findall("TypeDefinitions"):
        for simple in list(definitions):
            converted = SubElement(definitions, "EnumerationType", simple.attrib)
            converted.extend(simple.findall("Enumeration/Item"))
            definitions.remove(simple)
    for units in made.findall("UnitDefinitions"):
        if units.find("Unit[@name='s']") is None:  # the unit of time, which no variable has
            SubElement(SubElement(units, "Unit", name="s"), "BaseUnit", s="1")
    for categories in made.findall("LogCategories"):  # FMI 3.0 has no requests for status
        categories.remove(categories.findall("Category[@name='logStatusDiscard']")[0])
    made.append(_model_variables(root))
    made.append(_model_structure(root))
    return made


def _model_variables(root: Element) -> Element:
    made = Element("ModelVariables")
    listed = variables(root)
    for variable in listed:
        kind = variable[0]
        SubElement(made, _TYPES[kind.tag], {**variable.attrib, **kind.attrib})
    about = {"name": "time", "valueReference": str(len(listed)), "causality": "independent"}
    about |= {"variability": "continuous", "unit": "s", "description": "Simulation time"}
    SubElement(made, "Float64", about)
    return made


def _model_structure(root: Element) -> Element:
    """Creates the model structure of FMI 3.0, with value references instead of indices."""
    made = Element("ModelStructure")
    for part, tag in (("Outputs", "Output"), ("InitialUnknowns", "InitialUnknown")):
        for unknown in root.findall(f"ModelStructure/{part}/Unknown"):
            known = [int(i) - 1 for i in unknown.attrib["dependencies"].split()]
            reference = str(int(unknown.attrib["index"]) - 1)
            SubElement(made, tag, {"valueReference": reference, **_dependencies(known)})
    return made


def build_description(identifier: str, sources: Sequence[str]) -> Element:
    """``sources/buildDescription.xml``: the C files that an importer has to compile."""
    files = "".join(f'<SourceFile name="{source}"/>' for source in sources)
    return ElementTree.fromstring(
        '<fmiBuildDescription fmiVersion="3.0">'
        f'<BuildConfiguration modelIdentifier="{identifier}" description="C99">'
        f'<SourceFileSet language="C99">{files}</SourceFileSet>'
        "</BuildConfiguration></fmiBuildDescription>"
    )


def terminals_and_icons(root: Element) -> Element:
    """``terminalsAndIcons/terminalsAndIcons.xml``: the icon, and the measurements as a bus.

    The terminal ``measurements`` of a plant has the outputs of the sensors, the same terminal of an
    estimator its inputs. Members with equal names belong together, so that a tool which knows
    terminals connects plant and estimator in one step.
    """
    made = Element("fmiTerminalsAndIcons", fmiVersion="3.0")
    shown = SubElement(made, "GraphicalRepresentation")
    corners = {"x1": "-100", "y1": "-100", "x2": "100", "y2": "100"}
    SubElement(shown, "CoordinateSystem", corners, suggestedScalingFactorTo_mm="0.1")
    SubElement(shown, "Icon", corners)
    listed = [(v.attrib["causality"], v.attrib["name"]) for v in variables(root)]
    measured = [name for kind, name in listed if kind == "output" and "_measured" in name]
    members = measured or [name for kind, name in listed if kind == "input"]
    if members:
        about = {"name": "measurements", "matchingRule": "bus"}
        about["terminalKind"] = "org.sigmahat.measurements"
        about["description"] = "Measured positions and torques of the joint"
        terminal = SubElement(SubElement(made, "Terminals"), "Terminal", about)
        for name in members:
            member = name.replace("_measured" if measured else "_sensor", "")
            about = {"variableName": name, "memberName": member, "variableKind": "signal"}
            SubElement(terminal, "TerminalMemberVariable", about)
    return made
