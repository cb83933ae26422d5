"""Computes how much of the torque the motor equation explains, whatever a configuration has wrong.

The misfit of the estimator is relative to the configured noise, which `identify` has yet to find.
"""

import math

from sigmahat.motor.equation import explained, residual
from sigmahat.motor.hypotheses.hypothesis import Evidence, Hypothesis
from sigmahat.motor.log_view import LogView
from sigmahat.motor.noise import variance
from sigmahat.motor.quick_fit import QuickFit, with_all_corrections
from sigmahat.motor.spring import change_of_spring, plain_equations

_UNEXPLAINED = 0.02
"""Largest share of the variance of the torque that a joint with usual unmodelled effects leaves. Of
sixty such logs, none left more than 0.008, also with wrong configurations. Of six logs of an
industrial robot, five left 0.024 to 0.084."""

_INDEPENDENT = 20  # least number of independent samples of each of two springs of four powers


def misfit(view: LogView, fit: QuickFit) -> Evidence | None:
    """Finds a torque that no key makes a function of the motion; None if the torque is one.

    A wrong sign, gear ratio, zero or inertia only changes coefficients of the motor equation, which
    are all free here. A spring that changes during the log is no misfit: the estimator finds it.

    Returns the torque that is left, divided by the torque without its mean, both RMS [1].
    """
    system = with_all_corrections(view, fit.form)
    share = 1 - explained(system)
    noise = max(variance(piece.tau) for piece in view.pieces)
    if share < _UNEXPLAINED or residual(system) < noise * int(system.rows.sum()):
        return None
    if _is_changing(view, fit.form.f_0):
        return None
    port = "tau_e_sensor" if view.has_sensor else "tau"
    return Evidence(math.sqrt(share), [Hypothesis(f"ports.{port}.column", None)])


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
