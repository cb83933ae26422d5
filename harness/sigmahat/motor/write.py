"""Writes the result of an identification into a configuration, and keeps the comments."""

import math
from collections.abc import Mapping
from copy import copy
from typing import Any

import tomlkit
from tomlkit.items import Item

from sigmahat.files import toml_file
from sigmahat.fmi.model import installed_model
from sigmahat.motor.equation import MOTOR
from sigmahat.motor.quantities import ACCEPTED, WIDE, Identified
from sigmahat.recording import several_joints
from sigmahat.recording.configuration import (
    ANOTHER_ROBOT,
    ANY_COULOMB,
    NOT_YOURS,
    WIDE_PRIOR,
    Port,
    with_units,
)
from sigmahat.recording.units import scale

_ABOVE = 1.4
"""Ratio of regression.bandwidth to the identified bandwidth: a higher one costs no accuracy."""
_ROOM = 1.2  # ratio of a range to the largest value in the log, because motions differ
_KNEES = ("range.knee", "range.knee_2")
_OF_SET_POINT = ("rls.m", "range.setPoint", "range.setPoint_center")
LEAST_PRIOR_OF_B = 0.15
"""Least relative prior of B: RMS error of B on joints with unmodelled friction or springs. On such
joints the error of B is up to five times the interval, which includes only random errors."""
_MIDDLE = "not known: the middle of what identify holds possible"
_NOT_KNOWN = (WIDE_PRIOR, NOT_YOURS, _MIDDLE)
"""Comments of values that the next log may determine."""


def update(document: tomlkit.TOMLDocument, identified: Identified, joint: str = "") -> list[str]:
    """Writes determined values into [parameters] and [ports.tau], and all values into [identified],
    for one joint of the document.

    Undetermined values get a wide prior, unless the file has a prior above 0. A comment marks
    undetermined values that the user has not set, because the value may be of another robot.

    Returns the keys that were set.
    """
    _remove_what_is_not_known(document, joint)
    section = several_joints.section(document, joint)
    whole = several_joints.of_joint(document, joint)
    given = dict(toml_file.dotted(whole.get("parameters", tomlkit.table()).unwrap()))
    bandwidth = identified.bandwidth
    values: dict[str, Any] = {
        "filter.V_a": identified.V_a,
        "rls.symmetric": identified.symmetric,
        "rls.n": identified.n,
        "rls.m": identified.m,
        _noise_key(identified): math.sqrt(identified.tau_variance),
        "regression.bandwidth": None if bandwidth is None else _ABOVE * bandwidth,
        "range.phi": _ROOM * identified.phi,
        "range.setPoint": _ROOM * identified.set_point,
        "range.setPoint_center": identified.set_point_center,
        "prior.tau_e": _ROOM * identified.torque,
    }
    for name, knee in zip(_KNEES, identified.knees, strict=False):
        values[name] = knee / values["range.phi"]
    for name, q in identified.quantities.items():
        if q.determined and name in MOTOR:
            if name == "tau_coulomb":
                values["prior.tau_coulomb"] = max(abs(q.value), q.half_width)
            else:
                values[f"motor.{name}"] = q.value
            if name == "B":  # D_theta gets no prior, because friction changes with temperature
                values["prior.B"] = max(q.half_width / q.value, LEAST_PRIOR_OF_B)
    # The log may be one of several, each at another set-point.
    kept = _OF_SET_POINT if given.get("rls.m") and not identified.set_point_moves else ()
    values = {
        name: value
        for name, value in values.items()
        if value is not None and name not in kept and (value is False or value != 0)
    }
    parameters = section.setdefault("parameters", tomlkit.table())
    unknown = {n: value for n, value in _unknown(identified).items() if n not in given}
    comments = {name: comment for name, (_, comment) in unknown.items()}
    wide = {n: std for n, std in _wide_priors(identified, unknown).items() if not given.get(n)}
    comments |= {name: WIDE_PRIOR for name in wide if name not in given}
    values |= {name: value for name, (value, _) in unknown.items()} | wide
    for name, value in values.items():
        item = tomlkit.item(_short(value))
        if name in comments:
            item.comment(comments[name])
        toml_file.set_dotted(parameters, name, item)
    written = [f"parameters.{name}" for name in values]
    constant = identified.quantities.get("torque_constant")
    if constant is not None and constant.determined:
        item = tomlkit.item(_short(constant.value))
        several_joints.set_item(section, ("ports", "tau", "torque_constant"), item)
        written.append("ports.tau.torque_constant")
    name = "phi" if "phi" in whole["ports"] else "q"
    if identified.zero and name in whole["ports"]:
        port = Port(**with_units(whole["ports"].unwrap())[name])
        zero = tomlkit.item(float(f"{port.zero + identified.zero / scale(name, port):.9g}"))
        several_joints.set_item(section, ("ports", name, "zero"), zero)
        written.append(f"ports.{name}.zero")
    section["identified"] = _record(identified)
    return written


def _noise_key(identified: Identified) -> str:
    return "noise.tau_e" if identified.has_sensor else "noise.tau"


