"""Checks a configuration against its log: the job of `sigmahat check`."""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from sigmahat.checks.assumptions import of_ports, of_size
from sigmahat.checks.contradictions import (
    of_gears,
    of_misfit,
    of_positions,
    of_sizes,
    of_swap,
    of_torque,
)
from sigmahat.checks.findings import Checked, Finding, Kind, Severity
from sigmahat.checks.samples import at_rest, of_columns
from sigmahat.estimator.doubts import DOUBTS
from sigmahat.fmi.model import Value, installed_model
from sigmahat.motor.hypotheses.hypothesis import with_value
from sigmahat.motor.hypotheses.positions import compare_positions
from sigmahat.motor.inertia import is_inertia_given
from sigmahat.motor.log_view import LogView, liveliest_part
from sigmahat.motor.noise import variance
from sigmahat.motor.quantities import WIDE
from sigmahat.recording.configuration import Configuration
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
_BY_NOISE = ("Misfit", "Change")  # doubts that compare errors of the model with the noise

Output = np.ndarray[Any, Any]
Outputs = Mapping[str, Output]


def check(log: Log, configuration: Configuration) -> Checked:
    """Finds likely errors of the configuration by a comparison with the log.

    The check uses at most 60000 ticks, in the part of the log with the most motion. The
    configuration need not be in a file.

    Raises LogError for a log and configuration that do not fit.
    """
    view = liveliest_part(log, configuration)
    findings = list(of_swap(view)) or [_tried(view, each) for each in _contradictions(view)]
    (outputs,) = play(estimator_for(configuration), view.samples, len(view.samples.values))
    if not any(each.severity is Severity.WRONG for each in findings):
        # After a wrong value, the findings of the replay are only consequences of this value.
        has_misfit = any(each.kind is Kind.UNEXPLAINED for each in findings)
        replayed = _replayed(view, outputs, has_misfit)
        if any(each.kind is Kind.NO_TORQUE for each in findings):
            # Without a torque, a negative stiffness does not indicate a wrong sign.
            replayed = (each for each in replayed if each.about != "NegativeStiffness")
        findings += replayed
    is_regression = view.parameters["method"] == "FilteredRegression"
    per_gain = _usual(outputs["sigma_per_gain"]) if is_regression else 1.0
    findings += _rests_on(view, installed_model("StiffnessEstimator").parameters({}), per_gain)
    order = list(Severity)
    findings.sort(key=lambda each: order.index(each.severity))
    return Checked(findings, len(view.samples.values), view.T)


def check_identified(log: Log, before: Configuration, after: Configuration) -> Checked:
    """Checks a configuration that identify has completed.

    The inertia is compared with the inertia in `before`, if the user had given that inertia.

    Raises LogError as `check`.
    """
    checked = check(log, after)
    if before == after or not is_inertia_given(before, all_parameters(before)):
        return checked
    spoiled = any(each.kind in (Kind.AT_REST, Kind.JUMP, Kind.SPIKE) for each in checked.findings)
    of_inertia = []
    if not spoiled:
        view = liveliest_part(log, before)
        # The columns were checked above.
        of_inertia = [each for each in _of_motion(view, []) if each.kind in _INERTIA]
    others = [each for each in checked.findings if each.kind not in _INERTIA]
    return replace(checked, findings=[*of_inertia, *others])


def _tried(view: LogView, finding: Finding) -> Finding:
    """Completes a finding with the proposed value that leaves the fewest findings.

    The finding gets no value, and other keys neither, if no proposed value removes the finding.
    """
    if finding.severity is not Severity.WRONG or finding.proposed is None:
        return finding
    if finding.about == "swap":
        return finding  # two keys at once
    settings = [(finding.key, finding.proposed), *finding.others]
    best, least = None, math.inf
    for key, value in settings:
        if value is None:
            continue
        changed = with_value(view.configuration, key, value)
        try:
            left = _contradictions(liveliest_part(view.log, changed))
        except LogError:
            continue
        if any((other.kind, other.about) == (finding.kind, finding.about) for other in left):
            continue
        weight = sum(_ERROR if other.severity is Severity.WRONG else 1 for other in left)
        if weight < least:
            best, least = (key, value), weight
    if best is None:
        return replace(finding, proposed=None, others=[(key, None) for key, _ in finding.others])
    others = [setting for setting in settings if setting != best]
    return replace(finding, key=best[0], proposed=best[1], others=others)


def _contradictions(view: LogView) -> Sequence[Finding]:
    """Finds contradictions of log and configuration, without consequences of other findings."""
    if still := list(at_rest(view)):
        return still
    recorded = list(of_columns(view))
    if any(each.kind in (Kind.JUMP, Kind.SPIKE) for each in recorded):
        return recorded
    return list(_of_motion(view, recorded))


def _of_motion(view: LogView, recorded: Sequence[Finding]) -> Iterator[Finding]:
    """Yields contradictions by the motion, and findings of the columns with other causes."""
    compared = compare_positions(view)
    of_model = list(of_misfit(compared))
    yield from of_model
    has_misfit = bool(of_model)
    found = list(of_positions(compared, has_misfit))
    yield from found
    keys = {each.key for each in found}
    if "ports.theta.gear_ratio" in keys:
        return  # with a wrong gear ratio, the torque at the gear output is wrong too
    for each in recorded:
        if not any(key.startswith(f"ports.{each.about}.") for key in keys):
            yield each
    if "ports.q.gear_ratio" not in keys:
        yield from of_gears(view)
    yield from of_sizes(compared)
    yield from of_torque(compared, has_misfit)


