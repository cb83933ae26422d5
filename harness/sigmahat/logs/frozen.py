"""What an estimator says at any point of operation, without learning from it."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from fmpy import fmi2

from sigmahat.fmi.instance import Slave
from sigmahat.logs.configuration import PORTS
from sigmahat.logs.log import Array
from sigmahat.logs.replay import report_only_errors

_OUTPUTS = ("sigma", "sigma_std", "sigma_per_gain", "phi", "setPoint")


def stiffness_at(
    slave: Slave, names: Sequence[str], points: Array, t_0: float, T: float
) -> dict[str, Array]:
    """sigma, sigma_std, sigma_per_gain, phi and setPoint at each point, [size: points].

    Before each point a sample is missing. After such a gap MatchedFilter learns nothing until its
    filters have settled, and they never do: its answers are those of what it has learned before.
    The slave cannot be used for anything else afterwards.

    slave   of the method MatchedFilter, that has reached the time t_0 [s]
    names   of inputs, theta and q among them
    points  values of these inputs, finite [size: points x names]
    T       samplePeriod [s]
    """
    fmu, fmi, component = slave.fmu, slave.functions, slave.component
    every, inputs = fmu.references(PORTS, "input"), fmu.references(names, "input")
    outputs = fmu.references(_OUTPUTS, "output")
    zeros = (fmi2.fmi2Real * len(PORTS))()
    missing = fmu.references(names[:1], "input")
    nan = (fmi2.fmi2Real * 1)(np.nan)
    table = np.empty((len(points), len(_OUTPUTS)))
    rows = np.ctypeslib.as_ctypes(np.ascontiguousarray(points))
    slave.call(fmi.fmi2SetReal, every, len(PORTS), zeros)
    report_only_errors(slave)
    t = [t_0 + T * k for k in range(2 * len(points))]
    for k, (row, out) in enumerate(zip(rows, np.ctypeslib.as_ctypes(table), strict=True)):
        fmi.fmi2SetReal(component, missing, 1, nan)
        fmi.fmi2DoStep(component, t[2 * k], T, fmi2.fmi2True)
        fmi.fmi2SetReal(component, inputs, len(names), row)
        if fmi.fmi2DoStep(component, t[2 * k + 1], T, fmi2.fmi2True) > fmi2.fmi2Warning:
            raise slave.failure("fmi2DoStep")
        fmi.fmi2GetReal(component, outputs, len(_OUTPUTS), out)
    return {name: np.ascontiguousarray(table[:, i]) for i, name in enumerate(_OUTPUTS)}
