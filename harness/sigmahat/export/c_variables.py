"""Writes the C table of the FMU variables (``fmu_src/model.h``) from the model description."""

import re
from collections.abc import Callable
from pathlib import Path
from xml.etree.ElementTree import Element

from sigmahat.export.templates import items, render, variables

SEED, SAMPLE_PERIOD = "noise.seed", "noise.samplePeriod"
"""Parameters that a plant with noise has in addition to the parameters of its equations."""

_OWN_FIELDS = {SEED: "seed", SAMPLE_PERIOD: "samplePeriod"}  # of sh_plant
_SIGNAL = re.compile(r"signal\.(\w+)\.(amplitude|frequency)")


def _field(variable: Element, name: str) -> str:
    part = {"input": "input", "output": "output", "parameter": "parameters"}
    return f"{part[variable.attrib['causality']]}.{name.replace(',', '][')}"


def storage_in_struct(root: Element) -> dict[str, str]:
    """Returns the C expression of every variable in a struct with fields named like the variables.

    ``motor.B`` is ``parameters.motor.B``, ``eta[1,2]`` is ``output.eta[1][2]``.
    """
    return {v.attrib["name"]: _field(v, v.attrib["name"]) for v in variables(root)}


def storage_in_sides(root: Element) -> dict[str, str]:
    """Returns the C expression of every variable in a struct with ``side[0]`` and ``side[1]``.

    ``motor_2.B`` is ``side[1].parameters.motor.B``. Common inputs and parameters of both sides are
    in ``side[0]``; common outputs of both sides are separate fields.
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
    """Returns the C expression of every variable of a plant, in the arrays p, u and y.

    Parameters for which `is_of_every_plant` is true have their own fields.
    """
    array = {"input": "u", "output": "y", "parameter": "p"}
    count = dict.fromkeys(array.values(), 0)
    places: dict[str, str] = {}
    for variable in variables(root):
        full = variable.attrib["name"]
        if is_of_every_plant(full):
            signal = _SIGNAL.fullmatch(full)
            places[full] = signal[2] + places[signal[1]][1:] if signal else _OWN_FIELDS[full]
            continue
        name = array[variable.attrib["causality"]]
        places[full] = f"{name}[{count[name]}]"
        count[name] += 1
    return places


def is_of_every_plant(parameter: str) -> bool:
    """Returns whether a parameter belongs to ``fmu_src/plant.c``, not to the plant equations."""
    return parameter in _OWN_FIELDS or _SIGNAL.fullmatch(parameter) is not None


STORAGE: dict[str, Callable[[Element], dict[str, str]]]
STORAGE = {"struct": storage_in_struct, "sides": storage_in_sides, "arrays": storage_in_arrays}
"""Functions that return the C expressions of the FMU variables, by layout of the struct."""


_BOOLEAN = {"true": "1", "false": "0"}


def _role(variable: Element) -> str:
    causality = variable.attrib["causality"]
    if causality == "output" and variable[0].get("start") is not None:
        return "SH_ROLE_GUESS"
    kind = variable.attrib["variability"] if causality == "parameter" else causality
    return f"SH_ROLE_{kind.upper()}"  # the variability of a parameter is fixed or tunable


def _limits(root: Element, kind: Element) -> tuple[str, str]:
    if kind.tag == "Enumeration":
        values = [int(item["value"]) for item in items(root, kind)]
        return str(min(values)), str(max(values))
    if kind.tag == "Boolean":
        return "0", "1"
    return kind.get("min", "-HUGE_VAL"), kind.get("max", "HUGE_VAL")


def c_table(root: Element, struct: str, places: dict[str, str], guid: str) -> str:
    """Formats a C header with identifier, GUID and table of variables (``fmu_src/model.h``).

    ``struct`` is the type that holds the variables at ``places``, which the including file
    must have defined.
    """
    identifier = root.findall("CoSimulation")[0].attrib["modelIdentifier"]
    rows = []
    for variable in variables(root):
        kind, name = variable[0], variable.attrib["name"]
        start = _BOOLEAN.get(kind.get("start", ""), kind.get("start", "0"))
        low, high = _limits(root, kind)
        rows.append(
            f'    {{"{name}", offsetof({struct}, {places[name]}), '
            f"SH_TYPE_{kind.tag.upper()}, {_role(variable)}, {start}, {low}, {high}}},"
        )
    table = "\n".join(rows)
    return f"""\
/* Generated from the model description; do not edit. */
#define SH_IDENTIFIER "{identifier}"
#define SH_GUID "{guid}"

static const sh_variable VARIABLES[] = {{
{table}
}};
"""


_LARGEST = {"rls.n": "SH_MAX_N", "rls.m": "SH_MAX_M"}  # sizes that can be given to the compiler


def write_parameters(template: Path, out: Path) -> None:
    """Write ``c/parameters.inc`` from the template of an estimator with one motor.

    The coefficients ``rls.eta_0`` are not in the table: they start at 0, and have no limits.
    """
    rows: dict[str, list[str]] = {"REAL": [], "INTEGER": []}
    root = render(template, "")
    for variable in variables(root):
        if variable.attrib["causality"] == "parameter" and "[" not in variable.attrib["name"]:
            macro = "REAL" if variable[0].tag == "Real" else "INTEGER"
            rows[macro].append(f"    {macro}({', '.join(_row(root, variable))})")
    reals, integers = map("\n".join, rows.values())
    text = f"""\
/* Generated from modelDescription/ by the target parameter_table; do not edit.
 * A row: place in sh_parameters, start, least and largest value, range in words.
 */
static const real_parameter REALS[] = {{
{reals}
}};

static const integer_parameter INTEGERS[] = {{
{integers}
}};
"""
    out.write_text(text, encoding="utf-8")


def _row(root: Element, variable: Element) -> tuple[str, ...]:
    name, kind = variable.attrib["name"], variable[0]
    start, low, high = kind.attrib["start"], kind.get("min"), kind.get("max")
    if kind.tag == "Boolean":
        return name, _BOOLEAN[start], "0", "1", '"0 or 1"'
    if kind.tag == "Enumeration":
        words = [f"{item['value']} ({item['name']})" for item in items(root, kind)]
        allowed = f"{', '.join(words[:-1])} or {words[-1]}"
        return name, start, "1", str(len(words)), f'"{allowed}"'
    if name in _LARGEST:
        return name, start, str(low), _LARGEST[name], f'"{low} to " SH_TEXT_OF({_LARGEST[name]})'
    allowed = f"{low} to {high}" if high else f">= {low}" if low else "finite"
    return name, start, low or "-INFINITY", high or "INFINITY", f'"{allowed}"'
