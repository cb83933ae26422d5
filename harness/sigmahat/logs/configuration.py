"""The configuration of a log: which column feeds which port, and the parameters of the estimator.

    [time]
    column = "t"            # left out: the rows are samplePeriod apart
    unit = "s"
    longest_gap = 0.05      # [s], see sampling.py

    [ports.theta]           # also q, theta_c, tau, tau_e_sensor
    column = "motor_counts"
    unit = "counts"
    counts_per_turn = 40000
    sign = -1

    [parameters]            # of the FMU, by their names there
    motor.B = 2.3e-5

TOML, because Python reads it, a person too, and tomlkit keeps the comments when identify writes.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any

import tomlkit
from tomlkit.exceptions import ParseError

from sigmahat.fmi.instance import Value
from sigmahat.logs.errors import LogError
from sigmahat.toml_names import flat
from sigmahat.unknown_name import unknown

PORTS = {"theta": "rad", "q": "rad", "theta_c": "rad", "tau": "N.m", "tau_e_sensor": "N.m"}
"""Inputs of StiffnessEstimator and their units."""

_NEEDED = {"Residual": ("theta", "q", "tau"), "Sensor": ("q", "tau_e_sensor"), "Model": ("q",)}
"""Ports that a modality cannot do without."""


@dataclass(frozen=True)
class Port:
    """Where the values of a port come from: sign (x - zero) times its unit, over gear_ratio."""

    column: str
    """Its name in the log."""
    time: str | None = None
    """Column with the times of this one, where it has its own; in the unit of [time]."""
    unit: str | None = None
    """Unit of the column; that of the port if not given."""
    sign: float = 1.0
    """1 or -1."""
    zero: float = 0.0
    """What the column shows at the zero of the port, in the unit of the column."""
    gear_ratio: float = 1.0
    """For an encoder on the motor's shaft, or a torque measured behind the gear."""
    counts_per_turn: float | None = None
    """For the unit counts."""
    torque_constant: float | None = None
    """For a current [N.m/A]."""
    mm_per_turn: float | None = None
    """For a length: travel per turn of the motor. If not given, the port takes the number of mm."""
    scale: float | None = None
    """Instead of a unit: what 1 in the column is at the port, in its unit."""
    wrap: float | None = None
    """Period after which the column starts again, in its unit."""


@dataclass(frozen=True)
class Time:
    """When the samples were taken."""

    column: str | None = None
    """Its name in the log; if not given, rows are samplePeriod apart."""
    unit: str = "s"
    """Unit of the column."""
    longest_gap: float | None = None
    """Time over which is interpolated at most [s]."""


@dataclass(frozen=True)
class Configuration:
    """What a configuration file says."""

    path: Path
    """The file."""
    time: Time
    """When the samples were taken."""
    ports: Mapping[str, Port]
    """By input of `StiffnessEstimator`."""
    parameters: Mapping[str, Value]
    """Start values of `StiffnessEstimator`, by its names."""

    def need_ports(self, modality: str) -> None:
        """Raises LogError if a port is missing that the modality needs."""
        for name in _NEEDED.get(modality, ()):
            if name not in self.ports:
                raise LogError(
                    f"{self.path}: modality {modality} needs [ports.{name}]; add it, "
                    "or choose another modality in [parameters]"
                )


def read_configuration(path: Path) -> Configuration:
    """Reads and checks a file. Raises LogError, which says where it is wrong."""
    data = parse(path).unwrap()
    _known(path, "section", data, ("time", "ports", "parameters", "identified"))
    ports = _table(path, "ports", data.get("ports", {}))
    _known(path, "port", ports, PORTS)
    if not ports:
        raise LogError(f"{path}: no [ports.*]; `sigmahat init LOG` writes a file to start from")
    return Configuration(
        path,
        Time(**_options(path, "time", _table(path, "time", data.get("time", {})), Time)),
        {
            name: Port(**_options(path, f"ports.{name}", _table(path, name, port), Port))
            for name, port in ports.items()
        },
        dict(flat(_table(path, "parameters", data.get("parameters", {})))),
    )


def parse(path: Path) -> tomlkit.TOMLDocument:
    """The file with its comments. Raises LogError if it is missing or no TOML."""
    try:
        return tomlkit.parse(path.read_text(encoding="utf-8"))
    except OSError as error:
        hint = "write one with `sigmahat init LOG`, or name it with --config"
        raise LogError(f"{path}: {error.strerror}; {hint}") from error
    except (ParseError, UnicodeDecodeError) as error:
        raise LogError(f"{path}: not TOML ({error})") from error


def _table(path: Path, name: str, value: Any) -> Mapping[str, Any]:
    if not isinstance(value, Mapping):
        raise LogError(f"{path}: {name}: expected a table [{name}], got {value!r}")
    return value


def _known(path: Path, kind: str, given: Mapping[str, Any], known: Any) -> None:
    for name in given:
        if name not in known:
            raise LogError(f"{path}: {unknown(kind, name, known)}")


def _options(path: Path, section: str, table: Mapping[str, Any], into: type) -> dict[str, Any]:
    """Checks keys and values of a table against the fields of its class."""
    known = {field.name: str(field.type) for field in fields(into)}
    _known(path, f"key in [{section}]", table, known)
    if into is Port and "column" not in table:
        raise LogError(f"{path}: [{section}] has no column; name one of the log")
    options: dict[str, Any] = {}
    for name, value in table.items():
        text = "str" in known[name]
        number = isinstance(value, (int, float)) and not isinstance(value, bool)
        if isinstance(value, str) is not text or number is text:
            kind = "text" if text else "number"
            raise LogError(f"{path}: {section}.{name}: expected a {kind}, got {value!r}")
        if not text and not math.isfinite(value):
            raise LogError(f"{path}: {section}.{name}: expected a finite number, got {value!r}")
        if not text and name != "zero" and value == 0:
            raise LogError(
                f"{path}: {section}.{name} is 0; fill in the value of your device (data sheet)"
            )
        if name == "sign" and abs(value) != 1:
            raise LogError(f"{path}: {section}.sign: expected 1 or -1, got {value!r}")
        options[name] = value if text else float(value)
    return options
