"""Findings as sentences for people."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

from sigmahat.checks.findings import Checked, Finding, Kind, Proposal, Severity

IN_LOG = (Severity.WRONG, Severity.NOTE)
"""What the log shows. The commands that estimate say themselves what their answer rests on."""
TITLES = {
    Severity.WRONG: "checked, likely wrong in the configuration:",
    Severity.NOTE: "worth a look:",
    Severity.RESTS_ON: "no log can show; the answer rests on it:",
}
_DOUBTS = {
    "NotExcited": "the motion was too small or too short",
    "Misfit": "the log contradicts the model",
    "OutOfRange": "the deformation is far beyond range.phi",
    "FrictionOutsidePrior": "the friction found is beyond prior.D_theta",
    "InertiaOutsidePrior": "the inertia found is beyond prior.B",
    "NegativeStiffness": "the stiffness found is negative",
}
_ABSENT = {
    "tau_coulomb": "Coulomb friction",
    "load_friction": "friction by load",
    "eccentric": "eccentricity of the encoders",
    "delay": "delay of the torque",
}


def summary(checked: Checked, severities: Sequence[Severity] = tuple(Severity)) -> str:
    """One screen, with findings of these severities."""
    lines = [] if checked.is_wrong else [nothing_found(checked)]
    for severity, title in TITLES.items():
        if severity not in severities:
            continue
        found = checked.of(severity)
        lines += [title, *(f"  {sentence(each)}" for each in found)] if found else []
    return "\n".join(lines)


def nothing_found(checked: Checked) -> str:
    """The line for a log that contradicts nothing."""
    seconds = f"{checked.ticks * checked.T:.6g} s"
    return f"checked: nothing in {seconds} of the log contradicts the configuration"


def sentence(finding: Finding) -> str:
    """The finding, the key to look at, and what it should be, in one line."""
    return f"{finding.key}: {_SENTENCES[finding.kind](finding)}{_proposal(finding)}"


def _proposal(finding: Finding) -> str:
    if finding.proposed is None and not finding.others:
        return ""
    first = "" if finding.proposed is None else f"; try {_value(finding.proposed)}"
    others = " or ".join(
        key if value is None else f"{key} = {_value(value)}" for key, value in finding.others
    )
    return f"{first}; else look at {others}" if others else first


def _value(value: Proposal) -> str:
    if isinstance(value, str):
        return f'"{value}"'
    return str(value).lower() if isinstance(value, bool) else f"{value:.9g}"


def _number(value: float | None, unit: str) -> str:
    return "" if value is None else f"{value:.3g} {unit}".rstrip()


def _slope(f: Finding) -> str:
    opposite = "q moves against theta" if f.about == "sign" else ""
    return opposite or f"q moves {f.measured:.4g} times as far as theta, expected about 1"


def _gear(f: Finding) -> str:
    if f.key == "motor.gamma":
        return f"it is {f.measured:g}, but the gear ratio of {f.about} is {f.expected:g}"
    return f"it is {f.measured:g}, but motor.gamma is {f.expected:g}"


def _sign(f: Finding) -> str:
    return (
        "with this sign inertia, friction or stiffness are negative: the stiffness would be "
        f"{_number(f.measured, f.unit)}"
    )


def _stiffness(f: Finding) -> str:
    return (
        f"the stiffness would be {_number(f.measured, f.unit)}, below 0; a deformation of the "
        "wrong sign or scale does that"
    )


def _zero(f: Finding) -> str:
    return f"the spring has no torque at a deformation of {_number(f.measured, f.unit)}, not at 0"


def _torque_lag(f: Finding) -> str:
    ms = f"{1e3 * abs(f.measured):.3g} ms"
    if f.measured > 0:
        return f"the torque comes {ms} later than the motion explains"
    return f"the torque comes {ms} earlier than the motion explains, or the spring is damped"


def _encoder_lag(f: Finding) -> str:
    side = "later" if f.measured > 0 else "earlier"
    return (
        "the viscous friction would be negative, as if q were recorded "
        f"{1e3 * abs(f.measured):.3g} ms {side} than theta"
    )


def _inertia(f: Finding) -> str:
    ratio = f.measured / f.expected if f.expected else float("nan")
    return f"the log shows an inertia of {_number(f.measured, f.unit)}, {ratio:.3g} times motor.B"


def _torque_scale(f: Finding) -> str:
    return f"{_inertia(f)}, as if the torque were geared twice or not at all"


def _step(f: Finding) -> str:
    return (
        f"the values of {f.about} change in steps of {_number(f.measured, f.unit)}, "
        f"the configured encoder has {_number(f.expected, f.unit)}"
    )


def _jump(f: Finding) -> str:
    return f"{f.about} jumps by {_number(f.measured, f.unit)}, as a counter that starts again"


def _saturation(f: Finding) -> str:
    return f"the torque stays at an end of its range for {100 * f.measured:.3g} % of the samples"


def _noise(f: Finding) -> str:
    return (
        f"the noise of the torque is {_number(f.measured, f.unit)}, "
        f"the configuration says {_number(f.expected, f.unit)}"
    )


def _misfit(f: Finding) -> str:
    return f"the errors of the model are {f.measured:.3g} times as large as noise explains"


def _doubt(f: Finding) -> str:
    reason = _DOUBTS[f.about]
    return f"not confident in {100 * f.measured:.3g} % of the second half: {reason}"


def _range(f: Finding) -> str:
    return (
        f"the log reaches {_number(f.measured, f.unit)}, the configuration says "
        f"{_number(f.expected, f.unit)} (identify sets it)"
    )


def _learned(f: Finding) -> str:
    return f"the estimator learned at {100 * f.measured:.3g} % of the ticks only"


def _gain(f: Finding) -> str:
    gain = f"known to {100 * f.expected:.3g} %" if f.expected else "taken as exact"
    return f"gain of the torque, {gain}; 1 % of it changes the stiffness by {f.measured:.3g} %"


def _other_robot(f: Finding) -> str:
    return "motor.B, motor.D_theta and motor.gamma are still those of the AwAS"


def _exact(f: Finding) -> str:
    return f"motor.{f.about} = {f.measured:.4g} is taken as exact"


def _absent(f: Finding) -> str:
    return f"no {_ABSENT.get(f.about, f.about)} is assumed"


_SENTENCES: Mapping[Kind, Callable[[Finding], str]] = {
    Kind.SLOPE: _slope,
    Kind.GEAR: _gear,
    Kind.SIGN: _sign,
    Kind.STIFFNESS_SIGN: _stiffness,
    Kind.ZERO: _zero,
    Kind.TORQUE_LAG: _torque_lag,
    Kind.ENCODER_LAG: _encoder_lag,
    Kind.INERTIA: _inertia,
    Kind.TORQUE_SCALE: _torque_scale,
    Kind.OTHER_ROBOT: _other_robot,
    Kind.STEP: _step,
    Kind.JUMP: _jump,
    Kind.SATURATION: _saturation,
    Kind.NOISE: _noise,
    Kind.MISFIT: _misfit,
    Kind.DOUBT: _doubt,
    Kind.RANGE: _range,
    Kind.LEARNED: _learned,
    Kind.TORQUE_GAIN: _gain,
    Kind.EXACT: _exact,
    Kind.ABSENT: _absent,
}
