"""The signals of a log as the motor equation needs them: stretches without a gap."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, fields, replace

import numpy as np

from sigmahat.fmi.model import Value
from sigmahat.recording.gaps import stretches
from sigmahat.recording.log import Array
from sigmahat.recording.sampling import Samples

BLOCK = 0.25  # duration of a block; errors in different blocks count as independent [s]
EDGE = 0.1  # duration left out at both ends of a stretch, where the filter has not settled [s]
_LEAST = 40  # least number of samples of a stretch for the filters


@dataclass(frozen=True)
class Signals:
    """Signals in a stretch of a log without gaps; arrays of one size, samples T apart."""

    theta: Array
    phi: Array
    set_point: Array
    tau: Array
    tau_e: Array | None  # torque of the sensor, to identify the torque constant
    held: bool = False  # whether a drive holds tau until the next sample
    extra: Array | None = None
    """More regressors, [size: samples x columns]. These regressors are filtered like the torque,
    and are also used as instruments."""

    def __getitem__(self, kept: slice) -> Signals:
        """Selects samples of all signals."""
        signals = {field.name: getattr(self, field.name) for field in fields(self)}
        arrays = {name: x[kept] for name, x in signals.items() if isinstance(x, np.ndarray)}
        return replace(self, **arrays, held=self.held)

    def with_acting_torque(self) -> Signals:
        """Replaces a held torque by the mean of the torques before and after each sample."""
        if not self.held:
            return self
        before = np.append(self.tau[:1], self.tau[:-1])
        return replace(self, tau=(self.tau + before) / 2, held=False)


def shortest(T: float, blocks: int = 2) -> int:
    """Returns the least number of samples of a stretch, with this number of blocks."""
    return max(round((2 * EDGE + blocks * BLOCK) / T), _LEAST)


def signals_of(
    samples: Samples, parameters: Mapping[str, Value], torque: str = "tau", sensor: bool = False
) -> Iterator[Signals]:
    """Yields the stretches of a log without a gap, if long enough; none without q and torque.

    parameters  of the estimator
    torque      port of the torque; tau_e_sensor divided by the gear ratio replaces -tau
    sensor      whether the sensor torque is kept in addition to the motor torque
    """
    columns = dict(zip(samples.names, samples.values.T, strict=True))
    if not {"q", torque} <= columns.keys():
        return
    scale, offset = float(parameters["setPoint.scale"]), float(parameters["setPoint.offset"])
    for first, last in zip(*stretches(np.isfinite(samples.values).all(axis=1)), strict=True):
        if last - first < shortest(samples.T):
            continue
        part = {name: np.ascontiguousarray(x[first:last]) for name, x in columns.items()}
        nothing: Array = np.zeros(last - first)
        theta = part.get("theta", nothing)
        measured = part[torque]
        yield Signals(
            theta=theta,
            phi=part["q"] - theta,
            set_point=offset + scale * part.get("theta_c", nothing),
            tau=measured if torque == "tau" else -measured / float(parameters["motor.gamma"]),
            tau_e=part["tau_e_sensor"] if sensor else None,
            held=bool(parameters["torque.held"]) and torque == "tau",
        )


def units(pieces: Sequence[Signals]) -> tuple[float, float]:
    """Returns the divisors of deformation and set-point in the polynomial [rad, 1].

    The divisors are the largest magnitudes in all stretches, so that powers are of order 1.
    """
    phi = max(float(np.max(np.abs(piece.phi))) for piece in pieces)
    set_point = max(float(np.max(np.abs(piece.set_point))) for piece in pieces)
    return phi or 1.0, set_point or 1.0


def set_point_moves(pieces: Sequence[Signals]) -> bool:
    return any(np.ptp(piece.set_point) > 0 for piece in pieces)