def _unknown(identified: Identified) -> dict[str, tuple[float, str]]:
    """Chooses values for undetermined motor data, with a comment, by parameter: the middle of the
    positive part of the interval, if any."""
    values = {}
    for name, given in (("B", identified.B), ("D_theta", identified.D_theta)):
        quantity = identified.quantities.get(name)
        if quantity is not None and not quantity.determined:
            low, high = quantity.fitted
            is_held = math.isfinite(high) and high > 0
            value = 0.5 * (max(low, 0.0) + high) if is_held else given
            values[f"motor.{name}"] = (value, _MIDDLE if is_held else NOT_YOURS)
    return values


def _wide_priors(
    identified: Identified, unknown: Mapping[str, tuple[float, str]]
) -> dict[str, float]:
    """Chooses priors of the motor data that are not determined, by parameter.

    unknown  values of parameters that the user has not set, with their comments. A prior WIDE
             around the middle of the interval of the fits contains this interval; where the
             interval that the user reads reaches further, the prior lets the estimator accept it
    """
    undetermined = {name: q for name, q in identified.quantities.items() if not q.determined}
    priors = {}
    for name in ("B", "D_theta"):
        if name not in undetermined:
            continue
        value, comment = unknown.get(f"motor.{name}", (0.0, ""))
        priors[f"prior.{name}"] = ANOTHER_ROBOT if comment == NOT_YOURS else WIDE
        if comment == _MIDDLE:
            furthest = undetermined[name].interval[1] / value - 1
            priors[f"prior.{name}"] = max(WIDE, furthest / ACCEPTED)
    D_theta = undetermined.get("D_theta")
    if unknown.get("motor.D_theta", (0.0, ""))[1] == _MIDDLE:
        D_theta = None
    if D_theta is not None and math.isfinite(D_theta.half_width) and identified.D_theta > 0:
        # Encoders that are read at different times look like positive or negative friction.
        largest = max(abs(end / identified.D_theta - 1) for end in D_theta.fitted)
        priors["prior.D_theta"] = max(priors["prior.D_theta"], largest)
    tau_coulomb = undetermined.get("tau_coulomb")
    if tau_coulomb is not None:
        largest = max(abs(end) for end in tau_coulomb.fitted)
        priors["prior.tau_coulomb"] = largest if math.isfinite(largest) else ANY_COULOMB
    return priors


def _remove_what_is_not_known(document: tomlkit.TOMLDocument, joint: str) -> None:
    """Removes placeholders of `init` or of an earlier run for unknown values, because this run may
    determine the values. Values set by the user are kept.
    """
    model = installed_model("StiffnessEstimator")
    start = {name: float(model.variable(name).start) for name in ("motor.B", "motor.D_theta")}
    if joint:
        _give_to_the_joints(document, start)
    for place, item in several_joints.items(document, joint).items():
        if _is_not_known(place[-1], item, start):
            several_joints.remove(several_joints.section(document, joint), place)


def _give_to_the_joints(document: tomlkit.TOMLDocument, start: Mapping[str, float]) -> None:
    """Moves common placeholders into the section of each joint, because joints may differ soon."""
    names = several_joints.names(document)
    for place, item in several_joints.items(document).items():
        if place[0] != several_joints.JOINTS and _is_not_known(place[-1], item, start):
            several_joints.remove(document, place)
            for name in names:
                if place not in several_joints.items(document, name):
                    several_joints.set_item(
                        several_joints.section(document, name), place, copy(item)
                    )


def _is_not_known(name: str, item: Item, start: Mapping[str, float]) -> bool:
    """Returns whether a parameter is still a placeholder; start: start values of the FMU."""
    comment, value = item.trivia.comment.rstrip(), item.unwrap()
    if not comment.endswith(_NOT_KNOWN):
        return False
    if comment.endswith(NOT_YOURS):
        return bool(value == start.get(name, value))
    if comment.endswith(WIDE_PRIOR):
        # A wide prior of the Coulomb friction may have any value: the end of an interval.
        return bool(name == "prior.tau_coulomb" or value >= WIDE)
    return True


def _short(value: float) -> float:
    return value if isinstance(value, int) else float(f"{value:.6g}")


def _record(identified: Identified) -> tomlkit.items.Table:
    table = tomlkit.table()
    table.comment("by sigmahat identify: values with 95 % intervals, for you to read")
    for name, q in identified.quantities.items():
        row = tomlkit.inline_table()
        row["value"] = _short(q.value) if q.determined else "cannot tell"
        row["half_width"] = float(f"{q.half_width:.3g}")
        row["unit"] = q.unit
        table[name] = row
    table["tau_noise"] = float(f"{identified.tau_variance**0.5:.3g}")
    table["tau_noise"].comment("standard deviation [N.m]")
    table["theta_noise"] = float(f"{identified.theta_variance**0.5:.3g}")
    table["theta_noise"].comment("standard deviation, rounding included [rad]")
    if identified.bandwidth is not None:
        table["bandwidth"] = float(f"{identified.bandwidth:.4g}")
        table["bandwidth"].comment("of a filter that balances both [rad/s]")
    table.add(tomlkit.nl())
    return table
