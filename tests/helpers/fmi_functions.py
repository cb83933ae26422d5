"""The functions of FMI for co-simulation, from the headers of the standard that FMPy brings."""

import re
from pathlib import Path

import fmpy

HEADERS = Path(fmpy.__file__).parent / "c-code"
_MODEL_EXCHANGE = {
    *("EnterEventMode", "NewDiscreteStates", "EnterContinuousTimeMode", "CompletedIntegratorStep"),
    *("SetTime", "SetContinuousStates", "GetDerivatives", "GetEventIndicators"),
    *("GetContinuousStates", "GetNominalsOfContinuousStates"),
}
"""Functions of FMI 2.0 alone: in FMI 3.0 each library has all functions."""


def functions(prefix: str) -> dict[str, list[str]]:
    """By the name of a function, without its prefix "fmi2" or "fmi3": its parameters in C."""
    text = (HEADERS / f"{prefix}FunctionTypes.h").read_text()
    declared = re.findall(rf"^ *typedef [^;(]+\b{prefix}(\w+)TYPE *\(([^)]*)\);", text, re.M)
    left_out = _MODEL_EXCHANGE if prefix == "fmi2" else set()
    return {
        name: [" ".join(each.split()) for each in parameters.split(",")]
        for name, parameters in declared
        if name not in left_out
    }


def of_an_instance(prefix: str) -> dict[str, list[str]]:
    """Those that take an instance and leave it."""
    return {
        name: parameters
        for name, parameters in functions(prefix).items()
        if name != "FreeInstance" and re.match(rf"{prefix}(Component|Instance)\b", parameters[0])
    }
