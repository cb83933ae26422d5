"""Compares the steps of a measured angle with the resolution of the configured encoder."""

import math
from dataclasses import dataclass, replace

import numpy as np

from sigmahat.motor.hypotheses.hypothesis import Evidence, Hypothesis, with_value
from sigmahat.motor.log_view import LogView
from sigmahat.recording.column import step_of_encoder
from sigmahat.recording.log import Array
from sigmahat.recording.units import factor

_STEPS = 20  # least number of steps between distinct values of an encoder
_FINER = 1.5  # largest ratio of a correct configured step to the step in the log
_SAME = 0.001  # relative tolerance of the logarithm of the ratio of rad to deg


@dataclass(frozen=True)
class StepEvidence(Evidence):
    """An angle that changes in other steps than those of its encoder [rad]."""

    expected: float  # step of the configured encoder [rad]


def known_step(values: Array) -> float:
    """Returns the step of an encoder, in the unit of the column; inf if the values show no encoder.

    values  without nan
    """
    return step_of_encoder(values, _STEPS)


def other_step(view: LogView, name: str, step: float) -> StepEvidence | None:
    """Compares the step of theta or q with the configured encoder; None if they agree, or one of
    them is not known.

    step  from known_step()
    """
    port = view.configuration.ports[name]
    given = float(view.parameters[f"encoder.{name}"])
    if not given or math.isinf(step):
        return None
    angle = abs(step * factor(name, port) / port.gear_ratio)
    expected = 2 * math.pi / given
    if 1 / _FINER < angle / expected < _FINER:
        return None
    counts = Hypothesis(f"encoder.{name}", float(round(2 * math.pi / angle)))
    if abs(abs(math.log(angle / expected)) / math.log(180 / math.pi) - 1) < _SAME:
        unit = Hypothesis(f"ports.{name}.unit", "deg" if angle > expected else "rad")
        return StepEvidence(angle, [unit, counts], expected)
    if port.step is not None and f"encoder.{name}" not in view.configuration.parameters:
        return StepEvidence(angle, [Hypothesis(f"ports.{name}.step", step)], expected)
    if port.unit == "counts":
        per_turn = Hypothesis(f"ports.{name}.counts_per_turn", None)
        return StepEvidence(angle, [counts, per_turn], expected)
    return StepEvidence(angle, [counts], expected)


def denies(view: LogView, hypothesis: Hypothesis) -> bool:
    """Returns whether the encoder steps fit the given resolution only without the hypothesis."""
    name = hypothesis.port
    if f"encoder.{name}" not in view.configuration.parameters:
        return False
    values = view.log.read(view.configuration.ports[name].column)
    step = known_step(values[np.isfinite(values)])
    changed = with_value(view.configuration, hypothesis.key, hypothesis.value)
    after = replace(view, configuration=changed)
    return other_step(view, name, step) is None and other_step(after, name, step) is not None
