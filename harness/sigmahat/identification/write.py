"""Writes the result of an identification into a configuration, whose comments are kept."""

from __future__ import annotations

import math
import os
from collections.abc import MutableMapping
from pathlib import Path
from typing import Any

import tomlkit

from sigmahat.identification.quantities import Identified
from sigmahat.logs.configuration import read_document

_ABOVE = 1.4
"""matched.bandwidth over the balance of the noises: it costs no accuracy, and follows faster."""
_ROOM = 1.2
"""Ranges over the largest values of the log: another motion may go further."""


def write(found: Identified, path: Path) -> list[str]:
    """Writes what is determined into [parameters] and [ports.tau], everything into [identified].

    Returns the keys that were written. The file is replaced at once, or not changed.
    """
    document = read_document(path)
    values: dict[str, Any] = {
        "filter.V_a": found.V_a,
        "rls.n": found.n,
        "rls.m": found.m,
        "noise.tau": math.sqrt(found.tau_variance),
        "matched.bandwidth": _ABOVE * found.bandwidth,
        "range.phi": _ROOM * found.phi,
        "range.setPoint": _ROOM * found.set_point,
        "prior.tau_e": _ROOM * found.torque,
    }
    for name, q in found.quantities.items():
        if q.determined:
            if name == "tau_coulomb":
                values["prior.tau_coulomb"] = max(abs(q.value), q.half_width)
            else:
                values[f"motor.{name}"] = q.value
            if name == "B":  # but not for D_theta, which changes with the temperature
                values["prior.B"] = q.half_width / q.value
    values = {name: _short(value) for name, value in values.items() if value != 0}
    parameters = document.setdefault("parameters", tomlkit.table())
    for name, value in values.items():
        _set(parameters, name, value)
    written = [f"parameters.{name}" for name in values]
    constant = found.quantities.get("torque_constant")
    if constant is not None and constant.determined:
        document["ports"]["tau"]["torque_constant"] = _short(constant.value)
        written.append("ports.tau.torque_constant")
    document["identified"] = _record(found)
    unfinished = path.with_name(f".{path.name}-{os.getpid()}")
    unfinished.write_text(tomlkit.dumps(document), encoding="utf-8")
    unfinished.replace(path)
    return written


def _short(value: float) -> float:
    return value if isinstance(value, int) else float(f"{value:.6g}")


def _set(table: MutableMapping[str, Any], name: str, value: Any) -> None:
    """Sets motor.B in the form of the file: motor.B, "motor.B", or B in [parameters.motor]."""
    group, _, last = name.partition(".")
    if name in table:
        table[name] = value
    elif group in table:
        table[group][last] = value
    else:
        table.append(tomlkit.key([group, last]), tomlkit.item(value))  # type: ignore[attr-defined]


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
