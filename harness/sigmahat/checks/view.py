"""Selects the part of a log that the checks use, with a limited number of ticks."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from sigmahat.fmi.model import Value
from sigmahat.motor.equation import Signals, signals_of
from sigmahat.recording.configuration import Configuration
from sigmahat.recording.estimator_parameters import all_parameters
from sigmahat.recording.log import Log
from sigmahat.recording.resampling import Samples, sample

_MOST = 60_000
"""Largest number of ticks; from a longer log, the checks use the part with the most motion."""


@dataclass(frozen=True)
class View:
    log: Log  # unprocessed log, for effects that conversion and sampling would hide
    configuration: Configuration  # configuration without any correction
    every: Mapping[str, Value]  # all parameters of the estimator
    samples: Samples  # at most 60000 ticks
    pieces: Sequence[Signals]
    """Parts of the log without a gap, in which theta, q and the torque of the modality are known.
    Here tau is the motor's torque, or the sensor's torque converted to the motor."""

    @property
    def T(self) -> float:
        return self.samples.T

    @property
    def gamma(self) -> float:
        return float(self.every["motor.gamma"])

    @property
    def has_sensor(self) -> bool:
        return self.every["modality"] == "Sensor"


def view(log: Log, configuration: Configuration) -> View:
    """Samples a log for the checks. Raises LogError if log and configuration do not fit."""
    every = all_parameters(configuration)
    configuration.need_ports(str(every["modality"]))
    samples = _liveliest(sample(log, configuration, float(every["samplePeriod"])))
    torque = "tau_e_sensor" if every["modality"] == "Sensor" else "tau"
    return View(log, configuration, every, samples, list(signals_of(samples, every, torque)))


def _liveliest(samples: Samples) -> Samples:
    """Selects the ticks with the largest motion of theta, or of q if theta is missing."""
    ticks = len(samples.values)
    if ticks <= _MOST:
        return samples
    angle = "theta" if "theta" in samples.names else "q"
    values = samples.values[:, list(samples.names).index(angle)]
    starts = np.linspace(0, ticks - _MOST, 50).astype(int)
    ways = [np.nansum(np.abs(np.diff(values[first : first + _MOST]))) for first in starts]
    first = int(starts[np.argmax(ways)])
    return replace(samples, values=samples.values[first : first + _MOST])
