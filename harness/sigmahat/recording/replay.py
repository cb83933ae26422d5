"""Replays the samples of a log through the estimator FMU, tick by tick."""

import math
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sigmahat.fmi.instance import Fmu, Slave, Value, installed
from sigmahat.fmi.sample_loop import Recorder, SampleLoop, step_times
from sigmahat.recording.configuration import PORTS, Configuration
from sigmahat.recording.log import LogError
from sigmahat.recording.resampling import Samples
from sigmahat.recording.units import counts_per_turn

OUTPUTS = (
    *("sigma", "tau_e", "tau_e_residual", "theta_dot", "phi", "setPoint", "a", "rho", "epsilon"),
    *("sigma_std", "tau_e_std", "D_theta_hat", "B_hat", "tau_coulomb_hat", "misfit", "bias_hat"),
    *("damping_hat", "load_friction_hat", "eccentric_hat", "delay_hat", "hysteresis_hat"),
    *("change_age", "sigma_per_gain"),
)
"""Real outputs of the estimator that are recorded."""
FLAGS = ("confident", "valid")  # Boolean outputs that are recorded
_LONGEST_GAP = 1_000_000  # largest number of missing samples in gap()
_RATES = ("regression.bandwidth", "residual.K_I")  # [1/s], below 2 / samplePeriod
_REASON = "doubt"  # an enumeration output; the names of the items are recorded


def parameters(fmu: Fmu, configuration: Configuration) -> dict[str, Value]:
    """Computes start values of the FMU from the configuration, counts of encoders included.
    Filters are not faster than the samples. If motor.gamma is 0 or missing, the gear ratio of theta
    is used.

    encoder.theta_c has no effect, but is set because the interface of the FMU contains it.

    Raises LogError for a name that the FMU does not have, or a value that does not fit.
    """
    start = dict(configuration.parameters)
    for name, port in configuration.ports.items():
        counts = counts_per_turn(port) if port.value is None else 0.0  # not rounded
        if counts is not None and f"encoder.{name}" in fmu.variables:
            start.setdefault(f"encoder.{name}", counts)
    theta = configuration.ports.get("theta")
    if theta is not None and theta.gear_ratio != 1 and not start.get("motor.gamma"):
        start["motor.gamma"] = abs(theta.gear_ratio)
    try:
        for name, value in start.items():
            fmu.variable(name, "parameter")
            fmu.number(name, value)
            if isinstance(value, float) and not math.isfinite(value):
                raise ValueError(f"parameters.{name}: expected a finite number, got {value}")
        if start.get("motor.gamma") == 0:
            raise ValueError("parameters.motor.gamma is 0; fill in the gear ratio of your joint")
        every = fmu.parameters(start)
        T = float(every["samplePeriod"])
        if T == 0:
            raise ValueError("parameters.samplePeriod is 0; fill in the time between two rows [s]")
        too_fast = {name: 1 / T for name in _RATES if float(every[name]) * T > 1}
        return {**too_fast, **start}
    except (ValueError, TypeError) as error:
        raise LogError(f"{configuration.path}: {error}") from error


def all_parameters(configuration: Configuration) -> dict[str, Value]:
    """Returns all parameters of the estimator, also parameters without a configured value."""
    fmu = installed("StiffnessEstimator")
    return fmu.parameters(parameters(fmu, configuration))


def play(
    slave: Slave, samples: Samples, chunk: int, t_0: float = 0.0, more: Sequence[str] = ()
) -> Iterator[dict[str, NDArray[Any]]]:
    """Yields the outputs of an initialised estimator by name, for one chunk of ticks at a time.

    The present time of the estimator is t_0 [s]. The sample at t_0 + t_k is the input of the tick
    at t_0 + t_k. Ports without a configuration keep their values, which are 0 at the start and
    after a gap.

    more  Real outputs that are recorded besides OUTPUTS
    """
    inputs = slave.fmu.references(samples.names, "input")
    for first in range(0, len(samples.values), chunk):
        values = np.ascontiguousarray(samples.values[first : first + chunk])
        t = t_0 + samples.T * np.arange(first, first + len(values), dtype=np.float64)
        names = (*OUTPUTS, *more, *FLAGS, _REASON)
        recorder, loop = Recorder(slave, names, len(values)), SampleLoop()
        loop.set_real(slave, inputs, values)
        loop.step(slave, step_times(t, samples.T))
        recorder.add_to(loop)
        with slave.only_errors():  # the notes of the samples already count the skipped ticks
            loop.run(0, len(values))
        columns = recorder.columns()
        yield {**columns, **{name: columns[name].astype(bool) for name in FLAGS}}


def gap(slave: Slave, t_0: float, every: Mapping[str, Value]) -> float:
    """Steps a slave without measurements from t_0 [s], so that its filters start again afterwards.

    The slave keeps its estimates, as after a gap in a log. FilteredRegression needs one missing
    sample. Paper2011 needs missing samples until the integral of the residual is discarded
    (sigmahat.h).

    every  parameters of the slave

    Returns the time at the end of the gap [s].
    """
    T = float(every["samplePeriod"])
    ticks = 1
    if every["method"] == "Paper2011":
        ticks = math.ceil(min(2 / (float(every["residual.K_I"]) * T), _LONGEST_GAP))
    inputs, loop = slave.fmu.references(PORTS, "input"), SampleLoop()
    loop.set_real(slave, inputs, np.full(len(PORTS), np.nan))
    loop.step(slave, step_times(np.full(1, t_0), ticks * T))
    loop.set_real(slave, inputs, np.zeros(len(PORTS)))
    with slave.only_errors():
        loop.run(0, 1)
    return t_0 + ticks * T
