"""Makes a copy of an FMU without enumerations, for importers that cannot set them.

An enumeration is an integer with names. In the copy it is declared as an integer of the type by
which the standard sets enumerations, so that the binaries need no change: Integer in FMI 2.0, Int64
in FMI 3.0. The GUID stays, because the binaries check it.
"""

from pathlib import Path
from xml.etree import ElementTree
from xml.etree.ElementTree import Element
from zipfile import ZipFile

from sigmahat.plant_fmu import archive

DESCRIPTION = "modelDescription.xml"


def write(fmu: Path, out: Path) -> None:
    """Write a copy of an FMU of either version, in which each enumeration is an integer."""
    with ZipFile(fmu) as opened:
        contents: dict[str, Path | bytes] = {
            name: opened.read(name) for name in opened.namelist() if name != DESCRIPTION
        }
        root = ElementTree.fromstring(opened.read(DESCRIPTION))
    replace_enumerations(root)
    ElementTree.indent(root)
    text: bytes = ElementTree.tostring(root, encoding="UTF-8", xml_declaration=True)
    archive.write(out, {DESCRIPTION: text, **contents})


def replace_enumerations(root: Element) -> None:
    """Replaces the enumerations of a description; descriptions of variables name the items.

    Only enumerations have a type of their own in these FMUs, so no type definition is left.
    """
    (definitions,) = root.findall("TypeDefinitions")
    items = {
        each.attrib["name"]: {int(i.attrib["value"]): i.attrib["name"] for i in each.iter("Item")}
        for each in definitions
    }
    root.remove(definitions)
    version_3 = root.attrib["fmiVersion"].startswith("3")
    (variables,) = root.findall("ModelVariables")
    for variable in variables:
        kind = variable if version_3 else variable[0]
        if kind.tag == "Enumeration":
            named = items[kind.attrib.pop("declaredType")]
            kind.tag = "Int64" if version_3 else "Integer"
            kind.attrib |= {"min": str(min(named)), "max": str(max(named))}
            listed = ", ".join(f"{number} {name}" for number, name in named.items())
            variable.attrib["description"] += f": {listed}"
