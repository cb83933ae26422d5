"""Converts the findings of a check to sentences for the user."""

import math
from collections.abc import Iterator, Mapping, Sequence

from sigmahat.checks.findings import Checked, Finding, Kind, Severity
from sigmahat.estimator.doubts import DOUBTS
from sigmahat.motor.hypotheses.hypothesis import Setting
from sigmahat.result.sheet import WORDS

TITLES = {
    Severity.WRONG: "checked, likely wrong in the configuration:",
    Severity.NOTE: "worth a look:",
    Severity.RESTS_ON: "assumptions that no log can verify:",
}

_OF_PORTS = (Kind.PORT, Kind.LARGEST_TORQUE)  # what follows from unit and side of all ports


def summary(checked: Checked) -> str:
    """Formats all findings as text that fits on one screen."""
    lines = [] if checked.is_wrong else [nothing_found(checked)]
    for severity, title in TITLES.items():
        if found := checked.of(severity):
            lines += [title, *(f"  {line}" for line in _lines(found))]
    return "\n".join(lines)


def _lines(found: Sequence[Finding]) -> Iterator[str]:
    """Makes one line of each finding, and one of what the configuration says of all ports."""
    ports = [_what(each) for each in found if each.kind in _OF_PORTS]
    if ports:
        yield f"ports: {'; '.join(ports)}"
    yield from (sentence(each) for each in found if each.kind not in _OF_PORTS)


def nothing_found(checked: Checked) -> str:
    """Returns the line of text for a log that shows no wrong value of the configuration."""
    seconds = f"{checked.ticks * checked.T:.6g} s"
    if not checked.fits:
        return (
            f"checked: no key is shown to be wrong, but the model does not fit the log of {seconds}"
        )
    return f"checked: nothing in {seconds} of the log contradicts the configuration"


def sentence(finding: Finding) -> str:
    """Describes a finding in one line: the key, the error, and the proposed value."""
    return f"{finding.key}: {_what(finding)}{_proposal(finding)}"


def _proposal(finding: Finding) -> str:
    if finding.proposed is None and not finding.others:
        return ""
    first = "" if finding.proposed is None else f"; try {_value(finding.proposed)}"
    others = [key if v is None else f"{key} = {_value(v)}" for key, v in finding.others]
    if finding.about == "swap":
        return f"{first} and {' and '.join(others)}"
    return f"{first}; else look at {' or '.join(others)}" if others else first


def _value(value: Setting) -> str:
    if isinstance(value, str):
        return f'"{value}"'
    return str(value).lower() if isinstance(value, bool) else f"{value:.9g}"


def _number(value: float | None, unit: str) -> str:
    return "" if value is None else f"{value:.3g} {unit}".rstrip()


def _what(f: Finding) -> str:
    """Formats the sentence for the kind of the finding, with measured and expected values."""
    if f.kind is Kind.PORT:
        return _port(f)
    template = _SPECIAL.get((f.kind, f.about)) or _SENTENCES[f.kind]
    if f.kind is Kind.TORQUE_LAG and f.measured < 0:
        template = "the torque is {ms} earlier than the motion explains, or the spring is damped"
    return template.format(
        measured=_number(f.measured, f.unit),
        expected=_number(f.expected, f.unit),
        value=f.measured,
        about=f.about,
        percent=f"{100 * f.measured:.3g} %",
        ms=f"{1e3 * abs(f.measured):.3g} ms",
        later="later" if f.measured > 0 else "earlier",
        ratio=f.measured / f.expected if f.expected else math.nan,
        gear=f"the gear ratio of {f.about}" if f.key == "motor.gamma" else "motor.gamma",
        given=f.expected,
        reason=DOUBTS.get(f.about, ("", f.about))[1],
        effect=WORDS.get(f.about, ""),
        row=f.row,
        in_row="" if f.row is None else f" in row {f.row}",
        gain=f"known to {100 * f.expected:.3g} %" if f.expected else "taken as exact",
    )


def _port(f: Finding) -> str:
    """Says in plain words what a configuration says of a port."""
    torque = {"tau": "of the motor, before the gear", "tau_e_sensor": "of the spring"}
    position = {
        "theta": "the position of the motor, after the gear",
        "q": "the position of the link",
        "phi": "the deformation, q - theta",
    }
    is_torque = f.about in torque
    if f.about == "tau" and f.measured != 1:
        side = f"of the joint, after a gear of {f.measured:.6g}"
    elif f.about == "theta" and f.measured != 1:
        side = f"the position of the motor's shaft, before a gear of {f.measured:.6g}"
    else:
        side = torque[f.about] if is_torque else position[f.about]
    if f.expected is None:
        what = f"the torque {side}" if is_torque else side
        return f"{f.about} is {what}, in {f.unit}"
    if is_torque:
        return f"1 {f.unit or 'in the column'} is {f.expected:.6g} N.m, the torque {side}"
    return f"{f.about} is {side}; 1 in the column is {f.expected:.6g} rad"


