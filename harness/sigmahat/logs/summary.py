"""The result of a replay as text, for people."""

from __future__ import annotations

from collections.abc import Iterator

from sigmahat.joint.curve_text import curve_text
from sigmahat.logs.data_sheet import MOTOR, UNITS, absent, exact, priors
from sigmahat.logs.estimate import Estimate

_NEGLIGIBLE = 0.1
"""Of the standard deviation of its prior: what is estimated to be smaller is not shown."""
_WORDS = {
    "tau_coulomb": "Coulomb friction",
    "load_friction": "load friction",
    "eccentric": "eccentricity",
}


def summary(result: Estimate) -> str:
    """One screen."""
    p = result.parameters
    lines = [f"{result.log}", *(f"  {note}" for note in result.notes), ""]
    lines += [
        f"method {p['method']}, modality {p['modality']}, T = {result.T:g} s, "
        f"rls.n = {p['rls.n']}, rls.m = {p['rls.m']}, "
        f"{'odd' if p['rls.symmetric'] else 'general'} polynomial",
        f"motor: B = {p['motor.B']:.4g} kg.m2, D_theta = {p['motor.D_theta']:.4g} N.m.s/rad, "
        f"gamma = {p['motor.gamma']:g}",
        "",
        *_second_half(result),
        f"at the end: sigma = {result.sigma:.6g} N.m/rad, {_uncertainty(result)}; "
        f"{result.skipped} of {result.ticks} ticks skipped",
    ]
    lines += curve_text(result.curve)
    if p["method"] == "FilteredRegression":
        lines += [*_found(result), "this answer rests on:"]
        lines += [f"  {each}" for each in _rests_on(result)]
    return "\n".join(lines)


def _second_half(result: Estimate) -> Iterator[str]:
    (low, high), (least, most) = result.sigma_range, result.tau_e_range
    error = result.epsilon_rms
    relative = f"{100 * error / (most - least):.2g} %" if most - least > error else "100 % or more"
    yield "in the second half of the log:"
    yield f"  stiffness sigma       {low:10.4g} to {high:10.4g} N.m/rad"
    yield f"  torque tau_e, fitted  {least:10.4g} to {most:10.4g} N.m"
    yield f"  deformation phi       {result.phi_range[0]:10.4g} to {result.phi_range[1]:10.4g} rad"
    yield f"  prediction error RMS  {result.epsilon_rms:10.4g} N.m ({relative} of the torque)"
    if result.parameters["method"] == "FilteredRegression":
        reasons = ", ".join(f"{item} {100 * share:.3g} %" for item, share in result.doubt.items())
        why = f" ({reasons})" if reasons else ""
        if result.changes:
            times = ", ".join(f"{t:.4g}" for t in result.changes)
            yield f"  the stiffness changed at t = {times} s since the start of the log"
        yield f"  not confident         {100 * (1 - result.confident):10.3g} % of the time{why}"


def _uncertainty(result: Estimate) -> str:
    if result.parameters["method"] == "FilteredRegression":
        return f"standard deviation {result.sigma_std:.2g} N.m/rad"
    return "of which the method claims no uncertainty"


def _found(result: Estimate) -> Iterator[str]:
    """What FilteredRegression estimated besides the stiffness, unless it is negligible."""
    B, D_theta, tau_coulomb = (
        result.motor[name] for name in ("B_hat", "D_theta_hat", "tau_coulomb_hat")
    )
    yield (
        f"motor data found: B = {B:.4g} kg.m2, D_theta = {D_theta:.4g} N.m.s/rad, "
        f"Coulomb friction {tau_coulomb:.3g} N.m"
    )
    others = [
        f"{_WORDS.get(name, name)} {value:.3g} {UNITS[name]}".rstrip()
        for name, std in priors(result.parameters).items()
        if abs(value := result.joint[f"{name}_hat"]) > _NEGLIGIBLE * std
    ]
    yield f"of the joint: {', '.join([f'misfit of the model {result.misfit:.3g}', *others])}"


def _rests_on(result: Estimate) -> Iterator[str]:
    """What no data show, or what the parameters say is exact."""
    p = result.parameters
    gain = float(p["prior.torque_gain"])
    known = f"known to {100 * gain:.3g} %" if gain else "exact"
    yield (
        f"gain of the torque: {known} (prior.torque_gain); 1 % of it changes sigma by "
        f"{result.sigma_per_gain:.3g} %"
    )
    for name in exact(p):
        value = float(p[f"motor.{name}"])
        why = f"prior.{name} = 0" if value else "0 stays 0"
        yield f"motor.{name} = {value:.4g} {MOTOR[name]}, exactly ({why})"
    names = [_WORDS.get(name, name) for name in absent(p)]
    if names:
        yield f"no {', no '.join(names)} (priors of 0)"
    yield (
        f"ranges: torque about {p['prior.tau_e']:.3g} N.m at range.phi = {p['range.phi']:.3g} rad, "
        f"range.setPoint = {p['range.setPoint']:.3g}"
    )
