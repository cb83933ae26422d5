"""Writes the result of an identification into a configuration, whose comments are kept."""

from __future__ import annotations

import math
from collections.abc import Mapping, MutableMapping
from pathlib import Path
from typing import Any

import tomlkit

from sigmahat.files import toml_file
from sigmahat.files.output import write_whole
from sigmahat.fmi.opened import installed
from sigmahat.identification.quantities import WIDE, Identified, Quantity
from sigmahat.identification.regression import MOTOR
from sigmahat.logs.configuration import (
    ANOTHER_ROBOT,
    ANY_COULOMB,
    CHOSEN,
    NOT_YOURS,
    WIDE_PRIOR,
    Port,
    read_document,
)
from sigmahat.logs.units import factor

_ABOVE = 1.4
"""regression.bandwidth over the balance of the noises: it costs no accuracy, and follows faster."""
_ROOM = 1.2
"""Ranges over the largest values of the log: another motion may go further."""
_MIDDLE = "not known: the middle of what identify holds possible"
_NOT_KNOWN = (WIDE_PRIOR, NOT_YOURS, _MIDDLE, CHOSEN)
"""Comments of values that the next log may tell."""


def write(found: Identified, path: Path) -> list[str]:
    """Writes what is determined into [parameters] and [ports.tau], everything into [identified].

    What is not determined gets a wide prior, unless the file has one above 0. If nobody has set its
    value either, a comment says so: no value of another robot stays unnoticed.

    Returns the keys that were written. The file is replaced at once, or not changed.
    """
    document = _without_what_is_not_known(read_document(path))
    values: dict[str, Any] = {
        "filter.V_a": found.V_a,
        "rls.symmetric": found.symmetric,
        "rls.n": found.n,
        "rls.m": found.m,
        "noise.tau": math.sqrt(found.tau_variance),
        "regression.bandwidth": _ABOVE * found.bandwidth,
        "range.phi": _ROOM * found.phi,
        "range.setPoint": _ROOM * found.set_point,
        "prior.tau_e": _ROOM * found.torque,
    }
    for name, q in found.quantities.items():
        if q.determined and name in MOTOR:
            if name == "tau_coulomb":
                values["prior.tau_coulomb"] = max(abs(q.value), q.half_width)
            else:
                values[f"motor.{name}"] = q.value
            if name == "B":  # but not for D_theta, which changes with the temperature
                values["prior.B"] = q.half_width / q.value
    values = {name: _short(value) for name, value in values.items() if value is False or value != 0}
    parameters = document.setdefault("parameters", tomlkit.table())
    given = dict(toml_file.dotted(parameters.unwrap()))
    unknown = {name: each for name, each in _unknown(found).items() if name not in given}
    comments = {name: comment for name, (_, comment) in unknown.items()}
    priors = {name: _short(value) for name, value in _wide_priors(found, comments).items()}
    wide = {name: value for name, value in priors.items() if not given.get(name)}
    for name, value in values.items():
        item = tomlkit.item(value)
        if name == "rls.symmetric" and value and not given.get(name):
            item.comment(CHOSEN)
        toml_file.set_dotted(parameters, name, item)
    for name, (value, comment) in unknown.items():
        toml_file.set_dotted(parameters, name, tomlkit.item(_short(value)).comment(comment))
    for name, value in wide.items():
        item = tomlkit.item(value)
        toml_file.set_dotted(parameters, name, item if name in given else item.comment(WIDE_PRIOR))
    written = [f"parameters.{name}" for name in (*values, *unknown, *wide)]
    constant = found.quantities.get("torque_constant")
    if constant is not None and constant.determined:
        document["ports"]["tau"]["torque_constant"] = _short(constant.value)
        written.append("ports.tau.torque_constant")
    if found.zero and "q" in document["ports"]:
        _move_zero(document["ports"]["q"], found.zero)
        written.append("ports.q.zero")
    document["identified"] = _record(found)
    write_whole(tomlkit.dumps(document), path)
    return written


def _unknown(found: Identified) -> dict[str, tuple[float, str]]:
    """Values of the motor data that are not determined, with a comment, by parameter."""
    values = {}
    for name, own in (("B", found.B), ("D_theta", found.D_theta)):
        quantity = found.quantities.get(name)
        if quantity is not None and not quantity.determined:
            middle = _middle(quantity)
            comment = NOT_YOURS if middle is None else _MIDDLE
            values[f"motor.{name}"] = (own if middle is None else middle, comment)
    return values


