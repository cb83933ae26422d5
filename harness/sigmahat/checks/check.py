"""Checks a configuration against its log: the job of `sigmahat check`."""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from sigmahat.checks.changes import distance
from sigmahat.checks.dynamics import dynamics
from sigmahat.checks.findings import Checked, Finding, Kind, Severity
from sigmahat.checks.relation import relation, slope_of
from sigmahat.checks.samples import at_rest, columns
from sigmahat.checks.text import DOUBTS
from sigmahat.checks.view import View, view
from sigmahat.fmi.model import Value, installed_model
from sigmahat.motor.noise import variance
from sigmahat.motor.quantities import WIDE
from sigmahat.recording.configuration import PORTS, Configuration
from sigmahat.recording.estimator_parameters import all_parameters
from sigmahat.recording.log import Log, LogError
from sigmahat.recording.replay import estimator_for, play
from sigmahat.result.data_sheet import absent, exact

_INERTIA = (Kind.INERTIA, Kind.TORQUE_SCALE)
_MISFIT = 3.0  # misfit of the model; effects of real joints cause up to about 2
_NOISE = 3.0  # ratio of standard deviations, measured to configured
_LEARNED = 0.5
_DOUBTED = 0.5  # fraction of the second half
_ROOM = 1.2  # ratio of a proposed range to the largest value in the log
_WIDE = 5.0  # a range is too wide from this ratio to the largest value
_ERROR = 100  # a contradiction counts more than all notes together
_TORQUE = 3.0  # ratio of torques, measured to configured

Outputs = Mapping[str, np.ndarray[Any, Any]]


def check(log: Log, configuration: Configuration) -> Checked:
    """Finds likely errors of the configuration by a comparison with the log.

    The check uses at most 60000 ticks, in the part of the log with the most motion. The
    configuration need not be in a file.

    Raises LogError for a log and configuration that do not fit.
    """
    seen = view(log, configuration)
    findings = _swapped(seen) or [_tried(seen, each) for each in _contradictions(seen)]
    (outputs,) = play(estimator_for(configuration), seen.samples, len(seen.samples.values))
    if not any(each.severity is Severity.WRONG for each in findings):
        # After a wrong value, the findings of the replay are only consequences of this value.
        replayed = _replayed(seen, outputs)
        if any(each.kind is Kind.NO_TORQUE for each in findings):
            # Without a torque, a negative stiffness does not indicate a wrong sign.
            replayed = (each for each in replayed if each.about != "NegativeStiffness")
        findings += replayed
    is_regression = seen.every["method"] == "FilteredRegression"
    per_gain = float(outputs["sigma_per_gain"][-1]) if is_regression else 1.0
    findings += _rests_on(seen, installed_model("StiffnessEstimator").parameters({}), per_gain)
    order = list(Severity)
    findings.sort(key=lambda each: order.index(each.severity))
    return Checked(findings, len(seen.samples.values), seen.T)


def check_identified(log: Log, before: Configuration, after: Configuration) -> Checked:
    """Checks a configuration that identify has completed.

    The inertia is compared with the inertia in `before`, if the user had given that inertia.

    Raises LogError as `check`.
    """
    checked = check(log, after)
    is_given = "motor.B" in before.parameters and float(all_parameters(before)["prior.B"]) < WIDE
    if before == after or not is_given:
        return checked
    spoiled = any(each.kind in (Kind.AT_REST, Kind.JUMP, Kind.SPIKE) for each in checked.findings)
    found = [] if spoiled else _of_motion(view(log, before), [])  # its columns were checked above
    of_inertia = [each for each in found if each.kind in _INERTIA]
    others = [each for each in checked.findings if each.kind not in _INERTIA]
    return replace(checked, findings=[*of_inertia, *others])


_UNLIKE = 5.0  # slope of q on theta that is too large for a soft spring
_ALIKE = 1.5