def _rests_on(view: LogView, start: Mapping[str, Value], per_gain: float) -> Iterator[Finding]:
    """Yields the assumptions about ports and motor that no log can verify.

    start     start values of the FMU
    per_gain  relative change of the stiffness per relative change of the gain of the torque
    """
    parameters = view.parameters
    given = view.configuration.ports
    tau = given.get("tau")
    is_current = tau is not None and tau.torque_constant is not None
    key = "ports.tau.torque_constant" if is_current else "prior.torque_gain"
    gain = float(parameters["prior.torque_gain"])
    yield Finding(Kind.TORQUE_GAIN, Severity.RESTS_ON, key, per_gain, "", gain)
    yield from of_ports(given)
    yield from of_size(view)
    for name in ("B", "D_theta"):
        is_other = parameters[f"motor.{name}"] == start[f"motor.{name}"]
        if (
            parameters["modality"] == "Residual"
            and is_other
            and float(parameters[f"prior.{name}"]) < WIDE
        ):
            value = float(parameters[f"motor.{name}"])
            yield Finding(Kind.OTHER_ROBOT, Severity.RESTS_ON, f"motor.{name}", value, "")
    if parameters["method"] != "FilteredRegression":
        return
    for name in exact(parameters):
        value = float(parameters[f"motor.{name}"])
        yield Finding(Kind.EXACT, Severity.RESTS_ON, f"prior.{name}", value, "", about=name)
    for name in absent(parameters):
        yield Finding(Kind.ABSENT, Severity.RESTS_ON, f"prior.{name}", 0.0, "", about=name)


def _usual(per_gain: Output) -> float:
    """Returns the median in the second half: in a dead zone, where the stiffness is about 0, the
    relative change of a single tick may have any value."""
    return float(np.median(per_gain[len(per_gain) // 2 :]))


def _replayed(view: LogView, outputs: Outputs, has_misfit: bool) -> Iterator[Finding]:
    """Yields findings from the outputs of the estimator when the log is replayed.

    has_misfit  whether another finding says that the model does not fit
    """
    yield from _range(view, outputs)
    yield from _noise(view)
    valid = outputs["valid"]
    learned = float(np.mean(valid & (outputs["a"] > 0)))
    if learned < _LEARNED:
        yield Finding(Kind.LEARNED, Severity.NOTE, "time.longest_gap", learned, "", 1.0)
    if view.parameters["method"] == "FilteredRegression":
        yield from _claims(outputs, _is_noise_known(view), has_misfit)


def _range(view: LogView, outputs: Outputs) -> Iterator[Finding]:
    parameters = view.parameters
    known = view.configuration.parameters
    is_regression = parameters["method"] == "FilteredRegression"
    phi, given = float(np.max(np.abs(outputs["phi"]))), float(parameters["range.phi"])
    # Before `identify` has run, range.phi may be missing, which is no finding.
    if is_regression and "range.phi" in known and not given / _WIDE < phi < given:
        severity = Severity.WRONG if phi > _ROOM * given else Severity.NOTE
        proposed = float(f"{_ROOM * phi:.3g}")
        yield Finding(Kind.RANGE, severity, "range.phi", phi, "rad", given, proposed)
    torque = max((float(np.max(np.abs(p.tau))) for p in view.pieces), default=0.0)
    torque, given, key = abs(view.gamma) * torque, float(parameters["prior.tau_e"]), "prior.tau_e"
    if is_regression and key in known and torque > _TORQUE * given > 0:
        proposed = float(f"{_ROOM * torque:.3g}")
        yield Finding(Kind.RANGE, Severity.WRONG, key, torque, "N.m", given, proposed)


def _noise_key(view: LogView) -> str:
    return "noise.tau_e" if view.has_sensor else "noise.tau"


def _is_noise_known(view: LogView) -> bool:
    """Returns whether the configuration gives the noise of the torque. Before `identify` has run,
    it is usually missing, which is no finding; the start value is of another robot."""
    return _noise_key(view) in view.configuration.parameters


def _noise(view: LogView) -> Iterator[Finding]:
    """Compares the noise of the torque with the configured noise."""
    key = _noise_key(view)
    if not view.pieces or view.parameters["modality"] == "Model" or not _is_noise_known(view):
        return
    times = abs(view.gamma) if view.has_sensor else 1.0
    longest = max(view.pieces, key=lambda piece: len(piece.tau))
    noise, given = times * variance(longest.tau) ** 0.5, float(view.parameters[key])
    if given > 0 and noise > 0 and not 1 / _NOISE < noise / given < _NOISE:
        proposed = float(f"{noise:.3g}")
        yield Finding(Kind.NOISE, Severity.NOTE, key, noise, "N.m", given, proposed)


def _claims(outputs: Outputs, is_noise_known: bool, has_misfit: bool) -> Iterator[Finding]:
    """Yields a large misfit of the model, and doubts that the estimator reports often.

    is_noise_known  whether the configuration gives the noise: misfit and evidence of a change are
                    relative to it, and say nothing without it
    has_misfit      whether another finding says that the model does not fit
    """
    misfit = float(outputs["misfit"][-1])
    is_misfit = misfit > _MISFIT
    if is_misfit and is_noise_known and not has_misfit:
        yield Finding(Kind.MISFIT, Severity.NOTE, "rls.n", misfit, "", 1.0)
    doubts = outputs["doubt"][len(outputs["doubt"]) // 2 :]
    for item, (key, _) in DOUBTS.items():
        if item in _BY_NOISE and not is_noise_known:
            continue
        share = float(np.mean(doubts == item))
        if share > _DOUBTED and not (item == "Misfit" and is_misfit):
            yield Finding(Kind.DOUBT, Severity.NOTE, key, share, "", 0.0, about=item)
