"""Writes the table of the parameters of the C library, ``c/parameters.inc``."""

from pathlib import Path
from xml.etree.ElementTree import Element

from sigmahat.plant_fmu.c_variables import BOOLEAN
from sigmahat.plant_fmu.model_description import items, variables
from sigmahat_build.description_template import render

_LARGEST = {"rls.n": "SH_MAX_N", "rls.m": "SH_MAX_M"}  # sizes that can be given to the compiler

_PERIOD = "1/samplePeriod"  # the only limit of start values that the library knows


def write(template: Path, out: Path) -> None:
    """Write ``c/parameters.inc`` from the template of an estimator with one motor.

    The coefficients ``rls.eta_0`` are not in the table: they start at 0, and have no limits.
    """
    rows: dict[str, list[str]] = {"REAL": [], "INTEGER": []}
    root = render(template, "")
    for variable in variables(root):
        if variable.attrib["causality"] == "parameter" and "[" not in variable.attrib["name"]:
            kind = "REAL" if variable[0].tag == "Real" else "INTEGER"
            macro = "RATE" if variable.get("at_most") == _PERIOD else kind
            rows[kind].append(f"    {macro}({', '.join(_row(root, variable))})")
    reals, integers = map("\n".join, rows.values())
    text = f"""\
/* Generated from modelDescription/ by the target parameter_table; do not edit.
 * A row: place in sh_parameters, start, least and largest value, range in words.
 * A RATE starts at most at 1 / samplePeriod.
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
        return name, BOOLEAN[start], "0", "1", '"0 or 1"'
    if kind.tag == "Enumeration":
        words = [f"{item['value']} ({item['name']})" for item in items(root, kind)]
        allowed = f"{', '.join(words[:-1])} or {words[-1]}"
        return name, start, "1", str(len(words)), f'"{allowed}"'
    if name in _LARGEST:
        return name, start, str(low), _LARGEST[name], f'"{low} to " SH_TEXT_OF({_LARGEST[name]})'
    allowed = f"{low} to {high}" if high else f">= {low}" if low else "finite"
    return name, start, low or "-INFINITY", high or "INFINITY", f'"{allowed}"'