_SPECIAL = {
    (Kind.SLOPE, "held"): "q moves {value:.4g} times as far as theta, expected about 1, unless a "
    "hand moves the link while the motor is held",
    (Kind.SLOPE, "sign"): "q moves against theta",
    (Kind.SLOPE, "swap"): "the columns of theta and q are swapped: the link would move "
    "{value:.4g} times as far",
    (Kind.UNEXPLAINED, "swap"): "the columns of theta and q are swapped: {percent} of the torque "
    "(RMS) are no function of the motion, and hardly any the other way round",
    (Kind.STIFFNESS_SIGN, "swap"): "the columns of theta and q are swapped: the stiffness would be "
    "{measured}, and is above 0 the other way round",
    (Kind.SIGN, "power"): "with this sign the joint would drive its motor, by {measured} on "
    "average, and friction takes power from the motor",
    (Kind.AT_REST, "q"): "the link does not move while the motor does: its encoder is dead, or the "
    "column is wrong. If the link is locked on purpose, write ports.q.value = 0 in place of the "
    "column",
    (Kind.AT_REST, "theta"): "the motor does not move while the link does: its encoder is dead, "
    "or the column is wrong",
}
_INERTIA = "the log shows an inertia of {measured}, {ratio:.3g} times motor.B"
_SENTENCES: Mapping[Kind, str] = {
    Kind.AT_REST: "the joint is at rest throughout the {measured} of the log; record a joint that "
    "moves",
    Kind.SLOPE: "q moves {value:.4g} times as far as theta, expected about 1",
    Kind.GEAR: "it is {value:g}, but {gear} is {given:g}",
    Kind.SIGN: "with this sign inertia, friction or stiffness are negative: the stiffness would be "
    "{measured}",
    Kind.STIFFNESS_SIGN: "the stiffness would be {measured}, below 0; a deformation of the "
    "wrong sign or scale does that",
    Kind.ZERO: "the spring has no torque at a deformation of {measured}, not at 0",
    Kind.ASYMMETRY: "the torque is not symmetric in phi: the errors are {value:.3g} times as "
    "large as with all powers",
    Kind.TORQUE_LAG: "the torque is {ms} later than the motion explains",
    Kind.ENCODER_LAG: "the viscous friction would be negative, as if q were recorded {about}{ms} "
    "{later} than theta",
    Kind.INERTIA: _INERTIA,
    Kind.TORQUE_SCALE: f"{_INERTIA}, as if the torque were geared twice or not at all",
    Kind.OTHER_ROBOT: "{value:.4g} is the start value, of another robot",
    Kind.LARGEST_TORQUE: "so the largest torque at the link is {measured}, the largest deformation "
    "{given:.3g} rad: compare with the data sheet of the joint",
    Kind.SIZE: "the {about} is {measured}, of usual joints at most {expected}",
    Kind.STEP: "the values of {about} change in steps of {measured}, the configured encoder has "
    "{expected}",
    Kind.JUMP: "{about} jumps by {measured}{in_row}, as a counter that starts again",
    Kind.SPIKE: "{about} is up to {measured} away from both neighbours in {given:g} samples: they "
    "were lost, leave them empty",
    Kind.PLACEHOLDER: "{percent} of the samples are {given:g} between values far from it, first in "
    "row {row}: another sender, or no answer of the sensor; they are left out. Stop the other "
    "sender, or leave these cells empty",
    Kind.HELD: "{percent} of the samples repeat the value before while the joint moves, first in "
    "row {row}: the sensor is slower than the log, or did not answer; they are left out. Record "
    "this column with times of its own, or leave these cells empty",
    Kind.FROZEN: "{about} has one value from row {row} on ({percent} of the log), while the other "
    "position moves on: its encoder died, or the link is blocked; use the rows before",
    Kind.SATURATION: "the torque stays at an end of its range for {percent} of the samples",
    Kind.NO_TORQUE: "the torque is only noise ({measured}): the motor is off, or the column is "
    "wrong. The stiffness then rests on motor.B, motor.D_theta and the Coulomb friction alone",
    Kind.NOISE: "the noise of the torque is {measured}, the configuration says {expected}",
    Kind.UNEXPLAINED: "the model does not fit: {percent} of the torque (RMS) remain with any sign, "
    "gear, zero, delay and inertia. Is it the torque of this joint? Does another load act on the "
    "motor, as a payload or a weight compensation before the spring? Does the link itself bend?",
    Kind.MISFIT: "the errors of the model are {value:.3g} times as large as noise explains",
    Kind.DOUBT: "not confident in {percent} of the second half: {reason}",
    Kind.RANGE: "the log has up to {measured}, the configuration {expected} (identify sets it)",
    Kind.LEARNED: "the estimator learned at {percent} of the ticks only",
    Kind.TORQUE_GAIN: "gain of the torque, {gain}; 1 % of it changes the stiffness by "
    "{value:.3g} %",
    Kind.EXACT: "motor.{about} = {value:.4g} is taken as exact",
    Kind.ABSENT: "no {effect} is assumed",
}
