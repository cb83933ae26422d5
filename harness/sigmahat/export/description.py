"""Model description of an FMU from its template: what follows from the variables is added here.

These are value references, display units, the model structure, source files, and the GUID. Units
that no variable has are left out.
"""

import hashlib
from collections.abc import Callable, Iterable
from pathlib import Path
from xml.etree import ElementTree
from xml.etree.ElementTree import Element

from sigmahat.export import fmi3_description, source_files
from sigmahat.export.c_variables import c_table
from sigmahat.export.templates import render, variables


def _add_model_structure(root: Element) -> None:
    """Outputs, and what their initial values depend on.

    At a communication point no output depends on an input: both estimators and plants compute
    outputs in fmi2DoStep alone.
    """
    structure = ElementTree.SubElement(root, "ModelStructure")
    listed = ElementTree.SubElement(structure, "Outputs")
    unknowns = ElementTree.SubElement(structure, "InitialUnknowns")
    indices = {v.attrib["name"]: i for i, v in enumerate(variables(root), start=1)}
    for variable in variables(root):
        if variable.attrib["causality"] != "output":
            continue
        index = str(indices[variable.attrib["name"]])
        known = sorted(indices[name] for name in variable.attrib.pop("depends").split())
        ElementTree.SubElement(listed, "Unknown", index=index, dependencies="")
        ElementTree.SubElement(
            unknowns,
            "Unknown",
            index=index,
            dependencies=" ".join(map(str, known)),
            dependenciesKind=" ".join(["dependent"] * len(known)),
        )


def _add_display_units(root: Element) -> None:
    """Reals whose unit has a display unit are shown in it."""
    displayed = {
        unit.attrib["name"]: display.attrib["name"]
        for unit in root.findall("UnitDefinitions/Unit")
        for display in unit.findall("DisplayUnit")
    }
    for real in root.findall("ModelVariables/ScalarVariable/Real"):
        if real.get("unit") in displayed:
            real.set("displayUnit", displayed[real.attrib["unit"]])


def _remove_unused_units(root: Element) -> None:
    used = {real.get("unit") for real in root.iterfind("ModelVariables/ScalarVariable/Real")}
    for definitions in root.findall("UnitDefinitions"):
        for unit in definitions.findall("Unit"):
            if unit.attrib["name"] not in used:
                definitions.remove(unit)


def complete(root: Element) -> str:
    """Turn a rendered template into a model description; returns its GUID.

    The GUID is a hash of everything in the description, so that another description never
    has the same one.
    """
    for reference, variable in enumerate(variables(root)):
        variable.set("valueReference", str(reference))
        variable.attrib.pop("array", None)
    _remove_unused_units(root)
    _add_display_units(root)
    _add_model_structure(root)
    ElementTree.indent(root)
    canonical = ElementTree.canonicalize(ElementTree.tostring(root, encoding="unicode"))
    digest = hashlib.sha256(canonical.encode()).hexdigest()
    parts = (digest[:8], digest[8:12], digest[12:16], digest[16:20], digest[20:32])
    guid = "{" + "-".join(parts) + "}"
    root.set("guid", guid)
    return guid


def _add_source_files(root: Element, names: Iterable[str]) -> None:
    """The files of ``sources/`` that an importer has to compile."""
    listed = ElementTree.SubElement(root.findall("CoSimulation")[0], "SourceFiles")
    for name in names:
        ElementTree.SubElement(listed, "File", name=name)


def write(
    template: Path,
    out: Path,
    version: str,
    struct: str,
    storage: Callable[[Element], dict[str, str]],
    sources: Iterable[Path],
) -> None:
    """Write ``modelDescription.xml`` and ``variables.h`` of a template into a folder.

    Beside them, ``fmi3`` gets the three files that describe the FMU for FMI 3.0. ``sources`` are
    the C files of both; those in a folder ``fmi2`` or ``fmi3`` are for that version only.
    """
    out.mkdir(parents=True, exist_ok=True)
    root = render(template, version)
    sources = list(sources)
    _add_source_files(root, source_files.names(source_files.for_version(sources, 2)))
    guid = complete(root)
    (out / "variables.h").write_text(c_table(root, struct, storage(root), guid), encoding="utf-8")
    _write_xml(root, out / "modelDescription.xml")
    names = source_files.names(source_files.for_version(sources, 3))
    described = fmi3_description.build_description(template.stem, names)
    (out / "fmi3").mkdir(exist_ok=True)
    _write_xml(fmi3_description.twin(root), out / "fmi3/modelDescription.xml")
    _write_xml(described, out / "fmi3/buildDescription.xml")
    shown = fmi3_description.terminals_and_icons(root)
    _write_xml(shown, out / "fmi3/terminalsAndIcons.xml")


def _write_xml(root: Element, file: Path) -> None:
    ElementTree.ElementTree(root).write(file, encoding="UTF-8", xml_declaration=True)
