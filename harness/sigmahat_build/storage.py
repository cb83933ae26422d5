"""The places of the FMU variables in the C structs that hold them."""

import re
from collections.abc import Callable
from xml.etree.ElementTree import Element

from sigmahat.plant_fmu.c_variables import storage_in_arrays
from sigmahat.plant_fmu.model_description import variables


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


STORAGE: dict[str, Callable[[Element], dict[str, str]]]
STORAGE = {"struct": storage_in_struct, "sides": storage_in_sides, "arrays": storage_in_arrays}
"""Functions that return the C expressions of the FMU variables, by layout of the struct."""
