"""Writes a joint as a model for robot simulators: MJCF, SDF, URDF, and SDF for Drake.

The joint is two hinges with one axis. The first hinge is the motor at its gear output. The second
hinge is the flexibility, with the deformation phi as its angle, and -tau_e as the torque of its
spring.

Numbers are written with all digits. Comments have the 95 % intervals of the numbers. If the format
allows, the interval is also a range for domain randomization. The formats are templates in
``templates/``.
"""

import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.polynomial import Polynomial

from sigmahat.files.output import write_whole
from sigmahat.files.templates import xml
from sigmahat.result.sheet import Parameter, Sheet, origin
from sigmahat.result.stored import Range

_ROTOR = 1e-6  # least inertia of a link, used for a rotor with a separate inertia [kg.m2]
_EXACT = 1e-3  # least error of a polynomial that is reported, relative to the largest torque
_TEMPLATES = Path(__file__).with_name("templates")
_MISSING = {
    "mjcf": [],
    "sdf": ["SDF has no rotor inertia: the link `rotor` has this inertia, at the gear output."],
    "urdf": [
        "URDF has no spring: the element `gazebo` contains it, and only Gazebo reads it. "
        "URDF has no rotor inertia: the link `rotor` has this inertia, at the gear output."
    ],
    "drake": ["Drake has no Coulomb friction in a joint: Drake ignores the element `friction`."],
}


@dataclass(frozen=True)
class Spring:
    """Torque of the spring: sum of stiffness[i] (phi - reference)^(i + 1)."""

    reference: float  # deformation without torque [rad]
    stiffness: tuple[float, ...]  # [N.m/rad], [N.m/rad2] and so on
    error: float  # largest error of this torque divided by the largest torque in the data [1]


def _parameters(sheet: Sheet) -> dict[str, Parameter]:
    """Returns parameters at the gear output, with intervals, by hinge and parameter."""
    p, gamma = sheet.parameters, sheet.parameters["gamma"].value
    return {
        "motor.armature": _scaled(p["B"], gamma**2, "kg.m2"),
        "motor.damping": _scaled(p["D_theta"], gamma**2, "N.m.s/rad"),
        "motor.frictionloss": _scaled(p.get("tau_coulomb"), abs(gamma), "N.m"),
        "flexibility.damping": _scaled(p.get("damping"), 1.0, "N.m.s/rad"),
        "flexibility.stiffness.factor": _factor(sheet),
    }


def _scaled(parameter: Parameter | None, factor: float, unit: str) -> Parameter:
    """Scales a motor parameter to the gear output; value and interval are not below 0."""
    if parameter is None:
        return Parameter(0.0, unit, None, "absent")
    value, interval = max(factor * parameter.value, 0.0), None
    if parameter.interval is not None:
        low, high = parameter.interval
        interval = max(factor * low, 0.0), max(factor * high, 0.0)
    return Parameter(value, unit, interval, parameter.interval_from)


def _factor(sheet: Sheet) -> Parameter:
    """Computes the interval of a factor of the stiffness, from the relative interval in the data.

    The torque is the integral of the stiffness, and has at most the same relative error.
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
    """Fits a polynomial of the given degree to the curve of the sheet, in the range of the data."""
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
    stiffness = np.trim_zeros(shifted[1:], "b").tolist() or [0.0]
    if not stiffness[0] > 0:
        raise ValueError(
            f"the stiffness of the unloaded spring is {stiffness[0]:.4g} N.m/rad: expected a value "
            "above 0; see `sigmahat check`"
        )
    error = float(np.max(np.abs(fitted(phi) - torque)) / max(np.max(np.abs(torque)), 1e-300))
    return Spring(reference, tuple(stiffness), error)


def _zero(torque: Polynomial, phi: np.ndarray[tuple[int], np.dtype[np.float64]]) -> float:
    """Finds the deformation without torque that is nearest to the middle of the data [rad]."""
    if not torque.coef[0]:
        return 0.0
    roots = torque.roots()
    real = roots[np.abs(roots.imag) <= 1e-9 * np.abs(roots)].real
    if not len(real):
        raise ValueError("expected a deformation at which the spring has no torque, found none")
    return float(real[np.argmin(np.abs(real - (phi[0] + phi[-1]) / 2))])


def write_model(sheet: Sheet, kind: str, path: Path) -> None:
    """Writes the joint of a sheet as a model: mjcf, sdf, urdf or drake.

    The curve at the last set-point of the log is the spring.

    Raises ValueError for a sheet without data or without a stiffness above 0.
    """
    reach = sheet.polynomial.phi
    if reach is None:
        raise ValueError("no deformation in the data sheet: expected data of a joint that moved")
    name = re.sub(r"[^\w-]", "_", path.name.partition(".")[0], flags=re.ASCII)
    parameters = _parameters(sheet)
    spring = _spring(sheet, reach, degree=3 if kind == "mjcf" else 1)
    comments = [f"{name}_motor: the motor at its gear output; {name}_flexibility: the deformation."]
    for key, each in parameters.items():
        ends = each.interval
        claim = f"95 % from {ends[0]:.6g} to {ends[1]:.6g}" if ends else "no interval"
        about = f"{each.value:.6g} {each.unit}, {claim} ({each.interval_from})"
        comments.append(f"{name}_{key} = {about}")
    comments += [*_limits(sheet, spring, reach), *_MISSING[kind], *origin(sheet)]
    text = xml(
        _TEMPLATES / f"{'sdf' if kind == 'drake' else kind}.xml",
        comments,
        name=name,
        parameters=parameters,
        gear_ratio=sheet.parameters["gamma"].value,
        rotor_inertia=max(sheet.parameters["B"].value, 0.0),
        spring=spring,
        rotor=_ROTOR,
        inertia=max(parameters["motor.armature"].value, _ROTOR),
        drake=kind == "drake",
    )
    write_whole(text, path)


_SHOWN = 0.01  # fraction of the largest torque: a smaller effect is not listed


def _limits(sheet: Sheet, spring: Spring, reach: Range) -> Iterator[str]:
    """Yields lines about effects of the joint that the model does not contain."""
    low, high = reach
    yield f"The deformation was {low:.4g} to {high:.4g} rad; beyond this, it is extrapolated."
    if spring.error > _EXACT:
        yield f"The spring of this model differs from the data by up to {100 * spring.error:.2g} %."
    p, setting, absent = sheet.parameters, sheet.at_the_end.set_point, []
    torque = float(np.max(np.abs(sheet.polynomial.at(np.array(reach), setting)[0])))
    shown = {"hysteresis": _SHOWN * torque, "load_friction": _SHOWN, "delay": 0.0}
    for name, smallest in shown.items():
        if name in p and abs(p[name].value) > smallest:
            unit = "" if p[name].unit == "1" else f" {p[name].unit}"
            absent.append(f"{name.replace('_', ' ')} {p[name].value:.3g}{unit}")
    if sheet.polynomial.is_of_set_point:
        absent.append(
            f"how the stiffness is adjusted (this is the spring at set-point {setting:.6g})"
        )
    if absent:
        yield f"Not in this model: {', '.join(absent)}."
