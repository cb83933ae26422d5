"""Makes the C table of the FMU variables (``fmu_src/model.h``) from the model description."""

import re
from xml.etree.ElementTree import Element

from sigmahat.files.escape import c_string
from sigmahat.plant_fmu.model_description import items, variables

SEED, SAMPLE_PERIOD = "noise.seed", "noise.samplePeriod"
"""Parameters that a plant with noise has in addition to the parameters of its equations."""

_OWN_FIELDS = {SEED: "seed", SAMPLE_PERIOD: "samplePeriod"}  # of sh_plant
_SIGNAL = re.compile(r"signal\.(\w+)\.(amplitude|frequency)")


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


BOOLEAN = {"true": "1", "false": "0"}
"""Values of a Boolean in C, by their names in a model description."""


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
        start = BOOLEAN.get(kind.get("start", ""), kind.get("start", "0"))
        low, high = _limits(root, kind)
        rows.append(
            f"    {{{c_string(name)}, offsetof({struct}, {places[name]}), "
            f"SH_TYPE_{kind.tag.upper()}, {_role(variable)}, {start}, {low}, {high}}},"
        )
    table = "\n".join(rows)
    return f"""\
/* Generated from the model description; do not edit. */
#define SH_IDENTIFIER {c_string(identifier)}
#define SH_GUID {c_string(guid)}

static const sh_variable VARIABLES[] = {{
{table}
}};
"""
