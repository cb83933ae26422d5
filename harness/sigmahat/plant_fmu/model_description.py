"""The model description of an FMU in the form of FMI 2.0: variables, and what follows from them.

A description is incomplete at first: it has the variables with their data. Three attributes of the
variables do not belong to FMI: ``depends`` of an output names the variables on which its initial
value depends, for the model structure. ``array`` of a first element describes its array, for
Modelica. ``at_most`` of a parameter is the expression that limits its start value until it is
set, for C and Modelica. `complete` adds value references, display units, the model structure and
the GUID, and removes these attributes and the units that no variable has.
"""

import hashlib
from collections.abc import Sequence
from pathlib import Path
from xml.etree import ElementTree
from xml.etree.ElementTree import Element, SubElement

UNITS = Path(__file__).with_name("units.xml")  # all units that a variable may have


def variables(root: Element) -> list[Element]:
    """The ``ScalarVariable`` elements in the order of their value references."""
    return root.findall("ModelVariables/ScalarVariable")


def items(root: Element, kind: Element) -> list[dict[str, str]]:
    """The items of the type of an enumeration: value, name and description."""
    path = f"TypeDefinitions/SimpleType[@name='{kind.attrib['declaredType']}']/Enumeration/Item"
    return [item.attrib for item in root.findall(path)]


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
        SubElement(unknowns, "Unknown", {"index": index, **dependencies(known)})


def dependencies(known: Sequence[int]) -> dict[str, str]:
    """The attributes of an unknown that depends on variables, given by index or value reference."""
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
    """Complete a description, and return its GUID.

    The GUID is a hash of everything in the description, so that another description never
    has the same GUID.
    """
    for reference, variable in enumerate(variables(root)):
        variable.set("valueReference", str(reference))
        variable.attrib.pop("array", None)
        variable.attrib.pop("at_most", None)
    _complete_units(root)
    _add_model_structure(root)
    ElementTree.indent(root)
    canonical = ElementTree.canonicalize(ElementTree.tostring(root, encoding="unicode"))
    digest = hashlib.sha256(canonical.encode()).hexdigest()
    parts = (digest[:8], digest[8:12], digest[12:16], digest[16:20], digest[20:32])
    guid = "{" + "-".join(parts) + "}"
    root.set("guid", guid)
    return guid


def write_xml(root: Element, file: Path) -> None:
    """Write XML with indentation."""
    ElementTree.indent(root)
    ElementTree.ElementTree(root).write(file, encoding="UTF-8", xml_declaration=True)
