"""The limits of parameters in the model description are values that the FMU accepts."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

import pytest

import sigmahat
from fmi_instance import ERROR, OK, Instance
from fmi_runs import ESTIMATORS, PLANTS

every_fmu = pytest.mark.parametrize("name", ESTIMATORS + PLANTS)

# At this limit alone, a relation to another parameter is not met: filter.V_min is not above V_max.
REFUSED_BY_A_RELATION = {("filter.V_max", "min")}


def limits(variable: Any) -> Iterator[tuple[str, float, float]]:
    """Of a parameter: which limit, the limit, and the next value outside."""
    if variable.type == "Enumeration":
        items = [int(item.value) for item in variable.declaredType.items]
        yield "min", min(items), min(items) - 1
        yield "max", max(items), max(items) + 1
    elif variable.type == "Integer":
        for which, step in (("min", -1), ("max", 1)):
            limit = getattr(variable, which)
            if limit is not None:
                yield which, int(limit), int(limit) + step
    elif variable.type == "Real":
        for which, outward in (("min", -math.inf), ("max", math.inf)):
            limit = getattr(variable, which)
            real = float(outward if limit is None else limit)
            yield which, real, math.nextafter(real, outward)


def initialise(fmu: Instance, name: str, value: float) -> tuple[int, str]:
    """The first status that is not OK when a parameter is set and initialised, and its message."""
    assert fmu.call("Reset") == OK
    status = fmu.set(name, value)
    if status == OK:
        assert fmu.enter() == OK
        status = fmu.exit()
    return status, fmu.messages[-1][2] if status != OK else ""


@every_fmu
def test_a_parameter_at_its_limit_is_accepted_and_beyond_it_refused_by_its_name(name: str) -> None:
    with Instance(sigmahat.fmu(name)) as fmu:
        checked = 0
        for parameter, variable in fmu.variables.items():
            if variable.causality != "parameter":
                continue
            for which, limit, beyond in limits(variable):
                if math.isfinite(limit):
                    status, message = initialise(fmu, parameter, limit)
                    by_relation = (parameter, which) in REFUSED_BY_A_RELATION
                    assert status == (ERROR if by_relation else OK), message
                status, message = initialise(fmu, parameter, beyond)
                assert status == ERROR, (parameter, beyond)
                assert parameter in message
                checked += 1
        assert checked > 20
