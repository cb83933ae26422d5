"""Templates of model descriptions, in ``modelDescription/``.

A template is Jinja2 that renders to FMI 2.0 XML. ``description`` adds parts that follow from these
data. Two attributes do not belong to FMI: ``depends`` of an output names the variables on which its
initial value depends, for the model structure. ``array`` of a first element describes its array,
for Modelica.
"""

import math
from pathlib import Path
from xml.etree import ElementTree
from xml.etree.ElementTree import Element

from sigmahat.files.templates import environment

UNITS = Path(__file__).with_name("units.xml")  # all units that a variable may have


def render(template: Path, version: str) -> Element:
    """Render a template to the root element of its XML.

    Raises ``jinja2.TemplateError`` or ``ElementTree.ParseError`` for a damaged template.
    """
    found = environment(template.parent, UNITS.parent, autoescape=False)
    text = found.get_template(template.name).render(version=version, pi=math.pi)
    return ElementTree.fromstring(text)


def variables(root: Element) -> list[Element]:
    """The ``ScalarVariable`` elements in the order of their value references."""
    return root.findall("ModelVariables/ScalarVariable")


def items(root: Element, kind: Element) -> list[dict[str, str]]:
    """The items of the type of an enumeration: value, name and description."""
    path = f"TypeDefinitions/SimpleType[@name='{kind.attrib['declaredType']}']/Enumeration/Item"
    return [item.attrib for item in root.findall(path)]
