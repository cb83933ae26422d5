"""What the estimator itself reports when the log is replayed."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from sigmahat.checks.findings import Finding, Kind, Severity
from sigmahat.checks.view import View
from sigmahat.fmi.instance import Slave
from sigmahat.identification.noise import variance
from sigmahat.logs.replay import parameters, replay

_MISFIT = 3.0  # of the model; unmodelled effects of real joints cause up to about 2
_NOISE = 3.0  # ratio of standard deviations, measured to configured
_LEARNED = 0.5
_DOUBTED = 0.5  # fraction of the second half
_ROOM = 1.2  # ratio of a proposed range to the largest value
_WIDE = 5.0  # a range is too wide from this ratio to the largest value
_TORQUE = 3.0  # ratio of torques, measured to configured

Outputs = Mapping[str, np.ndarray[Any, Any]]
_KEYS = {
    "NotExcited": "ports.q.column",
    "Misfit": "rls.n",
    "OutOfRange": "range.phi",
    "FrictionOutsidePrior": "motor.D_theta",
    "InertiaOutsidePrior": "motor.B",
    "NegativeStiffness": "ports.q.sign",
    "Change": "rls.n",
}


def play(slave: Slave, seen: View) -> Outputs:
    """Outputs of the estimator at the ticks of the view. Raises FmuError if the FMU refuses."""
    start = parameters(slave.fmu, seen.configuration)
    with slave.only_errors():  # the FMU's warnings are findings here
        (outputs,) = replay(slave, seen.samples, start, len(seen.samples.values))
    return outputs


def replayed(seen: View, outputs: Outputs) -> Iterator[Finding]:
    yield from _range(seen, outputs)
    yield from _noise(seen)
    valid = outputs["valid"]
    learned = float(np.mean(valid & (outputs["a"] > 0)))
    if learned < _LEARNED:
        yield Finding(Kind.LEARNED, Severity.NOTE, "time.longest_gap", learned, "", 1.0)
    if seen.every["method"] == "FilteredRegression":
        yield from _claims(outputs)


def _range(seen: View, outputs: Outputs) -> Iterator[Finding]:
    every, known = seen.every, seen.configuration.parameters
    is_regression = every["method"] == "FilteredRegression"
    phi, given = float(np.max(np.abs(outputs["phi"]))), float(every["range.phi"])
    # A value that identify will set is no finding before identify has run.
    if is_regression and "range.phi" in known and not given / _WIDE < phi < given:
        severity = Severity.WRONG if phi > _ROOM * given else Severity.NOTE
        proposed = float(f"{_ROOM * phi:.3g}")
        yield Finding(Kind.RANGE, severity, "range.phi", phi, "rad", given, proposed)
    torque = max((float(np.max(np.abs(p.tau))) for p in seen.pieces), default=0.0)
    torque, given = abs(seen.gamma) * torque, float(every["prior.tau_e"])
    if is_regression and "prior.tau_e" in known and torque > _TORQUE * given > 0:
        proposed = float(f"{_ROOM * torque:.3g}")
        key = "prior.tau_e"
        yield Finding(Kind.RANGE, Severity.WRONG, key, torque, "N.m", given, proposed)


def _noise(seen: View) -> Iterator[Finding]:
    """Noise of the torque: the lower limit of the prediction error."""
    key = "noise.tau_e" if seen.has_sensor else "noise.tau"
    if not seen.pieces or (seen.every["modality"] == "Model"):
        return
    times = abs(seen.gamma) if seen.has_sensor else 1.0
    longest = max(seen.pieces, key=lambda piece: len(piece.tau))
    noise, given = times * variance(longest.tau) ** 0.5, float(seen.every[key])
    if given > 0 and noise > 0 and not 1 / _NOISE < noise / given < _NOISE:
        proposed = float(f"{noise:.3g}")
        yield Finding(Kind.NOISE, Severity.NOTE, key, noise, "N.m", given, proposed)


def _claims(outputs: Outputs) -> Iterator[Finding]:
    """Misfit of the model, and doubts that the estimator reports often."""
    misfit = float(outputs["misfit"][-1])
    if misfit > _MISFIT:
        yield Finding(Kind.MISFIT, Severity.NOTE, "rls.n", misfit, "", 1.0)
    doubts = outputs["doubt"][len(outputs["doubt"]) // 2 :]
    for item, key in _KEYS.items():
        share = float(np.mean(doubts == item))
        if share > _DOUBTED and not (item == "Misfit" and misfit > _MISFIT):
            yield Finding(Kind.DOUBT, Severity.NOTE, key, share, "", 0.0, about=item)
