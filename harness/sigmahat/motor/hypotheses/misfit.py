"""Computes how much of the torque the motor equation explains, whatever a configuration has wrong.

The misfit of the estimator is relative to the configured noise, which `identify` has yet to find.
"""

import math
from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from sigmahat.motor.equation import COULOMB_VELOCITY, Equations, Form, explained, residual
from sigmahat.motor.hypotheses.hypothesis import Evidence, Hypothesis
from sigmahat.motor.log_view import LogView
from sigmahat.motor.noise import low_pass, variance
from sigmahat.motor.quick_fit import QuickFit, with_all_corrections
from sigmahat.motor.signals import EDGE, Signals, shortest
from sigmahat.motor.spring import change_of_spring, plain_equations
from sigmahat.recording.gaps import stretches

_UNEXPLAINED = 0.02
"""Largest share of the variance of the torque that a joint with usual unmodelled effects leaves. Of
sixty such logs, none left more than 0.008, also with wrong configurations. Of six logs of an
industrial robot, five left 0.024 to 0.084."""

_PER_COEFFICIENT = 3
"""Least number of independent samples of each coefficient in motion, from which a log is judged by
its motion alone: with fewer, the coefficients explain any torque. Two runs of an industrial robot,
of 10 s, have two each, and the model then seems to fit."""
_INDEPENDENT = 20  # least number of independent samples of each of two springs of four powers


def misfit(view: LogView, fit: QuickFit) -> Evidence | None:
    """Finds a torque that no key makes a function of the motion; None if the torque is one.

    A wrong sign, gear ratio, zero or inertia only changes coefficients of the motor equation, which
    are all free here. A spring that changes during the log is no misfit: the estimator finds it.
    Neither is a joint at rest, where static friction holds a part of the torque that no equation
    knows: under gravity, this part is large.

    Returns the torque that is left, divided by the torque without its mean, both RMS [1].
    """
    system = _in_motion(view, fit.form)
    share = 1 - explained(system)
    noise = max(variance(piece.tau) for piece in view.pieces)
    if share < _UNEXPLAINED or residual(system) < noise * int(system.rows.sum()):
        return None
    if _is_changing(view, fit.form.f_0):
        return None
    port = "tau_e_sensor" if view.has_sensor else "tau"
    return Evidence(math.sqrt(share), [Hypothesis(f"ports.{port}.column", None)])


def is_explained_by_swap(view: LogView, fit: QuickFit) -> bool:
    """Returns whether the torque is a function of the motion if motor and link change places: with
    both measured after the gear, their motions do not show which is which."""
    if not {"theta", "q"} <= view.configuration.ports.keys():
        return False
    return 1 - explained(_in_motion(view.exchanged(), fit.form)) < _UNEXPLAINED


def _in_motion(view: LogView, form: Form) -> Equations:
    """Returns the equations without the times at rest; all of them if hardly any would be left."""
    parts = [part for piece in view.pieces for part in _moving(piece, view.T, form)]
    independent = 2 * form.f_0 * view.T * sum(len(part.theta) for part in parts)
    if parts:
        moving = with_all_corrections(replace(view, pieces=parts), form)
        if independent >= _PER_COEFFICIENT * len(moving.names):
            return moving
    return with_all_corrections(view, form)


def _moving(piece: Signals, T: float, form: Form) -> Iterator[Signals]:
    """Yields the parts of a stretch between rests: not every reversal is one."""
    velocity = np.gradient(low_pass(piece.theta, form.wide, T), T)
    is_slow = np.abs(velocity) < COULOMB_VELOCITY
    is_moving = np.ones(len(is_slow), np.bool_)
    for first, last in zip(*stretches(is_slow), strict=True):
        is_moving[first:last] = last - first < EDGE / T
    for first, last in zip(*stretches(is_moving), strict=True):
        if last - first >= shortest(T, blocks=1):
            yield piece[first:last]


def _is_changing(view: LogView, f_0: float) -> bool:
    """Returns whether the spring changes in the log, with enough motion before and after.

    f_0  low pass of the equations [Hz], which leaves 2 f_0 independent samples in a second
    """
    plain = plain_equations(view.pieces, view.T, view.gamma, f_0)
    change = change_of_spring(plain, view.pieces)
    if change is None:
        return False
    shorter = min(change, int(plain.rows.sum()) - change)
    return 2 * f_0 * view.T * shorter > _INDEPENDENT
