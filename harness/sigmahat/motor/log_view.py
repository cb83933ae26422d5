"""Selects the part of a log from which motor and configuration are inferred."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from sigmahat.fmi.model import Value
from sigmahat.motor.signals import Signals, signals_of
from sigmahat.recording.configuration import Configuration
from sigmahat.recording.estimator_parameters import all_parameters
from sigmahat.recording.log import Array, Log
from sigmahat.recording.notes import FirstPart
from sigmahat.recording.sampling import Samples, sample

_MOST = 60_000
"""Largest number of ticks of a check; from a longer log, the part with the most motion is used."""
_LONGEST = 600.0  # [s] of a log from which the motor is identified


@dataclass(frozen=True)
class LogView:
    """Part of a log as its configuration describes it."""

    log: Log  # unprocessed log, for effects that conversion and sampling would hide
    configuration: Configuration  # configuration without any correction
    parameters: Mapping[str, Value]  # all parameters of the estimator
    samples: Samples
    pieces: Sequence[Signals]
    """Parts of the log without a gap, in which theta, q and the torque of the modality are known.
    Here tau is the motor's torque, or the sensor's torque converted to the motor."""

    @property
    def T(self) -> float:
        return self.samples.T

    @property
    def gamma(self) -> float:
        return float(self.parameters["motor.gamma"])

    @property
    def has_sensor(self) -> bool:
        return self.parameters["modality"] == "Sensor"

    @property
    def longest(self) -> Signals:
        return max(self.pieces, key=lambda piece: len(piece.theta))

    def scaled(self, port: str, factor: float) -> LogView:
        """Multiplies the signals of theta, q or tau by a factor."""
        return self._with_port(port, lambda values: factor * values)

    def earlier(self, port: str, time: float) -> LogView:
        """Moves the signals of theta, q or tau to earlier times [s]."""
        return self._with_port(port, lambda values: _moved(values, time / self.T))

    def exchanged(self) -> LogView:
        """Takes theta for q, and q for theta."""
        pieces = [replace(each, theta=each.theta + each.phi, phi=-each.phi) for each in self.pieces]
        return replace(self, pieces=pieces)

    def _with_port(self, port: str, change: Callable[[Array], Array]) -> LogView:
        """Changes the signals of one port, and with theta or q the deformation."""
        pieces = []
        for piece in self.pieces:
            if port == "tau":
                pieces.append(replace(piece, tau=change(piece.tau)))
                continue
            angles = {"theta": piece.theta, "q": piece.theta + piece.phi}
            angles[port] = change(angles[port])
            theta = angles["theta"]
            pieces.append(replace(piece, theta=theta, phi=angles["q"] - theta))
        return replace(self, pieces=pieces)


def liveliest_part(log: Log, configuration: Configuration) -> LogView:
    """Selects the 60000 ticks of a log with the largest motion, for a check.

    Raises LogError if log and configuration do not fit.
    """
    parameters = all_parameters(configuration)
    configuration.need_ports(str(parameters["modality"]))
    samples = _liveliest(sample(log, configuration, float(parameters["samplePeriod"])))
    pieces = list(signals_of(samples, parameters, _torque(parameters)))
    return LogView(log, configuration, parameters, samples, pieces)


def first_part(log: Log, configuration: Configuration, both_torques: bool) -> LogView:
    """Selects the first 600 s of a log, for an identification.

    both_torques  whether the sensor torque is kept in addition to the motor torque, in any modality

    Raises LogError if log and configuration do not fit.
    """
    parameters = all_parameters(configuration)
    samples = _beginning(sample(log, configuration, float(parameters["samplePeriod"])))
    torque = "tau" if both_torques else _torque(parameters)
    pieces = list(signals_of(samples, parameters, torque, sensor=both_torques))
    return LogView(log, configuration, parameters, samples, pieces)


def _torque(parameters: Mapping[str, Value]) -> str:
    """Returns the port of the torque of the modality."""
    return "tau_e_sensor" if parameters["modality"] == "Sensor" else "tau"


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


def _beginning(samples: Samples) -> Samples:
    if len(samples.values) * samples.T <= _LONGEST:
        return samples
    return replace(
        samples,
        values=samples.values[: round(_LONGEST / samples.T)],
        notes=[*samples.notes, FirstPart(duration=_LONGEST)],
    )


def _moved(signal: Array, ticks: float) -> Array:
    """Shifts a signal to earlier times by a number of ticks."""
    at = np.arange(len(signal), dtype=np.float64)
    return np.interp(at + ticks, at, signal)
