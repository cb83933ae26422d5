"""Creates the data sheet of the joint, from an estimator at the end of a replay."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

from sigmahat.estimator.estimator import Estimator
from sigmahat.files import toml_file
from sigmahat.files.output import sha256
from sigmahat.fmi.installed import version
from sigmahat.fmi.model import Value, installed_model
from sigmahat.recording import several_joints
from sigmahat.recording.configuration import Configuration
from sigmahat.result import sheet
from sigmahat.result.curve import NORMAL_95, Branch, Curve
from sigmahat.result.curve_of_log import Reach
from sigmahat.result.replayed_log import Replay
from sigmahat.result.stored import FmuId, Range
from sigmahat.result.together import together

UNITS = {
    "bias": "N.m",
    "damping": "N.m.s/rad",
    "load_friction": "",
    "eccentric": "rad",
    "delay": "s",
    "hysteresis": "N.m",
}
"""Units of the estimates of FilteredRegression besides the motor data, such as output bias_hat."""
MOTOR = {"B": "kg.m2", "D_theta": "N.m.s/rad"}
"""Units of the motor data: B is parameter motor.B and output B_hat of the FMU."""


def priors(p: Mapping[str, Value]) -> dict[str, float]:
    """Computes standard deviations of the priors of UNITS, in the units of the FMU outputs."""
    tau_e, phi = float(p["prior.tau_e"]), float(p["range.phi"])
    # Load friction has two parts: one from the torque of the spring, one from the motor torque.
    by_load = math.sqrt(2) if p["prior.tau_coulomb"] else 1.0
    per_unit = {"bias": tau_e, "damping": tau_e / phi, "hysteresis": tau_e}
    per_unit["load_friction"] = by_load
    return {name: float(p[f"prior.{name}"]) * per_unit.get(name, 1.0) for name in UNITS}


def exact(p: Mapping[str, Value]) -> Sequence[str]:
    """Returns the names of the motor data that are taken as exact; p: all parameters of the FMU."""
    if p["modality"] != "Residual":
        return []
    return [name for name in MOTOR if not float(p[f"motor.{name}"]) * float(p[f"prior.{name}"])]


def absent(p: Mapping[str, Value]) -> Sequence[str]:
    """Returns the effects that are taken as absent: tau_coulomb, and names of UNITS."""
    names = [name for name, std in priors(p).items() if not std]
    if p["modality"] == "Residual" and not p["prior.tau_coulomb"]:
        names.insert(0, "tau_coulomb")
    return names


_AMPLITUDE_95 = 2.4477
"""95 % quantile of the amplitude of two normal coordinates with std 1 (Rayleigh)."""


def data_sheet(replay: Replay, curve: Curve, recording: sheet.Recording) -> sheet.Sheet:
    """Creates the data sheet from the estimator at the end of a replay, and from its curve."""
    parameters, configuration = replay.parameters, replay.configuration.path
    identified = _identified(replay.configuration)
    last, doubt = replay.statistics.last, replay.statistics.last_doubt
    start = {**sheet.start_values(replay.estimator), **sheet.start_of(curve.polynomial)}
    claims = replay.method == "FilteredRegression"
    sigma, half = last["sigma"], NORMAL_95 * last["sigma_std"]
    interval = (sigma - half, sigma + half) if claims else None
    fresh = Estimator(start)  # it is asked before any sample
    return sheet.Sheet(
        format=sheet.FORMAT.name,
        version=sheet.FORMAT.version,
        sigmahat=version(),
        units=sheet.UNITS,
        fmu=FmuId.of(installed_model("StiffnessEstimator")),
        joint=replay.configuration.joint,
        recorded=recording,
        logs=replay.logs,
        configuration=sheet.Source(
            str(configuration), sha256(configuration) if configuration.is_file() else None
        ),
        method=replay.method,
        modality=str(parameters["modality"]),
        at_the_end=sheet.Stiffness(last["phi"], last["setPoint"], sigma, interval),
        confident=doubt == "None",
        doubt=doubt,
        misfit=last["misfit"],
        polynomial=curve.polynomial,
        curve=_points(curve) if claims else None,
        parameters=_parameters(parameters, last, identified),
        rests_on=sheet.RestsOn(
            torque_gain=float(parameters["prior.torque_gain"]),
            sigma_per_gain=last["sigma_per_gain"],
            exact=[f"motor.{name}" for name in exact(parameters)],
            absent=list(absent(parameters)),
        ),
        start_values=start,
        check=sheet.Check(sigma=fresh.output("sigma"), tau_e=fresh.output("tau_e")),
        together=together(replay.estimator, [_reach(each) for each in curve.branches]),
        excitation=replay.excitation.excitation,
    )


def _reach(branch: Branch) -> Reach:
    return Reach(branch.set_point, branch.reach)


def _points(curve: Curve) -> list[sheet.Stiffness]:
    """Returns points of the stiffness with 95 % intervals, in the range of the data."""
    found = []
    for branch in curve.branches:
        low, high = branch.stiffness_interval() or (branch.sigma, branch.sigma)
        columns = (each[branch.within].tolist() for each in (branch.phi, branch.sigma, low, high))
        for phi, sigma, *interval in zip(*columns, strict=True):
            found.append(sheet.Stiffness(phi, branch.set_point, sigma, (interval[0], interval[1])))
    return found


def _parameters(
    every: Mapping[str, Value], last: Mapping[str, float], identified: Mapping[str, Range]
) -> dict[str, sheet.Parameter]:
    """Returns the motor data and the other estimates of FilteredRegression, by name.

    The FMU outputs no intervals. An interval is from `identify`, if known, else from the prior. An
    interval that does not contain the value of the estimator is made wider.
    """
    found = {"gamma": sheet.Parameter(float(every["motor.gamma"]), "1", None, "exact")}
    claims = every["method"] == "FilteredRegression"
    measured = claims and every["modality"] == "Residual"
    for name, unit in MOTOR.items():
        value = float(every[f"motor.{name}"])
        std = value * float(every[f"prior.{name}"]) if measured else 0.0
        known = identified.get(name) if std else None
        estimate = last[f"{name}_hat"]
        if name == "B" and not estimate > 0:
            estimate = value  # no motor has such an inertia: the log did not show it
        found[name] = _with_interval(estimate, unit, value, std, known)
    if not claims:
        return found
    stds = {"tau_coulomb": float(every["prior.tau_coulomb"]) if measured else 0.0}
    stds |= priors(every)
    for name, std in stds.items():
        unit = UNITS.get(name, "N.m") or "1"
        found[name] = _with_interval(last[f"{name}_hat"], unit, 0.0, std, identified.get(name))
    std, amplitude = stds["eccentric"], found["eccentric"]
    if std:  # std of sine and cosine: the amplitude has a Rayleigh distribution, from 0 on
        most = max(_AMPLITUDE_95 * std, amplitude.value)
        found["eccentric"] = replace(amplitude, interval=(0.0, most))
    return found


def _with_interval(
    value: float, unit: str, mean: float, std: float, identified: Range | None
) -> sheet.Parameter:
    if identified is None and not std:
        return sheet.Parameter(value, unit, None, "exact")
    low, high = identified or (mean - NORMAL_95 * std, mean + NORMAL_95 * std)
    source = "prior" if identified is None else "identify"
    return sheet.Parameter(value, unit, (min(low, value), max(high, value)), source)


def _identified(configuration: Configuration) -> dict[str, Range]:
    """Reads the intervals that `identify` wrote into the configuration file."""
    if not configuration.path.is_file():
        return {}
    own = several_joints.section(toml_file.read(configuration.path), configuration.joint)
    rows: Any = own["identified"].unwrap() if "identified" in own else {}
    found = {}
    for name, row in rows.items() if isinstance(rows, dict) else ():
        keys = ("value", "half_width") if isinstance(row, dict) else ()
        pair: list[Any] = [row.get(key) for key in keys]
        # A text instead of a number means that identify found no value.
        if pair and all(isinstance(each, float) and math.isfinite(each) for each in pair):
            found[name] = (pair[0] - pair[1], pair[0] + pair[1])
    return found
