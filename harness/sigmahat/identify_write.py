"""Writes what was identified into a configuration and keeps its comments."""

from __future__ import annotations

import math
import os
from collections.abc import MutableMapping
from pathlib import Path
from typing import Any

import tomlkit

from sigmahat.identification import UNITS, Identified
from sigmahat.logs.configuration import parse

_ABOVE = 1.4
"""A filter somewhat above the balance of the noises costs nothing and follows faster."""


def write(found: Identified, path: Path, known: frozenset[str]) -> list[str]:
    """Puts what the log tells into [parameters] and [ports.tau], all of it into [identified].

    known   variables of the FMU; what it has no parameter for stays in [identified]

    Returns the keys that were written. The file is replaced at once, or left as it was.
    """
    document = parse(path)
    values: dict[str, Any] = {
        "filter.V_a": found.V_a,
        "rls.n": found.n,
        "rls.m": found.m,
        "noise.tau": math.sqrt(found.tau_variance),
        "matched.bandwidth": _ABOVE * found.bandwidth,
    }
    for name, q in found.quantities.items():
        if q.told:
            key = "prior.tau_coulomb" if name == "tau_coulomb" else f"motor.{name}"
            values[key] = abs(q.value)
    values = {name: _short(value) for name, value in values.items() if name in known}
    parameters = document.setdefault("parameters", tomlkit.table())
    for name, value in values.items():
        _set(parameters, name, value)
    written = [f"parameters.{name}" for name in values]
    constant = found.quantities.get("torque_constant")
    if constant is not None and constant.told:
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
    """Sets motor.B where it stands, as motor.B, "motor.B" or B in [parameters.motor]."""
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
        if q.told:
            row["value"] = _short(q.value)
        else:
            row["value"] = "cannot tell"
        row["half_width"] = float(f"{q.half_width:.3g}")
        row["unit"] = UNITS[name]
        table[name] = row
    table["tau_noise"] = float(f"{found.tau_variance**0.5:.3g}")
    table["tau_noise"].comment("standard deviation [N.m]")
    table["theta_noise"] = float(f"{found.theta_variance**0.5:.3g}")
    table["theta_noise"].comment("standard deviation, rounding included [rad]")
    table["bandwidth"] = float(f"{found.bandwidth:.4g}")
    table["bandwidth"].comment("of a filter that balances both [rad/s]")
    return table