def _swapped(seen: View) -> list[Finding]:
    """Returns a finding if q moves like theta only after a swap of the columns of theta and q."""
    ports = seen.configuration.ports
    if not {"theta", "q"} <= ports.keys():
        return []
    now = slope_of(seen.pieces, seen.T)
    if now is None or distance(abs(now.value), 1.0) < math.log(_UNLIKE):
        return []
    theta, q = ports["theta"], ports["q"]
    if abs(theta.gear_ratio) < 1:
        return []  # an inverted gear ratio has the same effect as swapped columns
    turned = {
        "theta": replace(theta, column=q.column, time=q.time, zero=q.zero),
        "q": replace(q, column=theta.column, time=theta.time, zero=theta.zero),
    }
    try:
        other = view(seen.log, replace(seen.configuration, ports={**ports, **turned}))
    except LogError:
        return []
    slope = slope_of(other.pieces, other.T)
    if slope is None or distance(abs(slope.value), 1.0) > math.log(_ALIKE):
        return []
    key, second = "ports.theta.column", [("ports.q.column", theta.column)]
    return [Finding(Kind.SLOPE, Severity.WRONG, key, now.value, "", 1.0, q.column, second, "swap")]


def _tried(seen: View, finding: Finding) -> Finding:
    """Completes a finding with the proposed value that leaves the fewest findings.

    The finding gets no value if no proposed value removes the finding.
    """
    if finding.severity is not Severity.WRONG or finding.proposed is None:
        return finding
    every = [(finding.key, finding.proposed), *finding.others]
    best, least = None, math.inf
    for key, value in every:
        if value is None:
            continue
        try:
            left = _contradictions(view(seen.log, changed(seen.configuration, key, value)))
        except LogError:
            continue
        if any((e.kind, e.about) == (finding.kind, finding.about) for e in left):
            continue
        weight = sum(_ERROR if each.severity is Severity.WRONG else 1 for each in left)
        if weight < least:
            best, least = (key, value), weight
    if best is None:
        return replace(finding, proposed=None)
    others = [each for each in every if each != best]
    return replace(finding, key=best[0], proposed=best[1], others=others)


def changed(configuration: Configuration, key: str, value: Any) -> Configuration:
    """Changes the value of a configuration key, such as "ports.tau.sign" or "motor.gamma"."""
    section, _, name = key.partition(".")
    if section == "time":
        return replace(configuration, time=replace(configuration.time, **{name: value}))
    if section != "ports":
        return replace(configuration, parameters={**configuration.parameters, key: value})
    port, _, name = name.partition(".")
    own = replace(configuration.ports[port], **{name: value})
    return replace(configuration, ports={**configuration.ports, port: own})


def _contradictions(seen: View) -> Sequence[Finding]:
    """Finds contradictions of log and configuration, without consequences of other findings."""
    if still := list(at_rest(seen)):
        return still
    recorded = list(columns(seen))
    if any(each.kind in (Kind.JUMP, Kind.SPIKE) for each in recorded):
        return recorded
    return list(_of_motion(seen, recorded))


def _of_motion(seen: View, recorded: Sequence[Finding]) -> Iterator[Finding]:
    """Yields contradictions by the motion, and findings of the columns with other causes."""
    here = relation(seen)
    yield from here.findings
    keys = {each.key for each in here.findings}
    if "ports.theta.gear_ratio" in keys:
        return  # with a wrong gear ratio, the torque at the gear output is wrong too
    for each in recorded:
        if not any(key.startswith(f"ports.{each.about}.") for key in keys):
            yield each
    if "ports.q.gear_ratio" not in keys:
        yield from _gears(seen)
    yield from dynamics(here)


_SAME = 0.01  # two gear ratios count as equal up to this relative difference


def _gears(seen: View) -> Iterator[Finding]:
    gamma = abs(seen.gamma)
    for name in ("theta", "tau"):
        port = seen.configuration.ports.get(name)
        gear = abs(port.gear_ratio) if port else 1.0
        if gear == 1 or abs(gamma / gear - 1) < _SAME:
            continue
        keys = [("motor.gamma", gear), (f"ports.{name}.gear_ratio", gamma)]
        if name == "tau":
            keys.reverse()
        (key, right), other = keys
        yield Finding(Kind.GEAR, Severity.WRONG, key, other[1], "", right, right, [other], name)


