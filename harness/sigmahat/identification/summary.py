"""The result of an identification as text, for people, and as values for JSON."""

from __future__ import annotations

import math
from dataclasses import asdict
from typing import Any

from sigmahat.identification.quantities import Advice, Identified, Quantity
from sigmahat.identification.regression import COULOMB_VELOCITY


def as_dict(identified: Identified) -> dict[str, Any]:
    """For JSON; units are in the names, or beside the value."""
    return {
        **{
            name: {
                "value": quantity.value if quantity.determined else None,
                "interval": list(quantity.interval),
                "unit": quantity.unit,
            }
            for name, quantity in identified.quantities.items()
        },
        "rls.n": identified.n,
        "rls.m": identified.m,
        "tau noise variance [(N.m)2]": identified.tau_variance,
        "theta noise variance [rad2]": identified.theta_variance,
        "filter bandwidth [rad/s]": identified.bandwidth,
        "filter.V_a": identified.V_a,
        "deformation is noise above [Hz]": _or_none(identified.coherent),
        "zero of the deformation [rad]": identified.zero,
        "largest phi [rad]": identified.phi,
        "largest setPoint [1]": identified.set_point,
        "largest gamma tau [N.m]": identified.torque,
        "next motion": [asdict(each) for each in identified.advice],
        "notes": list(identified.notes),
    }


def summary(identified: Identified) -> str:
    """One screen."""
    lines = [f"  {note}" for note in identified.notes]
    lines.append("")
    lines += [f"{name:16}{_text(each)}" for name, each in identified.quantities.items()]
    lines += [f"  {_advice(each)}" for each in identified.advice]
    lines += [
        "",
        f"orders          rls.n = {identified.n}, rls.m = {identified.m} (cross-validation)",
        f"noise           torque {math.sqrt(identified.tau_variance):.2g} N.m, "
        f"motor position {math.sqrt(identified.theta_variance):.2g} rad (standard deviations)",
        f"filter          V_a = {identified.V_a:.2g} rad2/s4; "
        f"bandwidth {identified.bandwidth:.3g} rad/s",
        f"ranges          deformation {identified.phi:.3g} rad, "
        f"set-point {identified.set_point:.3g}, gamma tau {identified.torque:.3g} N.m",
        f"friction is     tau_coulomb tanh(theta_dot / ({COULOMB_VELOCITY:g} rad/s))",
    ]
    if math.isfinite(identified.coherent):
        lines.append(
            f"above {identified.coherent:.2g} Hz the deformation is noise, "
            "not caused by a torque; the bandwidth is below that"
        )
    return "\n".join(lines)


def _or_none(value: float) -> float | None:
    return value if math.isfinite(value) else None


def _text(quantity: Quantity) -> str:
    low, high = quantity.interval
    if quantity.determined:
        return f"{quantity.value:.4g} +- {quantity.half_width:.2g} {quantity.unit} (95 %)"
    if math.isfinite(quantity.half_width):
        return f"cannot tell: somewhere from {low:.2g} to {high:.2g} {quantity.unit}"
    return "cannot tell: the motion does not show it"


def _advice(advice: Advice) -> str:
    """What to record next, in a sentence."""
    known = f"known to {_percent(advice.known_to)}" if math.isfinite(advice.known_to) else "unknown"
    start = f"{advice.name} is {known}:"
    motion = advice.motion
    if motion is None:
        return (
            f"{start} no motion with up to twice the torque of this log would show it well; "
            "record one with more load on the link"
        )
    sines = " and ".join(f"{f:g} Hz with +- {A:.2g} rad" for A, f in motion.sines)
    return (
        f"{start} record {motion.duration:g} s of theta = sines of {sines} (about "
        f"{motion.torque:.2g} N.m of the motor, {motion.reversals} reversals), which would give "
        f"{_percent(advice.would_be)}"
    )


def _percent(share: float) -> str:
    return f"+- {100 * share:.2g} %"
