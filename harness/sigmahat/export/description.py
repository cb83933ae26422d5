"""Model description of an FMU from its template, and the C table that goes with it.

A template in ``modelDescription/`` is Jinja2 that renders to FMI 2.0 XML without what
follows from the rest: value references, model structure, display units, source files and GUID
are added here. Two attributes are ours and not in FMI: ``open`` of a Real says which of its
limits is itself not allowed, for the C table; ``depends`` of an output names the variables that
its initial value depends on, for the model structure.
"""

import hashlib
import math
import re
from collections.abc import Callable, Iterable
from pathlib import Path
from xml.etree import ElementTree
from xml.etree.ElementTree import Element

import jinja2

_TYPES = {
    "Real": "SH_TYPE_REAL",
    "Integer": "SH_TYPE_INTEGER",
    "Enumeration": "SH_TYPE_INTEGER",
    "Boolean": "SH_TYPE_BOOLEAN",
}


def render(template: Path, version: str) -> Element:
    """Render a template to the root element of its XML.

    Raises ``jinja2.TemplateError`` or ``ElementTree.ParseError`` for a damaged template.
    """
    environment = jinja2.Environment(
        loader=jinja2.FileSystemLoader(template.parent), undefined=jinja2.StrictUndefined
    )
    text = environment.get_template(template.name).render(version=version, pi=math.pi)
    return ElementTree.fromstring(text)


def variables(root: Element) -> list[Element]:
    """The ``ScalarVariable`` elements in the order of their value references."""
    return root.findall("ModelVariables/ScalarVariable")


def _field(variable: Element, name: str) -> str:
    part = {"input": "input", "output": "output", "parameter": "parameters"}
    return f"{part[variable.attrib['causality']]}.{name.replace(',', '][')}"


def storage_in_struct(root: Element) -> dict[str, str]:
    """Place of every variable in a struct whose fields carry the variables' names.

    ``motor.B`` is ``parameters.motor.B``, ``eta[1,2]`` is ``output.eta[1][2]``.
    """
    return {v.attrib["name"]: _field(v, v.attrib["name"]) for v in variables(root)}


def storage_in_sides(root: Element) -> dict[str, str]:
    """Place of every variable in a struct with two such structs, ``side[0]`` and ``side[1]``.

    ``motor_2.B`` is ``side[1].parameters.motor.B``. Inputs and parameters common to both are
    in ``side[0]``, outputs common to both are fields of their own.
    """
    places = {}
    for variable in variables(root):
        name = variable.attrib["name"]
        of_side = re.fullmatch(r"(\w+)_([12])((?:[.\[].*)?)", name)
        if of_side:
            base, number, rest = of_side.groups()
            places[name] = f"side[{int(number) - 1}].{_field(variable, base + rest)}"
        elif variable.attrib["causality"] == "output":
            places[name] = name
        else:
            places[name] = f"side[0].{_field(variable, name)}"
    return places


def storage_in_arrays(root: Element) -> dict[str, str]:
    """Place of every variable of a plant: arrays p, u and y in the order of the template.

    The one Integer, ``noise.seed``, is the field ``seed``.
    """
    array = {"input": "u", "output": "y", "parameter": "p"}
    count = dict.fromkeys(array.values(), 0)
    places = {}
    for variable in variables(root):
        if variable.find("Real") is None:
            places[variable.attrib["name"]] = "seed"
            continue
        name = array[variable.attrib["causality"]]
        places[variable.attrib["name"]] = f"{name}[{count[name]}]"
        count[name] += 1
    return places


STORAGE: dict[str, Callable[[Element], dict[str, str]]] = {
    "struct": storage_in_struct,
    "sides": storage_in_sides,
    "arrays": storage_in_arrays,
}
"""How the C struct of an FMU holds its variables."""


def _role(variable: Element) -> str:
    causality = variable.attrib["causality"]
    if causality == "input":
        return "SH_ROLE_INPUT"
    if causality == "output":
        return "SH_ROLE_GUESS" if variable[0].get("start") is not None else "SH_ROLE_OUTPUT"
    fixed = variable.attrib["variability"] == "fixed"
    return "SH_ROLE_FIXED" if fixed else "SH_ROLE_TUNABLE"


def _start(kind: Element) -> str:
    start = kind.get("start", "0")
    return {"true": "1", "false": "0"}.get(start, start)


def _limits(root: Element, kind: Element) -> tuple[str, str, int, int]:
    if kind.tag == "Enumeration":
        name = kind.attrib["declaredType"]
        items = root.findall(f"TypeDefinitions/SimpleType[@name='{name}']/Enumeration/Item")
        values = [int(item.attrib["value"]) for item in items]
        return str(min(values)), str(max(values)), 0, 0
    if kind.tag == "Boolean":
        return "0", "1", 0, 0
    opened = kind.get("open", "").split()
    return (
        kind.get("min", "-HUGE_VAL"),
        kind.get("max", "HUGE_VAL"),
        int("min" in opened),
        int("max" in opened),
    )


def c_table(root: Element, struct: str, places: dict[str, str], guid: str) -> str:
    """C header with identifier, GUID and the table of variables (``fmu_src/model.h``).

    ``struct`` is the type that holds the variables at ``places``, which the including file
    must have defined.
    """
    identifier = root.findall("CoSimulation")[0].attrib["modelIdentifier"]
    rows = []
    for variable in variables(root):
        kind, name = variable[0], variable.attrib["name"]
        low, high, low_open, high_open = _limits(root, kind)
        rows.append(
            f'    {{"{name}", offsetof({struct}, {places[name]}), {_TYPES[kind.tag]}, '
            f"{_role(variable)}, {_start(kind)}, "
            f"{low}, {high}, {low_open}, {high_open}}},"
        )
    return "\n".join(
        [
            "/* Generated from the model description; do not edit. */",
            f'#define SH_IDENTIFIER "{identifier}"',
            f'#define SH_GUID "{guid}"',
            "",
            "static const sh_variable VARIABLES[] = {",
            *rows,
            "};",
            "",
        ]
    )


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
        if real.attrib["unit"] in displayed:
            real.set("displayUnit", displayed[real.attrib["unit"]])


def complete(root: Element) -> str:
    """Turn a rendered template into a model description; returns its GUID.

    The GUID is a hash of everything in the description, so that another description never
    has the same one.
    """
    for reference, variable in enumerate(variables(root)):
        variable.set("valueReference", str(reference))
        variable[0].attrib.pop("open", None)
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
    sources: Iterable[str],
) -> None:
    """Write ``modelDescription.xml`` and ``variables.h`` of a template into a folder.

    ``sources`` are the names of the C files of the FMU.
    """
    out.mkdir(parents=True, exist_ok=True)
    root, delivered = render(template, version), render(template, version)
    _add_source_files(delivered, sources)
    guid = complete(delivered)
    (out / "variables.h").write_text(c_table(root, struct, storage(root), guid), encoding="utf-8")
    tree = ElementTree.ElementTree(delivered)
    tree.write(out / "modelDescription.xml", encoding="UTF-8", xml_declaration=True)
