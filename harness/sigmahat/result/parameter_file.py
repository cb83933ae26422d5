"""Writes the start values of a data sheet as a file for another tool: SSV, MATLAB, Modelica.

Numbers are written with all digits, so that the FMU gets exactly the estimate.
"""

import re
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from sigmahat.files.escape import matlab_comment, modelica_comment, modelica_string
from sigmahat.files.output import write_whole
from sigmahat.files.templates import xml
from sigmahat.fmi.model import Model
from sigmahat.fmi.quoted import quoted
from sigmahat.result.sheet import Sheet, origin

_CURVE = "rls.eta_0["
_TEMPLATE = Path(__file__).with_name("templates") / "parameters.ssv"


@dataclass(frozen=True)
class _Start:
    """A start value, and the variable of the FMU that gets the value."""

    name: str
    variable: Any  # FMPy's description
    value: float | int  # an enumeration as the number of its item
    item: str  # item of an enumeration; else empty

    @property
    def text(self) -> str:
        """Text of the value, which is equal in all formats."""
        if self.variable.type == "Boolean":
            return "true" if self.value else "false"
        return repr(self.value)


def write(sheet: Sheet, model: Model, kind: str, path: Path) -> None:
    """Writes the start values of a sheet for this FMU; kind is a key of KINDS.

    Raises ValueError for a start value that does not fit the FMU, and for a file name that cannot
    be the name of the contents.
    """
    write_whole(KINDS[kind](sheet, model, list(_starts(sheet, model)), path.stem), path)


def _starts(sheet: Sheet, model: Model) -> Iterator[_Start]:
    for name, value in sheet.start_values.items():
        variable = model.variable(name, "parameter")
        number = model.number(name, value)
        item = model.items(name)[int(number)] if variable.type == "Enumeration" else ""
        yield _Start(name, variable, number, item)


def _head(sheet: Sheet) -> Iterator[str]:
    """Yields lines about the purpose of the file and the origin of the values."""
    yield f"Start values with which {sheet.fmu.name}.fmu continues from the estimate below."
    yield from origin(sheet)


def _ssv(sheet: Sheet, model: Model, starts: list[_Start], name: str) -> str:
    """Formats a parameter set of SSP 1.0, which tools for SSP 2.0 can read as well.

    Importers disagree on the form of Booleans and enumerations. Therefore such a value is written
    only if the value differs from the default of the FMU.
    """
    numbers, own = ("Real", "Integer"), model.parameters({})
    listed = [s for s in starts if s.variable.type in numbers or own[s.name] != (s.item or s.value)]
    units = {s.variable.unit for s in listed}
    if not name.isprintable():
        raise ValueError(
            f"file name {quoted(name)}: expected characters that print, because the file contains "
            "its name; choose another name with --out"
        )
    return xml(
        _TEMPLATE,
        _head(sheet),
        element=name,
        parameters=[(s.variable, s.item or s.text) for s in listed],
        units=[unit for unit in model.description.unitDefinitions if unit.name in units],
    )


def _matlab(sheet: Sheet, model: Model, starts: list[_Start], name: str) -> str:
    """Formats a MATLAB function that returns a structure: parameter motor.B is field motor.B."""
    _identifier(name)
    said = [
        *_head(sheet),
        "rls.eta_0 is a matrix, whose indices begin with 1: rls.eta_0(i + 1, j + 1) is",
        "rls.eta_0[i,j] of the FMU. An enumeration is written as the number of its item.",
    ]
    lines = [f"function p = {name}", f"%{name.upper()} What was learned of a joint."]
    lines += (matlab_comment(f"  {line}") for line in said)
    single, curve = _divided(starts)
    for s in single:
        note = s.item or (f"[{s.variable.unit}]" if s.variable.unit else "")
        lines.append(f"p.{s.name} = {s.text}; {matlab_comment(note) if note else ''}".rstrip())
    lines += [f"p.rls.eta_0 = {_matrix(curve)};", "end", ""]
    return "\n".join(lines)


