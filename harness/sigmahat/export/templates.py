"""Templates of model descriptions, in ``modelDescription/``.

A template is Jinja2 that renders to FMI 2.0 XML without what follows from the rest, which
``description`` adds. Two attributes are not in FMI: ``open`` of a Real says which of its limits is
itself not allowed, for the table of variables in C; ``depends`` of an output names the variables
that its initial value depends on, for the model structure.
"""

import math
from pathlib import Path
from xml.etree import ElementTree
from xml.etree.ElementTree import Element

import jinja2


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
