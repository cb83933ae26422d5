"""Writes the Modelica package as an archive that Modelica tools can load.

A file ``*.jinja`` of the package is a template. The template takes names, units, start values,
ranges and descriptions of the variables from the model descriptions of the FMUs.
"""

import re
from collections.abc import Iterable
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any
from xml.etree.ElementTree import Element

import jinja2

from sigmahat.plant_fmu import archive, model_description
from sigmahat_build.description_template import render

KEYWORDS = {"initial": "init", "model": "nominal"}
"""Modelica names of groups of parameters whose names in the FMUs are keywords of Modelica."""


@dataclass(frozen=True)
class Variable:
    """A variable of an FMU, as the package declares it. An array is one variable."""

    causality: str
    in_c: str  # name in the FMU, and place in the structs of the library
    group: str  # record that contains the variable; "" for no record
    name: str  # name in its record
    kind: str  # Real, Integer, Boolean or Enumeration
    type: str
    size: str  # "[8, 5]" for an array, else ""
    start: str  # start value, "" without a start value
    at_most: str  # expression that limits the start value until it is set, else ""
    limits: tuple[str, ...]  # modifiers such as "min=0"
    nominal: str
    unit: str
    description: str

    @property
    def full_name(self) -> str:
        """Name with the record: "motor.B"."""
        return f"{self.group}.{self.name}" if self.group else self.name

    @property
    def component(self) -> str:
        """Component of a block that contains the variable: the record, or the variable itself."""
        return self.group or self.name

    @property
    def as_integer(self) -> str:
        """Expression for the value of the variable in C."""
        forms = {"Enumeration": "Integer({})", "Boolean": "if {} then 1 else 0"}
        return forms.get(self.kind, "{}").format(self.full_name)

    def declared(self, *modifiers: str, name: str = "", value: str = "") -> str:
        """Formats a Modelica declaration: type, name, modifiers, range and description."""
        modified = ", ".join([*modifiers, *self.limits])
        text = f"{self.type} {name or self.name}{self.size}{f'({modified})' if modified else ''}"
        return f'{text}{f" = {value}" if value else ""} "{self.description}"'


def contents(library: Path, descriptions: Path, version: str) -> dict[str, bytes]:
    """Returns the files of the Modelica package by relative name, with rendered templates.

    library       folder of the package, with its ``package.mo.jinja``
    descriptions  folder of the templates of the model descriptions

    Raises ``jinja2.TemplateError`` for a template that is damaged, or lacks a group of parameters.
    """
    environment = jinja2.Environment(
        loader=jinja2.FileSystemLoader(library),
        undefined=jinja2.StrictUndefined,
        line_statement_prefix="//%",
        block_start_string="<%",
        block_end_string="%>",
        variable_start_string="<<",
        variable_end_string=">>",
        comment_start_string="<#",
        comment_end_string="#>",
        keep_trailing_newline=True,
    )
    text = (library / "Types.mo.jinja").read_text(encoding="utf-8")
    types = {unit: name for name, unit in re.findall(r'type (\w+) = Real \(.*unit="(.+?)"', text)}
    root = cache(lambda fmu: render(descriptions / f"{fmu}.xml", version))

    @cache
    def variables(fmu: str, causality: str) -> list[Variable]:
        listed = model_description.variables(root(fmu))
        declared = (_variable(root(fmu), variable, types) for variable in listed)
        return [v for v in declared if v is not None and v.causality == causality]

    files = {}
    for file in sorted(path for path in library.rglob("*") if path.is_file()):
        name = file.relative_to(library).as_posix()
        if file.name == "macros.jinja":
            continue
        if file.suffix == ".jinja":
            enumerations = root("StiffnessEstimator").findall("TypeDefinitions/SimpleType")
            known: dict[str, Any] = {"variables": variables, "enumerations": enumerations}
            template = environment.get_template(name, globals={**known, "version": version})
            files[name.removesuffix(".jinja")] = template.render().encode()
        else:
            files[name] = file.read_bytes()
    return files


def _variable(root: Element, variable: Element, types: dict[str, str]) -> Variable | None:
    """Converts an FMU variable; None for a signal source, and for further array elements."""
    kind, given = variable[0], variable.attrib
    name, _, index = given["name"].partition("[")
    if name.startswith("signal.") or (index and "array" not in given):
        return None
    group, _, last = name.rpartition(".")
    start = kind.get("start", "")
    if kind.tag == "Enumeration":
        declared = kind.attrib["declaredType"]
        names = {item["value"]: item["name"] for item in model_description.items(root, kind)}
        type_name, start = f"Types.{declared}", start and f"Types.{declared}.{names[start]}"
    elif kind.tag == "Real" and not index and kind.get("unit"):
        type_name = f"Types.{types[kind.attrib['unit']]}"
    else:
        type_name = kind.tag
    return Variable(
        causality=given["causality"],
        in_c=name,
        group=KEYWORDS.get(group, group),
        name=last,
        kind=kind.tag,
        type=type_name,
        size="[8, 5]" if index else "",
        start="zeros(8, 5)" if index else start,
        at_most=given.get("at_most", ""),
        limits=tuple(f"{limit}={kind.get(limit)}" for limit in ("min", "max") if kind.get(limit)),
        nominal=kind.get("nominal", "1"),
        unit=kind.get("unit", "1"),
        # Indices are from 1 in Modelica.
        description=re.sub(r"; signal\.\w+ is added to it$", "", given["description"])
        if not index
        else given["array"].replace("[i,j]", "[i+1,j+1]"),
    )


def write(
    out: Path,
    library: Path,
    descriptions: Path,
    sources: Iterable[Path],
    licence: Path,
    version: str,
) -> None:
    """Write the archive ``out`` with one folder, ``Sigmahat VERSION``.

    sources  C files and headers to add to its ``Resources/C-Sources``; see `contents` for the rest

    Equal files give equal bytes. Raises ``FileNotFoundError`` for a file that is missing.
    """
    folder = f"{library.name} {version}"
    package = contents(library, descriptions, version)
    files: dict[str, Path | bytes] = {f"{folder}/{name}": text for name, text in package.items()}
    files |= {f"{folder}/Resources/C-Sources/{file.name}": file for file in sources}
    archive.write(out, {**files, f"{folder}/LICENSE": licence})
