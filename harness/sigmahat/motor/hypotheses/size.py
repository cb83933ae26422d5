"""Compares the sizes of a joint with those of any joint: torque and inertia after the gear, torque
constant, deformation.

A torque on the wrong side of a gear, or in a wrong unit, multiplies inertia, friction and stiffness
by the same factor, so no other comparison of a log can show it.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from enum import Enum

import numpy as np

from sigmahat.motor.hypotheses.hypothesis import Evidence, Hypothesis
from sigmahat.motor.hypotheses.positions import Positions
from sigmahat.motor.log_view import LogView
from sigmahat.motor.write import LEAST_PRIOR_OF_B
from sigmahat.recording.configuration import Port

_TORQUE = 3000.0  # largest torque after the gear of a usual robot [N.m]
_HUGE = 5.0  # ratio to _TORQUE beyond which no robot has the torque
_INERTIA = 50.0  # largest inertia of the motor of a usual robot, seen at the link [kg.m2]
_CONSTANT = 10.0  # largest torque constant of a motor before a gear [N.m/A]
_GEARED = 5.0  # least ratio of a gear behind which a motor is small
_DEFORMATION = 1.5  # to either side [rad]
_MILLI = 1e-3


class Size(Enum):
    """What is compared with the largest one of a usual robot."""

    TORQUE = "torque after the gear"
    INERTIA = "inertia of the motor at the link"
    CONSTANT = "torque constant"
    DEFORMATION = "deformation"


@dataclass(frozen=True)
class Implausible(Evidence):
    """A size that is implausible, and what would make it smaller."""

    size: Size
    unit: str
    usual: float  # the largest plausible size, in `unit`
    is_certain: bool  # whether no robot has the size


def implausible_sizes(positions: Positions) -> Iterator[Implausible]:
    """Yields sizes beyond those of usual robots, at most one by the torque."""
    view = positions.view
    of_torque = _constant(view)
    if of_torque is None and not _is_confirmed(view):
        of_torque = _torque(view) or _inertia(positions)
    if of_torque is not None:
        yield of_torque
    of_deformation = _deformation(view)
    if of_deformation is not None:
        yield of_deformation


def _is_confirmed(view: LogView) -> bool:
    """Returns whether an inertia of a data sheet shows the size of the motor, which is compared
    with the log anyway. The prior that identify writes is never that small."""
    is_given = "motor.B" in view.configuration.parameters and not view.has_sensor
    return is_given and float(view.parameters["prior.B"]) < LEAST_PRIOR_OF_B


def _constant(view: LogView) -> Implausible | None:
    tau = view.configuration.ports.get("tau")
    if tau is None or tau.torque_constant is None or abs(view.gamma) < _GEARED:
        return None
    constant = abs(tau.torque_constant / tau.gear_ratio)
    if constant <= _CONSTANT:
        return None
    hypotheses = [_smaller_constant(tau.torque_constant)]
    if abs(tau.gear_ratio) == 1:
        hypotheses.append(Hypothesis("ports.tau.gear_ratio", abs(view.gamma)))
    return Implausible(constant, hypotheses, Size.CONSTANT, "N.m/A", _CONSTANT, is_certain=True)


def _torque(view: LogView) -> Implausible | None:
    torque = max((float(np.max(np.abs(piece.tau))) for piece in view.pieces), default=0.0)
    torque *= abs(view.gamma)
    if torque <= _TORQUE:
        return None
    certain = torque > _HUGE * _TORQUE
    hypotheses = _smaller_torque(view)
    return Implausible(torque, hypotheses, Size.TORQUE, "N.m", _TORQUE, is_certain=certain)


def _inertia(positions: Positions) -> Implausible | None:
    view, fit = positions.view, positions.fit
    if view.has_sensor or fit is None:
        return None
    B, half_width = fit.fit.value.get("B", 0.0), fit.fit.half_width.get("B", np.inf)
    least = view.gamma**2 * (B - half_width)
    if not least > _INERTIA:
        return None
    hypotheses = _smaller_torque(view)
    return Implausible(
        view.gamma**2 * B, hypotheses, Size.INERTIA, "kg.m2", _INERTIA, is_certain=False
    )


def _deformation(view: LogView) -> Implausible | None:
    if not {"theta", "q"} <= set(view.samples.names) or not view.pieces:
        return None
    largest = max(float(np.max(np.abs(piece.phi))) for piece in view.pieces)
    if largest <= _DEFORMATION:
        return None
    names = ["phi"] if "phi" in view.configuration.ports else ["q", "theta"]
    hypotheses = [Hypothesis(f"ports.{name}.unit", None) for name in names]
    # A wrong zero only moves the deformation.
    range_ = max(float(np.ptp(piece.phi)) for piece in view.pieces)
    is_certain = range_ > 2 * _DEFORMATION
    if not is_certain:
        hypotheses.append(Hypothesis(f"ports.{names[0]}.zero", None))
    return Implausible(largest, hypotheses, Size.DEFORMATION, "rad", _DEFORMATION, is_certain)


def _smaller_torque(view: LogView) -> list[Hypothesis]:
    """Returns the likely reasons for a torque that is too large, the most likely first."""
    name = "tau_e_sensor" if view.has_sensor else "tau"
    port = view.configuration.ports[name]
    hypotheses = []
    if name == "tau" and abs(port.gear_ratio) == 1 and abs(view.gamma) > 1:
        hypotheses.append(Hypothesis("ports.tau.gear_ratio", abs(view.gamma), "tau"))
    hypotheses.append(_smaller_unit(name, port))
    return hypotheses


def _smaller_unit(name: str, port: Port) -> Hypothesis:
    if port.torque_constant is not None:
        return _smaller_constant(port.torque_constant)
    if port.scale is not None:
        return Hypothesis(f"ports.{name}.scale", None)
    unit = "mN.m" if port.unit in (None, "N.m") else None
    return Hypothesis(f"ports.{name}.unit", unit)


def _smaller_constant(constant: float) -> Hypothesis:
    """A data sheet may give the constant in mN.m/A."""
    return Hypothesis("ports.tau.torque_constant", float(f"{_MILLI * constant:.9g}"))
