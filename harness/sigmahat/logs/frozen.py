"""What an estimator says at any point of operation, without learning from it."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from sigmahat.fmi.instance import Slave
from sigmahat.fmi.sample_loop import Recorder, SampleLoop, step_times
from sigmahat.logs.configuration import PORTS
from sigmahat.logs.log import Array

_OUTPUTS = ("tau_e_std", "sigma", "sigma_std", "sigma_per_gain", "phi", "setPoint")


def stiffness_at(
    slave: Slave, names: Sequence[str], points: Array, t_0: float, T: float
) -> dict[str, Array]:
    """The outputs _OUTPUTS at each point, by name, [size: points].

    Before each point a sample is missing. After such a gap FilteredRegression learns nothing until
    its filters have settled, and they never do: its answers are those of what it has learned
    before. The slave cannot be used for anything else afterwards.

    slave   of the method FilteredRegression, that has reached the time t_0 [s]
    names   of inputs, theta and q among them
    points  values of these inputs, finite [size: points x names]
    T       samplePeriod [s]
    """
    fmu = slave.fmu
    t = t_0 + T * np.arange(2 * len(points), dtype=np.float64).reshape(-1, 2)
    gap, sample = (step_times(each, T) for each in t.T)
    recorder = Recorder(slave, _OUTPUTS, len(points))
    loop = SampleLoop()
    loop.set_real(slave, fmu.references(PORTS, "input"), np.zeros(len(PORTS)))
    loop.set_real(slave, fmu.references(names[:1], "input"), np.full(1, np.nan))
    loop.step(slave, gap)
    loop.set_real(slave, fmu.references(names, "input"), np.ascontiguousarray(points))
    loop.step(slave, sample)
    recorder.add_to(loop)
    with slave.only_errors():
        loop.run(0, len(points))
    return recorder.columns()
