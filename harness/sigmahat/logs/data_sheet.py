"""The data sheet of the joint, from an estimator at the end of a replay."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from sigmahat.files.digest import sha256
from sigmahat.fmi.installed import version
from sigmahat.fmi.instance import Fmu, Recorder, Slave, Value
from sigmahat.fmi.saved_state import restore, save
from sigmahat.joint import sheet
from sigmahat.joint.records import FmuId, LearnedLog, Range
from sigmahat.joint.start_values import start_values
from sigmahat.logs import assumptions
from sigmahat.logs.frozen import stiffness_at
from sigmahat.user_input import toml_file

NORMAL_95 = 1.96
"""Half the width of an interval of 95 % over the standard deviation."""
_AMPLITUDE_95 = 2.4477
"""95 % of the distances of two such coordinates from 0 are smaller (Rayleigh)."""
_POINTS, _SETTINGS = 21, 5
"""Of the curve: deformations, and set-points if there are several."""


def data_sheet(
    slave: Slave,
    every: Mapping[str, Value],
    logs: Sequence[LearnedLog],
    configuration: Path,
    last: Mapping[str, float],
    doubt: str,
) -> sheet.Sheet:
    """The sheet of what a slave has learned.

    every          parameters of the slave
    logs           that it has learned from
    configuration  the file of the parameters
    last           Real outputs of the last tick
    doubt          the output of that name at the last tick
    """
    start = start_values(slave, every)
    covered = _union([log.phi for log in logs]), _union([log.set_point for log in logs])
    claims = every["method"] == "MatchedFilter"
    return sheet.Sheet(
        format=sheet.FORMAT.name,
        version=sheet.FORMAT.version,
        sigmahat=version(),
        units=sheet.UNITS,
        fmu=FmuId.of(slave.fmu),
        logs=list(logs),
        configuration=_source(configuration),
        method=str(every["method"]),
        modality=str(every["modality"]),
        at_the_end=_point(last, claims),
        confident=doubt == "None",
        doubt=doubt,
        misfit=last["misfit"],
        polynomial=sheet.polynomial(start, *covered),
        curve=_curve(slave, every, *covered) if claims else None,
        parameters=_parameters(every, last, configuration),
        rests_on=sheet.RestsOn(
            torque_gain=float(every["prior.torque_gain"]),
            sigma_per_gain=last["sigma_per_gain"],
            exact=[f"motor.{name}" for name in assumptions.exact(every)],
            absent=list(assumptions.absent(every)),
        ),
        start_values=start,
        check=_check(slave.fmu, start),
    )


def _union(ranges: Sequence[Range | None]) -> Range | None:
    found = [each for each in ranges if each is not None]
    return (min(low for low, _ in found), max(high for _, high in found)) if found else None


def _source(path: Path) -> sheet.Source:
    return sheet.Source(str(path), sha256(path) if path.is_file() else None)


def _point(outputs: Mapping[str, float], claims: bool) -> sheet.Stiffness:
    sigma, half = outputs["sigma"], NORMAL_95 * outputs["sigma_std"]
    interval = (sigma - half, sigma + half) if claims else None
    return sheet.Stiffness(outputs["phi"], outputs["setPoint"], sigma, interval)


def _curve(
    slave: Slave, every: Mapping[str, Value], phi: Range | None, set_point: Range | None
) -> list[sheet.Stiffness]:
    """Stiffness with its interval over the range of the data; none without data."""
    if phi is None or set_point is None:
        return []
    scale, offset = float(every["setPoint.scale"]), float(every["setPoint.offset"])
    settings = np.linspace(*set_point, _SETTINGS) if np.ptp(set_point) else set_point[:1]
    points = [
        (0.0, x, (s - offset) / scale if scale else 0.0)
        for s in settings
        for x in np.linspace(*phi, _POINTS)
    ]
    with Slave(slave.fmu, "curve") as other:
        other.initialize(every)
        t_0, T = restore(other, save(slave)), float(every["samplePeriod"])
        found = stiffness_at(other, ("theta", "q", "theta_c"), np.array(points), t_0, T)
    rows = zip(*found.values(), strict=True)
    return [_point(dict(zip(found, map(float, row), strict=True)), True) for row in rows]


def _check(fmu: Fmu, start: Mapping[str, Value]) -> sheet.Check:
    """What the FMU says with the start values, before any sample."""
    with Slave(fmu, "check") as other:
        other.initialize(start)
        outputs = Recorder(other, ["sigma", "tau_e"], 1)
        outputs.sample(0)
        return sheet.Check(**{name: float(x[0]) for name, x in outputs.columns().items()})


def _parameters(
    every: Mapping[str, Value], last: Mapping[str, float], configuration: Path
) -> dict[str, sheet.Parameter]:
    """Motor data, and what else MatchedFilter estimated.

    The FMU gives no interval of them. `identify` has written some; else it is that of the prior.
    """
    found = {"gamma": sheet.Parameter(float(every["motor.gamma"]), "1", None, "exact")}
    claims = every["method"] == "MatchedFilter"
    measured = claims and every["modality"] == "Residual"
    identified = _identified(configuration)
    for name, unit in assumptions.MOTOR.items():
        value = float(every[f"motor.{name}"])
        std = value * float(every[f"prior.{name}"]) if measured else 0.0
        found[name] = _with_interval(
            last[f"{name}_hat"], unit, value, std, identified.get(name) if std else None
        )
    if not claims:
        return found
    stds = {"tau_coulomb": float(every["prior.tau_coulomb"]) if measured else 0.0}
    stds |= assumptions.priors(every)
    for name, std in stds.items():
        unit = assumptions.UNITS.get(name, "N.m") or "1"
        found[name] = _with_interval(last[f"{name}_hat"], unit, 0.0, std, identified.get(name))
    std, amplitude = stds["eccentric"], found["eccentric"]
    if std:  # of sine and cosine each: the amplitude is not normal, and never below 0
        found["eccentric"] = replace(amplitude, interval=(0.0, _AMPLITUDE_95 * std))
    return found


def _with_interval(
    value: float, unit: str, mean: float, std: float, identified: Range | None
) -> sheet.Parameter:
    if identified is not None:
        return sheet.Parameter(value, unit, identified, "identify")
    if not std:
        return sheet.Parameter(value, unit, None, "exact")
    return sheet.Parameter(value, unit, (mean - NORMAL_95 * std, mean + NORMAL_95 * std), "prior")


def _identified(configuration: Path) -> dict[str, Range]:
    """Intervals that `identify` wrote into the configuration."""
    if not configuration.is_file():
        return {}
    rows: Any = toml_file.read(configuration).unwrap().get("identified", {})
    found = {}
    for name, row in rows.items() if isinstance(rows, dict) else ():
        if not isinstance(row, dict):
            continue
        value, half = row.get("value"), row.get("half_width")
        if not (isinstance(value, float) and isinstance(half, float)):  # "cannot tell"
            continue
        if math.isfinite(value) and math.isfinite(half):
            found[name] = (value - half, value + half)
    return found
