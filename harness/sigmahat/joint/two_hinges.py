"""The joint of a data sheet for a simulator: two hinges with one axis.

The first hinge is the motor at its gear output. The second hinge is the flexibility, with the
deformation phi as its angle, and -tau_e as the torque of its spring.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.polynomial import Polynomial

from sigmahat.joint.sheet import Parameter, Sheet
from sigmahat.joint.stored import Range


@dataclass(frozen=True)
class Spring:
    """Torque of the spring: sum of stiffness[i] (phi - reference)^(i + 1)."""

    reference: float  # deformation without torque [rad]
    stiffness: tuple[float, ...]  # [N.m/rad], [N.m/rad2] and so on
    error: float  # largest error of this torque over the largest torque in the data [1]


@dataclass(frozen=True)
class TwoHinges:
    """Data of a joint for a simulator; parameters at the gear output."""

    gear_ratio: float
    rotor_inertia: float  # inertia of the motor on its own axis [kg.m2]
    armature: Parameter  # inertia of the motor
    damping: Parameter  # viscous friction of the motor
    frictionloss: Parameter  # Coulomb friction of the motor
    spring: Spring
    spring_damping: Parameter
    reach: Range  # range of the measured deformation [rad]
    factor: Parameter  # of the whole stiffness: 1, with the relative interval
    absent: tuple[str, ...]  # effects of the joint that two hinges do not have, in words

    def parameters(self, name: str) -> Iterator[tuple[str, Parameter]]:
        """Parameters that may have an interval, by the name of hinge and parameter."""
        yield f"{name}_motor.armature", self.armature
        yield f"{name}_motor.damping", self.damping
        yield f"{name}_motor.frictionloss", self.frictionloss
        yield f"{name}_flexibility.damping", self.spring_damping
        yield f"{name}_flexibility.stiffness.factor", self.factor


def two_hinges(sheet: Sheet, degree: int) -> TwoHinges:
    """The hinges of a joint, whose spring is a polynomial of at most this degree.

    The curve at the last set-point of the log is the spring.

    Raises ValueError for a sheet without data or without a stiffness above 0.
    """
    p, reach = sheet.parameters, sheet.polynomial.phi
    if reach is None:
        raise ValueError("no deformation in the sheet: expected the sheet of a joint that moved")
    gamma = p["gamma"].value
    return TwoHinges(
        gear_ratio=gamma,
        rotor_inertia=max(p["B"].value, 0.0),
        armature=_scaled(p["B"], gamma**2, "kg.m2"),
        damping=_scaled(p["D_theta"], gamma**2, "N.m.s/rad"),
        frictionloss=_scaled(p.get("tau_coulomb"), abs(gamma), "N.m"),
        spring=_spring(sheet, reach, degree),
        spring_damping=_scaled(p.get("damping"), 1.0, "N.m.s/rad"),
        reach=reach,
        factor=_factor(sheet),
        absent=tuple(_absent(sheet, reach)),
    )


def _scaled(parameter: Parameter | None, factor: float, unit: str) -> Parameter:
    """A parameter of the motor at the gear output; value and interval are not below 0.

    The value is from the estimator, the interval may be from `identify`: an interval that does not
    contain the value is made wider.
    """
    if parameter is None:
        return Parameter(0.0, unit, None, "absent")
    value, interval = max(factor * parameter.value, 0.0), None
    if parameter.interval is not None:
        low, high = (max(factor * end, 0.0) for end in parameter.interval)
        interval = min(low, value), max(high, value)
    return Parameter(value, unit, interval, parameter.interval_from)


def _factor(sheet: Sheet) -> Parameter:
    """Factor 1 with half the mean interval of the stiffness divided by the mean stiffness.

    The torque, which is the integral of the stiffness, has at most this error.
    """
    setting = sheet.at_the_end.set_point
    near = min((abs(each.set_point - setting) for each in sheet.curve or ()), default=0.0)
    curve = [c for c in sheet.curve or () if abs(c.set_point - setting) <= near and c.interval]
    if not curve:
        return Parameter(1.0, "1", None, f"{sheet.method} claims none")
    width = sum(c.interval[1] - c.interval[0] for c in curve if c.interval)
    half = width / 2 / sum(abs(c.sigma) for c in curve)
    return Parameter(1.0, "1", (max(1 - half, 0.0), 1 + half), "estimate")


_POINTS = 201


def _spring(sheet: Sheet, reach: Range, degree: int) -> Spring:
    """The polynomial of this degree that is nearest to the curve of the sheet in its range."""
    source = sheet.polynomial
    phi = np.linspace(*reach, _POINTS)
    torque, _ = source.at(phi, sheet.at_the_end.set_point)
    powers = [power for power in source.powers_of_phi if power <= degree]
    size = float(np.max(np.abs(phi)))
    X = (phi[:, None] / size) ** np.array(powers)
    scaled = np.linalg.lstsq(X, torque, rcond=None)[0]
    coefficients = np.zeros(degree + 1)
    coefficients[powers] = scaled / size ** np.array(powers)
    fitted = Polynomial(coefficients)
    reference = _zero(fitted, phi)
    shifted = fitted(Polynomial([reference, 1.0])).coef
    stiffness = [float(each) for each in np.append(shifted, np.zeros(degree))[1 : degree + 1]]
    while len(stiffness) > 1 and not stiffness[-1]:
        del stiffness[-1]
    if not stiffness[0] > 0:
        raise ValueError(
            f"the stiffness is {stiffness[0]:.4g} N.m/rad where the spring has no torque: expected "
            "a value above 0; see `sigmahat check`"
        )
    error = float(np.max(np.abs(fitted(phi) - torque)) / max(np.max(np.abs(torque)), 1e-300))
    return Spring(reference, tuple(stiffness), error)


def _zero(torque: Polynomial, phi: np.ndarray[tuple[int], np.dtype[np.float64]]) -> float:
    """The deformation without torque that is nearest to the middle of the data [rad]."""
    if not torque.coef[0]:
        return 0.0
    roots = torque.roots()
    real = roots[np.abs(roots.imag) <= 1e-9 * np.abs(roots)].real
    if not len(real):
        raise ValueError("the torque of the spring is nowhere 0: its deformation has no reference")
    return float(real[np.argmin(np.abs(real - (phi[0] + phi[-1]) / 2))])


_SHOWN = 0.01  # fraction of the largest torque: a smaller effect is not listed


def _absent(sheet: Sheet, reach: Range) -> Iterator[str]:
    """Effects that were found in the joint, but that the model does not have."""
    p, setting = sheet.parameters, sheet.at_the_end.set_point
    torque = float(np.max(np.abs(sheet.polynomial.at(np.array(reach), setting)[0])))
    shown = {"hysteresis": _SHOWN * torque, "load_friction": _SHOWN, "delay": 0.0}
    for name, smallest in shown.items():
        if name in p and abs(p[name].value) > smallest:
            unit = "" if p[name].unit == "1" else f" {p[name].unit}"
            yield f"{name.replace('_', ' ')} {p[name].value:.3g}{unit}"
    if sheet.polynomial.is_of_set_point:
        yield f"how the stiffness is adjusted (this is the spring at set-point {setting:.6g})"
