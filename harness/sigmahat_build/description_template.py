"""Templates of model descriptions, in ``modelDescription/``.

A template is Jinja2 that renders to FMI 2.0 XML, an incomplete description as in
`sigmahat.plant_fmu.model_description`.
"""

import math
from pathlib import Path
from xml.etree import ElementTree
from xml.etree.ElementTree import Element

from sigmahat.files.templates import environment
from sigmahat.plant_fmu.model_description import UNITS


def render(template: Path, version: str) -> Element:
    """Render a template to the root element of its XML.

    Raises ``jinja2.TemplateError`` or ``ElementTree.ParseError`` for a damaged template.
    """
    templates = environment(template.parent, UNITS.parent, autoescape=False)
    text = templates.get_template(template.name).render(version=version, pi=math.pi)
    return ElementTree.fromstring(text)