def _middle(quantity: Quantity) -> float | None:
    """Middle of the positive part of an interval; None if there is none."""
    low, high = quantity.interval
    return 0.5 * (max(low, 0.0) + high) if math.isfinite(high) and high > 0 else None


def _wide_priors(found: Identified, comments: Mapping[str, str]) -> dict[str, float]:
    """Priors of the motor data that are not determined, by parameter.

    comments  of the parameters that nobody has set; around the middle of an interval, WIDE holds
              all of it
    """
    undetermined = {name: q for name, q in found.quantities.items() if not q.determined}
    priors = {}
    for name in ("B", "D_theta"):
        if name in undetermined:
            not_yours = comments.get(f"motor.{name}") == NOT_YOURS
            priors[f"prior.{name}"] = ANOTHER_ROBOT if not_yours else WIDE
    D_theta = undetermined.get("D_theta")
    if comments.get("motor.D_theta") == _MIDDLE:
        D_theta = None
    if D_theta is not None and math.isfinite(D_theta.half_width) and found.D_theta > 0:
        # Encoders that are read at different times look like friction, of any sign and size.
        largest = max(abs(end / found.D_theta - 1) for end in D_theta.interval)
        priors["prior.D_theta"] = max(priors["prior.D_theta"], largest)
    tau_coulomb = undetermined.get("tau_coulomb")
    if tau_coulomb is not None:
        largest = max(abs(end) for end in tau_coulomb.interval)
        priors["prior.tau_coulomb"] = largest if math.isfinite(largest) else ANY_COULOMB
    return priors


def _move_zero(port: MutableMapping[str, Any], zero: float) -> None:
    """Moves the zero of [ports.q] by an angle of the link [rad]."""
    read = Port(**{key: value.unwrap() for key, value in port.items()})
    angle = read.sign * factor("q", read) / read.gear_ratio
    port["zero"] = float(f"{read.zero + zero / angle:.9g}")


def _without_what_is_not_known(document: tomlkit.TOMLDocument) -> tomlkit.TOMLDocument:
    """Without what `init` or an earlier run wrote because they could not tell: this one may be
    able to. A value that somebody has put in its place stays.
    """
    fmu = installed("StiffnessEstimator")
    start = {name: float(fmu.variable(f"motor.{name}").start) for name in ("B", "D_theta")}
    lines = tomlkit.dumps(document).splitlines(keepends=True)
    kept = [line for line in lines if not _is_not_known(line.rstrip(), start)]
    return tomlkit.parse("".join(kept))


def _is_not_known(line: str, start: Mapping[str, float]) -> bool:
    """Whether a line has a value that nobody knows.

    start  start values of the FMU, of motor.B and so on
    """
    if not line.endswith(_NOT_KNOWN):
        return False
    ((key, value),) = toml_file.dotted(tomlkit.parse(line).unwrap())
    name = key.rpartition(".")[2]  # the line may be in a table [parameters.prior]
    if line.endswith(NOT_YOURS):
        return bool(value == start.get(name, value))
    if line.endswith(WIDE_PRIOR):
        # Of the Coulomb friction it is the end of an interval, which looks like any other value.
        return bool(name == "tau_coulomb" or value >= WIDE)
    return True


def _short(value: float) -> float:
    return value if isinstance(value, int) else float(f"{value:.6g}")


def _record(found: Identified) -> tomlkit.items.Table:
    table = tomlkit.table()
    table.comment("by sigmahat identify: values with 95 % intervals, for you to read")
    for name, q in found.quantities.items():
        row = tomlkit.inline_table()
        if q.determined:
            row["value"] = _short(q.value)
        else:
            row["value"] = "cannot tell"
        row["half_width"] = float(f"{q.half_width:.3g}")
        row["unit"] = q.unit
        table[name] = row
    table["tau_noise"] = float(f"{found.tau_variance**0.5:.3g}")
    table["tau_noise"].comment("standard deviation [N.m]")
    table["theta_noise"] = float(f"{found.theta_variance**0.5:.3g}")
    table["theta_noise"].comment("standard deviation, rounding included [rad]")
    table["bandwidth"] = float(f"{found.bandwidth:.4g}")
    table["bandwidth"].comment("of a filter that balances both [rad/s]")
    return table
