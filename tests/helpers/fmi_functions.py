"""The functions of FMI for co-simulation, from the headers of the standard that FMPy brings."""

import re
from collections.abc import Sequence
from pathlib import Path

import fmpy

HEADERS = Path(fmpy.__file__).parent / "c-code"
VARIABLES = r"(Real|Integer|Boolean|String|(U?Int|Float)\d+|Binary|Clock)"
"""Pattern of the types of variables in the names of functions."""
_MODEL_EXCHANGE = {
    *("EnterEventMode", "NewDiscreteStates", "EnterContinuousTimeMode", "CompletedIntegratorStep"),
    *("SetTime", "SetContinuousStates", "GetDerivatives", "GetEventIndicators"),
    *("GetContinuousStates", "GetNominalsOfContinuousStates"),
}
"""Functions of FMI 2.0 alone: in FMI 3.0 each library has all functions."""


def functions(prefix: str) -> dict[str, list[str]]:
    """C parameters by the name of the function without the prefix "fmi2" or "fmi3"."""
    text = (HEADERS / f"{prefix}FunctionTypes.h").read_text()
    declared = re.findall(rf"^ *typedef [^;(]+\b{prefix}(\w+)TYPE *\(([^)]*)\);", text, re.M)
    left_out = _MODEL_EXCHANGE if prefix == "fmi2" else set()
    return {
        name: [" ".join(each.split()) for each in parameters.split(",")]
        for name, parameters in declared
        if name not in left_out
    }


def of_an_instance(prefix: str) -> dict[str, list[str]]:
    """Functions that take an instance and do not free it."""
    return {
        name: parameters
        for name, parameters in functions(prefix).items()
        if name != "FreeInstance" and re.match(rf"{prefix}(Component|Instance)\b", parameters[0])
    }


# No variable has one of these types. Apart from names, they have the functions of String.
_LIKE_STRING = r"[GS]et(Float32|U?Int8|U?Int16|UInt32|UInt64)"


def _any_call(prefix: str, name: str, parameters: Sequence[str]) -> str:
    """A call of a function of an instance, in C, with any arguments and NULL."""
    numbers = {
        "size_t": "any_size()",
        f"{prefix}Real": "any_real()",
        f"{prefix}Float64": "any_real()",
    }
    arguments = ["INSTANCE"]
    for parameter in parameters[1:]:
        kind = parameter.removeprefix("const ").split("*")[0].split()[0]
        if parameter.endswith("]"):
            arguments.append("NULL")
        elif "*" in parameter:
            arguments.append(f"OR_NULL(any_array(sizeof({kind})))")
        else:
            arguments.append(numbers.get(kind, f"({kind})any_int()"))
    return f"{prefix}{name}({', '.join(arguments)})"


def _any_access(prefix: str, name: str, parameters: Sequence[str]) -> str:
    """A call of a function of variables, in C."""
    arguments, lengths = ["INSTANCE", "vr"], iter(["n", "any_number(n, way)"])
    for parameter in parameters[2:]:
        kind = parameter.removeprefix("const ").split()[0]
        if not parameter.endswith("]"):
            arguments.append(next(lengths))
        elif kind == "size_t":  # lengths of binary values, of which there are none
            arguments.append("NULL")
        else:
            arguments.append(f"any_array(way == 0 ? n * sizeof({kind}) : 0)")
    return f"{prefix}{name}({', '.join(arguments)})"


def write_calls(
    prefix: str, header: Path, before: Sequence[str] = (), left_out: str = "FMU"
) -> None:
    """Writes a header in C that calls the functions of a version of FMI with any arguments.

    call_any(which) calls one of CALLS functions of an instance. access_any(which, vr, n, way) calls
    one of ACCESSES functions of variables. The program defines INSTANCE, OR_NULL and any_*.

    before    lines of C before the calls
    left_out  pattern of names: the program itself calls those of states, and may call others
    """
    calls, accesses = [], []
    for name, parameters in of_an_instance(prefix).items():
        if re.fullmatch(_LIKE_STRING, name):
            continue
        if re.fullmatch(rf"[GS]et({VARIABLES}|Real(In|Out)putDerivatives)", name):
            accesses.append(_any_access(prefix, name, parameters))
        elif not re.search(left_out, name):
            calls.append(_any_call(prefix, name, parameters))
    lines = []
    for size, function, bodies in (
        ("CALLS", "call_any(int which)", calls),
        ("ACCESSES", "access_any(int which, const uint32_t vr[], size_t n, int way)", accesses),
    ):
        cases = [f"case {i}: {body}; break;" for i, body in enumerate(bodies)]
        lines += [f"enum {{ {size} = {len(bodies)} }};", f"static void {function}"]
        lines += ["{", *before, "switch (which) {", *cases, "}", "}"]
    header.write_text("\n".join([*lines, ""]))
