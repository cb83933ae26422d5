"""Writes documentation and icon of an FMU: ``documentation/index.html``, an SVG and a PNG.

One Jinja2 template in ``modelDescription/documentation`` gives the page of every FMU, with the
variables of the template of the model description. The icons are drawings in
``modelDescription/icons``: a PNG of 256 x 256 pixels, which importers show, and an equal SVG.
"""

import os
import re
import shutil
from pathlib import Path
from typing import Any
from xml.etree.ElementTree import Element

from sigmahat.files.templates import environment
from sigmahat.plant_fmu import model_description
from sigmahat_build.description_template import render

_ICONS = {
    2: ("model.png", "documentation/icon.svg"),
    3: ("terminalsAndIcons/icon.png", "terminalsAndIcons/icon.svg"),
}
"""Names of PNG and SVG in an FMU, by the version of FMI."""


def write(template: Path, out: Path, version: str) -> None:
    """Write the files into the folders ``fmi2`` and ``fmi3`` of ``out``, by their names in the FMU.

    Raises as `render` does, and ``FileNotFoundError`` for an FMU without an icon.
    """
    root = render(template, version)
    (experiment,) = root.findall("DefaultExperiment")
    page = environment(template.parent / "documentation").get_template("page.html")
    for fmi, icons in _ICONS.items():
        index = out / f"fmi{fmi}" / "documentation" / "index.html"
        for icon in icons:
            file = out / f"fmi{fmi}" / icon
            file.parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(template.parent / "icons" / f"{template.stem}{file.suffix}", file)
        text = page.render(
            identifier=template.stem,
            fmi=fmi,
            icon=os.path.relpath(icons[1], "documentation").replace(os.sep, "/"),
            kind="plant" if template.stem.endswith("Plant") else "estimator",
            experiment=experiment.attrib,
            variables={c: table(root, c) for c in ("input", "output", "parameter")},
            **{key: root.attrib[key] for key in ("description", "version", "copyright", "license")},
        )
        index.parent.mkdir(parents=True, exist_ok=True)
        index.write_text(text, encoding="utf-8")


def table(root: Element, causality: str) -> dict[str, Any]:
    """Creates table rows of the variables of one causality, and of array elements by array."""
    single: list[dict[str, Any]] = []
    arrays: dict[str, list[dict[str, Any]]] = {}
    for variable in model_description.variables(root):
        if variable.attrib["causality"] == causality:
            array = re.fullmatch(r"(.+)\[.+\]", variable.attrib["name"])
            rows = arrays.setdefault(array[1], []) if array else single
            rows.append(_row(root, variable))
    return {"single": single, "arrays": arrays}


def _row(root: Element, variable: Element) -> dict[str, Any]:
    kind = variable[0]
    start, shown, choices = kind.get("start", ""), "", []
    limits = _range(kind)
    if kind.tag == "Real":
        start = f"{float(start):.6g}" if start else ""
        display = root.find(f"UnitDefinitions/Unit[@name='{kind.get('unit')}']/DisplayUnit")
        if display is not None and float(start or 0):
            value = float(kind.attrib["start"]) * float(display.attrib["factor"])
            shown = f" ({value:.6g} {display.attrib['name']})"
    elif kind.tag == "Enumeration":
        choices = model_description.items(root, kind)
        names = {item["value"]: item["name"] for item in choices}
        start = names[start] if start else ""  # an output has no start value
        limits = "see items"
    elif kind.tag == "Boolean":
        limits = "false, true"
    return {
        "name": variable.attrib["name"],
        "unit": kind.get("unit", ""),
        "start": start + shown,
        "range": limits,
        "variability": variable.attrib["variability"],
        "description": variable.attrib["description"],
        "choices": choices,
    }


def _range(kind: Element) -> str:
    low, high = kind.get("min"), kind.get("max")
    if low is None and high is None:
        return "any"
    return f"{'[' if low else '('}{low or '-∞'}, {high or '∞'}{']' if high else ')'}"
