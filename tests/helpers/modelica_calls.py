"""The C calls that a Modelica tool makes for the estimator block, from the Modelica sources."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Any

import pymoca.ast
from numpy.typing import NDArray

from modelica_package import KEYWORDS, PACKAGE, classes, external_arguments

INTERNAL = "Estimators/Internal.mo"
INPUTS = ("theta", "q", "theta_c", "tau", "tau_e_sensor")
_IN_C = {"Boolean": "int", "Integer": "int", "Types.Doubt": "int"}


def outputs() -> dict[str, tuple[str, int]]:
    """The outputs of a tick by name: type in C, and number of elements."""
    tick = classes()["Estimators.Internal.tick"]
    return {
        name: (_IN_C.get(str(each.type), "double"), 40 if name == "eta" else 1)
        for name, each in tick.symbols.items()
        if "output" in each.prefixes
    }


def calls(parameters: Mapping[str, Any], eta_0: NDArray[Any]) -> str:
    """The text of calls.h for tests/drivers/modelica/tool.c.

    parameters are numbers by their names in the FMU; eta_0 is rls.eta_0.
    """
    new, tick = "sigmahat_estimator_new", "sigmahat_estimator_tick"
    values = [_in_c(value, parameters, eta_0) for value in constructor_arguments()]
    arguments = ", ".join(_tick_argument(name) for name in external_arguments(INTERNAL, tick))
    declared = " ".join(
        f"{c_type} {name}{f'[{size}]' if size > 1 else ''};"
        for name, (c_type, size) in outputs().items()
    )
    written = " ".join(
        f"put_integer({name});"
        if c_type == "int"
        else f"put({name if size > 1 else f'&{name}'}, {size});"
        for name, (c_type, size) in outputs().items()
    )
    return "\n".join(
        [
            *(_prototype(name) for name in ("new", "tick", "free")),
            f"#define NEW {new}({', '.join(values)})",
            f"#define OUTPUTS {declared[:-1]}",
            f"#define TICK(object, t, z) {tick}({arguments})",
            f"#define WRITE {written[:-1]}",
            "",
        ]
    )


def _prototype(name: str) -> str:
    text = (PACKAGE / "Resources" / "C-Sources" / f"sigmahat_estimator_{name}.c").read_text()
    found = re.search(rf"^\w[\w ]*\*?sigmahat_estimator_{name}\([^)]*\)", text, re.MULTILINE)
    assert found
    return f"{' '.join(found[0].split())};"


def constructor_arguments() -> list[Any]:
    """What the block gives to the constructor: names of parameters, and lists of them."""
    block = classes()["Estimators.StiffnessEstimator"]
    (call,) = block.symbols["estimator"].class_modification.arguments
    operands = call.value.modifications[0].operands
    order = list(classes()["Estimators.Internal.Estimator.constructor"].symbols)
    # The C function takes them in the order in which the Modelica function declares them.
    assert [*order][:-1] == external_arguments(INTERNAL, "sigmahat_estimator_new")
    return [
        [_name(each) for each in operand.values]
        if isinstance(operand, pymoca.ast.Array)
        else _name(operand)
        for operand in operands
    ]


def _name(reference: pymoca.ast.ComponentRef) -> str:
    """The name in the FMU of a parameter of the block."""
    group, *last = [reference.name, *(child.name for child in reference.child)]
    back = {ours: theirs for theirs, ours in KEYWORDS.items()}
    return ".".join([back.get(group, group) if last else group, *last])


def _in_c(value: str | list[str], parameters: Mapping[str, Any], eta_0: NDArray[Any]) -> str:
    if isinstance(value, str) and value != "rls.eta_0":
        return repr(parameters[value])
    numbers = eta_0.ravel() if isinstance(value, str) else [parameters[name] for name in value]
    return f"(const double[]){{{', '.join(repr(float(number)) for number in numbers)}}}"


def _tick_argument(name: str) -> str:
    if name == "estimator":
        return "(object)"
    if name == "t":
        return "(t)"
    if name in INPUTS:
        return f"(z)[{INPUTS.index(name)}]"
    return name if outputs()[name][1] > 1 else f"&{name}"
