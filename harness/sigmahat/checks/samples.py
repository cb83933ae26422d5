"""Checks the recorded columns: steps of an encoder, jumps, saturation of the torque."""

import math
from collections.abc import Iterator

import numpy as np

from sigmahat.checks.findings import Finding, Kind, Proposal, Severity
from sigmahat.checks.view import View
from sigmahat.guess.columns import PERIODS, smallest_step
from sigmahat.motor.noise import is_only_noise
from sigmahat.recording.configuration import Port
from sigmahat.recording.log import Array
from sigmahat.recording.units import factor, unwrap

_LOOKED_AT = 20_000  # approximate number of values that are searched for the step of an encoder
_STEPS = 20  # least number of steps between distinct values of an encoder
_FINER = 1.5  # largest ratio of a correct configured step to the step in the log
_FLAT = 3  # consecutive samples at an end of the range
_OFTEN = 0.01  # fraction of all samples
_SAME = 0.001  # relative tolerance of the logarithm of the ratio of rad to deg
_LEAST = 20  # samples
_SPIKE, _UNUSUAL, _ALONE = 0.1, 20.0, 5.0
"""Least distance of a spike from both neighbours, relative to the range, to the usual distance and
the encoder step, and to the distance between the neighbours."""
_SMOOTH = 0.01  # least distance of a spike relative to the range, without an encoder step
_FEW = 50  # with fewer distinct values, the torque is a series of steps


def columns(seen: View) -> Iterator[Finding]:
    for name, port in seen.configuration.ports.items():
        if port.value is not None:
            continue
        values = seen.log.read(port.column)
        finite = np.isfinite(values)
        values = values if finite.all() else values[finite]  # avoids a copy of a long log
        if name in ("theta", "q"):
            of_encoder = encoder_step(values)
            yield from list(_spikes(name, port, values, of_encoder)) or _jumps(name, port, values)
            yield from step(seen, name, port, of_encoder)
        if name == "tau" and is_only_noise(values):
            key, size = f"ports.{name}.column", float(np.std(values))
            yield Finding(Kind.NO_TORQUE, Severity.NOTE, key, size, port.unit or "N.m")
        elif name == "tau":
            yield from _saturation(values)


def at_rest(seen: View) -> Iterator[Finding]:
    """Finds positions that do not change: such a log has no information on the joint."""
    ports = [name for name in ("theta", "q") if name in seen.samples.names]
    still = []
    for name in ports:
        values = seen.samples.values[:, list(seen.samples.names).index(name)]
        known = values[np.isfinite(values)]
        is_given = seen.configuration.ports[name].value is not None
        if len(known) and float(np.ptp(known)) == 0 and not is_given:
            still.append(name)
    if still and seen.every["modality"] != "Sensor":
        what = "joint" if still == ports else still[0]
        measured = float(len(seen.samples.values)) * seen.T
        key = f"ports.{still[-1]}.column"
        yield Finding(Kind.AT_REST, Severity.WRONG, key, measured, "s", about=what)


def _jumps(name: str, port: Port, values: Array) -> Iterator[Finding]:
    """Finds a counter that jumps back by its whole range, although the port has no wrap."""
    if port.wrap is not None or len(values) < 2:
        return
    steps, span = np.diff(values), float(np.ptp(values))
    jump = float(np.abs(steps, out=steps).max())
    if span == 0 or jump < 0.9 * span or float(np.quantile(steps, 0.9)) > 0.2 * jump:
        return
    period = min(PERIODS, key=lambda each: abs(each - span))
    known = period if abs(period / span - 1) < 0.02 else None
    key, unit = f"ports.{name}.wrap", port.unit or "rad"
    yield Finding(Kind.JUMP, Severity.WRONG, key, jump, unit, None, known, about=name)


def _spikes(name: str, port: Port, values: Array, of_encoder: float) -> Iterator[Finding]:
    """Finds single samples far from both neighbours, as if a bus or an encoder lost a value."""
    if len(values) < _LEAST:
        return
    if port.wrap is not None:
        values, _ = unwrap(values, port.wrap)
    span = float(np.diff(np.quantile(values, [0.01, 0.99]))[0])
    away = np.abs(values[1:-1] - (values[2:] + values[:-2]) / 2)
    least = _SMOOTH * span if math.isinf(of_encoder) else _UNUSUAL * of_encoder
    unusual = max(least, _UNUSUAL * float(np.quantile(away, 1 - 5 * _OFTEN)))
    lost = away > min(_SPIKE * span, unusual)
    lost &= away > _ALONE * np.abs(values[2:] - values[:-2])
    number, largest = int(np.count_nonzero(lost)), float(away.max())
    if 0 < number < _OFTEN * len(values):
        key, unit = f"ports.{name}.column", port.unit or "rad"
        yield Finding(Kind.SPIKE, Severity.WRONG, key, largest, unit, float(number), about=name)


def encoder_step(values: Array) -> float:
    """Returns the smallest step between distinct values; inf if the values show no encoder."""
    return smallest_step(values[:: max(1, len(values) // _LOOKED_AT)], _STEPS)


def step(seen: View, name: str, port: Port, of_encoder: float) -> Iterator[Finding]:
    """Compares the smallest step of the values with the step of the configured encoder."""
    given = float(seen.every[f"encoder.{name}"])
    if not given or math.isinf(of_encoder):
        return
    angle = abs(of_encoder * factor(name, port) / port.gear_ratio)
    expected = 2 * math.pi / given
    if 1 / _FINER < angle / expected < _FINER:
        return
    proposed: Proposal = float(round(2 * math.pi / angle))
    per_turn = (f"ports.{name}.counts_per_turn", None)
    others: list[tuple[str, Proposal | None]] = [per_turn] if port.unit == "counts" else []
    key = f"encoder.{name}"
    unit = "deg" if angle > expected else "rad"
    if abs(abs(math.log(angle / expected)) / math.log(180 / math.pi) - 1) < _SAME:
        others, key, proposed = [(key, proposed)], f"ports.{name}.unit", unit
    severity = Severity.WRONG if angle > expected else Severity.NOTE
    yield Finding(Kind.STEP, severity, key, angle, "rad", expected, proposed, others, name)


def _saturation(values: Array) -> Iterator[Finding]:
    """Finds saturation: the drive limited the torque, or the sensor was at the end of its range."""
    if len(np.unique(values[:_LOOKED_AT])) < _FEW:
        return
    tolerance = 1e-6 * float(np.ptp(values))
    at_end = (values >= values.max() - tolerance) | (values <= values.min() + tolerance)
    row = np.convolve(at_end, np.ones(_FLAT), "same") >= _FLAT
    share = float(np.mean(row))
    if share > _OFTEN:
        yield Finding(Kind.SATURATION, Severity.NOTE, "ports.tau.column", share, "", 0.0)
