"""The start values of a data sheet as a file for another tool: SSV, MATLAB, Modelica.

Each number is written with all of its digits, so that the FMU gets what was learned, to the last
bit.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from lxml import etree

from sigmahat.files.output import write_whole
from sigmahat.fmi.instance import Fmu, Value
from sigmahat.joint.sheet import Sheet, origin

_CURVE = "rls.eta_0["
_NAMESPACES = {
    "ssc": "http://ssp-standard.org/SSP1/SystemStructureCommon",
    "ssv": "http://ssp-standard.org/SSP1/SystemStructureParameterValues",
}
_SSC, _SSV = (f"{{{namespace}}}" for namespace in _NAMESPACES.values())


@dataclass(frozen=True)
class _Start:
    """A start value, and data of its variable from the FMU."""

    name: str
    type: str
    """Real, Integer, Boolean or Enumeration."""
    value: float | int
    """An enumeration as the number of its item."""
    item: str
    """Item of an enumeration; else empty."""
    unit: str
    """Empty without a unit."""
    description: str
    own: bool
    """Whether this value is the default of the FMU."""

    @property
    def text(self) -> str:
        """The value, as all of the formats write it."""
        return ("true" if self.value else "false") if self.type == "Boolean" else repr(self.value)


def write(sheet: Sheet, fmu: Fmu, kind: str, path: Path) -> None:
    """Writes the start values of a sheet for this FMU; kind is a key of KINDS.

    Raises ValueError for a start value that does not fit the FMU, and for a file name that cannot
    be the name of the contents.
    """
    write_whole(KINDS[kind](sheet, fmu, list(_starts(sheet, fmu)), path.stem), path)


def _starts(sheet: Sheet, fmu: Fmu) -> Iterator[_Start]:
    own = fmu.parameters({})
    for name, value in sheet.start_values.items():
        variable = fmu.variable(name, "parameter")
        number = fmu.number(name, value)
        item = fmu.items(name)[int(number)] if variable.type == "Enumeration" else ""
        yield _Start(
            name,
            variable.type,
            number,
            item,
            variable.unit or "",
            variable.description or "",
            own[name] == (item or number),
        )


def _head(sheet: Sheet) -> Iterator[str]:
    """Lines about the purpose of the file and the origin of its values."""
    yield f"Start values of {sheet.fmu.name}.fmu, with which it starts from what was learned."
    yield from origin(sheet)


def _ssv(sheet: Sheet, fmu: Fmu, starts: list[_Start], name: str) -> str:
    """A parameter set after SSP 1.0, which SSP 2.0 reads as well.

    Importers disagree on the form of Booleans and enumerations: they are written only if the
    default of the FMU differs.
    """
    listed = [s for s in starts if s.type in ("Real", "Integer") or not s.own]
    units = {s.unit for s in listed if s.unit}
    try:
        root = etree.Element(_SSV + "ParameterSet", name=name, version="1.0", nsmap=_NAMESPACES)
    except ValueError as error:
        raise ValueError(
            f"the file name {name!r} is also the name of the contents: expected characters that "
            "XML allows; choose another name with --out"
        ) from error
    for line in _head(sheet):
        root.addprevious(etree.Comment(f" {line} "))
    parameters = etree.SubElement(root, _SSV + "Parameters")
    for s in listed:
        parameter = etree.SubElement(parameters, _SSV + "Parameter", name=s.name)
        unit = {"unit": s.unit} if s.unit else {}
        etree.SubElement(parameter, _SSV + s.type, value=s.item or s.text, **unit)
    defined = etree.SubElement(root, _SSV + "Units")
    for unit in fmu.description.unitDefinitions:
        if unit.name in units:
            element = etree.SubElement(defined, _SSC + "Unit", name=unit.name)
            etree.SubElement(element, _SSC + "BaseUnit", _base(unit))
    head, document = '<?xml version="1.0" encoding="UTF-8"?>\n', root.getroottree()
    return head + str(etree.tostring(document, encoding="unicode", pretty_print=True))


def _base(unit: Any) -> dict[str, str]:
    base = unit.baseUnit
    powers = {name: getattr(base, name) for name in ("kg", "m", "s", "rad")} if base else {}
    return {name: str(power) for name, power in powers.items() if power}


def _matlab(sheet: Sheet, fmu: Fmu, starts: list[_Start], name: str) -> str:
    """A function that returns a structure: parameter motor.B is field motor.B."""
    _identifier(name)
    lines = [f"function p = {name}", f"%{name.upper()} {sheet.fmu.name}: what was learned."]
    lines += [f"%   {line}" for line in _head(sheet)]
    lines += [
        "%   rls.eta_0 is a matrix, whose indices begin with 1: rls.eta_0(i + 1, j + 1) is",
        "%   rls.eta_0[i,j] of the FMU. An enumeration is written as the number of its item.",
    ]
    for s in starts:
        if not s.name.startswith(_CURVE):
            note = s.item or (f"[{s.unit}]" if s.unit else "")
            lines.append(f"p.{s.name} = {s.text};" + (f" % {note}" if note else ""))
    lines += [f"p.rls.eta_0 = {_matrix(_curve(starts))};", "end", ""]
    return "\n".join(lines)


def _modelica(sheet: Sheet, fmu: Fmu, starts: list[_Start], name: str) -> str:
    """A record: parameter motor.B is component motor.B; model, a word of Modelica, is 'model'."""
    _identifier(name)
    groups: dict[str, list[_Start]] = {}
    for s in starts:
        group, _, _ = s.name.rpartition(".")
        groups.setdefault("" if s.name.startswith(_CURVE) else group, []).append(s)
    title = f"{sheet.fmu.name}: what was learned"
    lines = [f'record {name} "{title}"', *(f"  // {line}" for line in _head(sheet))]
    lines += [
        "  // rls.eta_0[i + 1, j + 1] is rls.eta_0[i,j] of the FMU, whose indices begin with 0.",
        "  // An enumeration is written as the number of its item.",
    ]
    for group, members in groups.items():
        members = [s for s in members if not s.name.startswith(_CURVE)]
        indent = "    " if group else "  "
        declared = [_component(s, indent) for s in members]
        if group == "rls":
            curve = _curve(starts)
            size = f"{len(curve)}, {len(curve[0])}"
            text = f'= {_matrix(curve)} "Initial estimate, the curve"'
            declared.append(f"{indent}parameter Real eta_0[{size}] {text};")
        if not group:
            lines += declared
            continue
        kind = f"{group[0].upper()}{group[1:]}Parameters"
        name_of = f"'{group}'" if group in _RESERVED else group  # such as 'model'
        lines += [f"  record {kind}", *declared, f"  end {kind};", f"  {kind} {name_of};"]
    return "\n".join([*lines, f"end {name};", ""])


def _component(s: _Start, indent: str) -> str:
    kind = "Integer" if s.type == "Enumeration" else s.type
    unit = f'(unit="{s.unit}")' if s.unit else ""
    text = f"{s.description}: {s.item}" if s.item else s.description
    text = text.replace("\\", "\\\\").replace('"', '\\"')
    return f'{indent}parameter {kind} {s.name.rpartition(".")[2]}{unit} = {s.text} "{text}";'


def _curve(starts: list[_Start]) -> list[list[float]]:
    """The matrix rls.eta_0."""
    at: Mapping[tuple[int, int], Value] = {
        (int(i), int(j)): s.value
        for s in starts
        if s.name.startswith(_CURVE)
        for i, j in [s.name[len(_CURVE) : -1].split(",")]
    }
    n, m = (max(each[k] for each in at) + 1 for k in (0, 1))
    return [[float(at[i, j]) for j in range(m)] for i in range(n)]


def _matrix(rows: list[list[float]]) -> str:
    """A matrix as in MATLAB and Modelica."""
    return f"[{'; '.join(', '.join(map(repr, row)) for row in rows)}]"


_WORDS = """
    algorithm and annotation block break class connect connector constant constrainedby der discrete
    each else elseif elsewhen encapsulated end enumeration equation expandable extends external
    false final flow for function if import impure in initial inner input loop model not operator or
    outer output package parameter partial protected public pure record redeclare replaceable return
    stream then true type when while within
    case catch continue global otherwise parfor persistent spmd switch try
"""
_RESERVED = frozenset(_WORDS.split())
"""Words of Modelica and, in the last line, of MATLAB."""


def _identifier(name: str) -> None:
    """Raises ValueError for a name that no function and no record can have."""
    if not re.fullmatch(r"[A-Za-z][A-Za-z0-9_]*", name) or name in _RESERVED:
        raise ValueError(
            f"the file name {name!r} is also the name of the contents: expected letters, digits "
            "and _, a letter first, and no keyword; choose another name with --out"
        )


KINDS: Mapping[str, Callable[[Sheet, Fmu, list[_Start], str], str]] = {
    "ssv": _ssv,
    "matlab": _matlab,
    "modelica": _modelica,
}
"""Functions that make the text of a file, by kind."""