def _modelica(sheet: Sheet, model: Model, starts: list[_Start], name: str) -> str:
    """Formats a Modelica record: parameter motor.B is component motor.B; model becomes 'model'."""
    _identifier(name)
    single, curve = _divided(starts)
    groups: dict[str, list[str]] = {}
    for s in single:
        group = s.name.rpartition(".")[0]
        groups.setdefault(group, []).append(_component(s))
    size = f"{len(curve)}, {len(curve[0])}"
    text = f'= {_matrix(curve)} "Initial estimate, the curve"'
    groups["rls"].append(f"parameter Real eta_0[{size}] {text};")
    said = [
        *_head(sheet),
        "rls.eta_0[i + 1, j + 1] is rls.eta_0[i,j] of the FMU, whose indices begin with 0.",
        "An enumeration is written as the number of its item.",
    ]
    title = modelica_string(f"{sheet.fmu.name}: what was learned")
    lines = [f"record {name} {title}", *(f"  {modelica_comment(line)}" for line in said)]
    for group, declared in groups.items():
        if not group:
            lines += [f"  {each}" for each in declared]
            continue
        kind = f"{group[0].upper()}{group[1:]}Parameters"
        name_of = f"'{group}'" if group in _RESERVED else group  # such as 'model'
        components = [f"    {each}" for each in declared]
        lines += [f"  record {kind}", *components, f"  end {kind};", f"  {kind} {name_of};"]
    return "\n".join([*lines, f"end {name};", ""])


def _component(s: _Start) -> str:
    variable = s.variable
    kind = "Integer" if variable.type == "Enumeration" else variable.type
    unit = f"(unit={modelica_string(variable.unit)})" if variable.unit else ""
    text = f"{variable.description}: {s.item}" if s.item else variable.description
    name = s.name.rpartition(".")[2]
    return f"parameter {kind} {name}{unit} = {s.text} {modelica_string(text)};"


def _divided(starts: list[_Start]) -> tuple[list[_Start], list[list[float]]]:
    """Splits start values into single values and the matrix rls.eta_0."""
    single, curve = [], {}
    for s in starts:
        if s.name.startswith(_CURVE):
            i, j = map(int, s.name[len(_CURVE) : -1].split(","))
            curve[i, j] = float(s.value)
        else:
            single.append(s)
    n, m = (max(each[k] for each in curve) + 1 for k in (0, 1))
    return single, [[curve[i, j] for j in range(m)] for i in range(n)]


def _matrix(rows: list[list[float]]) -> str:
    """Formats a matrix in the syntax of MATLAB and Modelica."""
    return f"[{'; '.join(', '.join(map(repr, row)) for row in rows)}]"


_WORDS = """
    algorithm and annotation block break class connect connector constant constrainedby der discrete
    each else elseif elsewhen encapsulated end enumeration equation expandable extends external
    false final flow for function if import impure in initial inner input loop model not operator or
    outer output package parameter partial protected public pure record redeclare replaceable return
    stream then true type when while within
    case catch continue global otherwise parfor persistent spmd switch try
"""
_RESERVED = frozenset(_WORDS.split())  # words of Modelica and, in the last line, of MATLAB


def _identifier(name: str) -> None:
    """Raises ValueError for a name that is not allowed for a MATLAB function or Modelica record."""
    if not re.fullmatch(r"[A-Za-z][A-Za-z0-9_]*", name) or name in _RESERVED:
        raise ValueError(
            f"file name {quoted(name)}: expected letters, digits and _, a letter first, and no "
            "keyword of the language; choose another name with --out"
        )


KINDS: Mapping[str, Callable[[Sheet, Model, list[_Start], str], str]] = {
    "ssv": _ssv,
    "matlab": _matlab,
    "modelica": _modelica,
}
"""Functions that format the text of a parameter file, by kind of the file."""