def _rests_on(seen: View, start: Mapping[str, Value], per_gain: float) -> Iterator[Finding]:
    """Yields the assumptions about ports and motor that no log can verify.

    start     start values of all parameters
    per_gain  relative change of the stiffness per relative change of the gain of the torque
    """
    every, given = seen.every, seen.configuration.ports
    tau = given.get("tau")
    is_current = tau is not None and tau.torque_constant is not None
    key = "ports.tau.torque_constant" if is_current else "prior.torque_gain"
    gain = float(every["prior.torque_gain"])
    yield Finding(Kind.TORQUE_GAIN, Severity.RESTS_ON, key, per_gain, "", gain)
    if {"theta", "q"} <= given.keys():
        theta, q = (f"{name} in {given[name].unit or PORTS[name]}" for name in ("theta", "q"))
        yield Finding(
            Kind.UNIT, Severity.RESTS_ON, "ports.theta.unit", 1.0, "", about=f"{theta} and {q}"
        )
    for name in ("B", "D_theta"):
        is_other = every[f"motor.{name}"] == start[f"motor.{name}"]
        if every["modality"] == "Residual" and is_other and float(every[f"prior.{name}"]) < WIDE:
            value = float(every[f"motor.{name}"])
            yield Finding(Kind.OTHER_ROBOT, Severity.RESTS_ON, f"motor.{name}", value, "")
    if every["method"] != "FilteredRegression":
        return
    for name in exact(every):
        value = float(every[f"motor.{name}"])
        yield Finding(Kind.EXACT, Severity.RESTS_ON, f"prior.{name}", value, "", about=name)
    for name in absent(every):
        yield Finding(Kind.ABSENT, Severity.RESTS_ON, f"prior.{name}", 0.0, "", about=name)


def _replayed(seen: View, outputs: Outputs) -> Iterator[Finding]:
    """Yields findings from the outputs of the estimator when the log is replayed."""
    yield from _range(seen, outputs)
    yield from _noise(seen)
    valid = outputs["valid"]
    learned = float(np.mean(valid & (outputs["a"] > 0)))
    if learned < _LEARNED:
        yield Finding(Kind.LEARNED, Severity.NOTE, "time.longest_gap", learned, "", 1.0)
    if seen.every["method"] == "FilteredRegression":
        yield from _claims(outputs)


def _range(seen: View, outputs: Outputs) -> Iterator[Finding]:
    every, known = seen.every, seen.configuration.parameters
    is_regression = every["method"] == "FilteredRegression"
    phi, given = float(np.max(np.abs(outputs["phi"]))), float(every["range.phi"])
    # Before `identify` has run, range.phi may be missing, which is no finding.
    if is_regression and "range.phi" in known and not given / _WIDE < phi < given:
        severity = Severity.WRONG if phi > _ROOM * given else Severity.NOTE
        proposed = float(f"{_ROOM * phi:.3g}")
        yield Finding(Kind.RANGE, severity, "range.phi", phi, "rad", given, proposed)
    torque = max((float(np.max(np.abs(p.tau))) for p in seen.pieces), default=0.0)
    torque, given, key = abs(seen.gamma) * torque, float(every["prior.tau_e"]), "prior.tau_e"
    if is_regression and key in known and torque > _TORQUE * given > 0:
        proposed = float(f"{_ROOM * torque:.3g}")
        yield Finding(Kind.RANGE, Severity.WRONG, key, torque, "N.m", given, proposed)


def _noise(seen: View) -> Iterator[Finding]:
    """Compares the noise of the torque with the configured noise."""
    key = "noise.tau_e" if seen.has_sensor else "noise.tau"
    if not seen.pieces or (seen.every["modality"] == "Model"):
        return
    times = abs(seen.gamma) if seen.has_sensor else 1.0
    longest = max(seen.pieces, key=lambda piece: len(piece.tau))
    noise, given = times * variance(longest.tau) ** 0.5, float(seen.every[key])
    if given > 0 and noise > 0 and not 1 / _NOISE < noise / given < _NOISE:
        proposed = float(f"{noise:.3g}")
        yield Finding(Kind.NOISE, Severity.NOTE, key, noise, "N.m", given, proposed)


def _claims(outputs: Outputs) -> Iterator[Finding]:
    """Yields a large misfit of the model, and doubts that the estimator reports often."""
    misfit = float(outputs["misfit"][-1])
    if misfit > _MISFIT:
        yield Finding(Kind.MISFIT, Severity.NOTE, "rls.n", misfit, "", 1.0)
    doubts = outputs["doubt"][len(outputs["doubt"]) // 2 :]
    for item, (key, _) in DOUBTS.items():
        share = float(np.mean(doubts == item))
        if share > _DOUBTED and not (item == "Misfit" and misfit > _MISFIT):
            yield Finding(Kind.DOUBT, Severity.NOTE, key, share, "", 0.0, about=item)
