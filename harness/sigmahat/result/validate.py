"""The job of `sigmahat validate`: compares another log of a joint with an earlier estimate."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sigmahat.estimator.estimator import Estimator
from sigmahat.files.output import sha256
from sigmahat.fmi.model import Value
from sigmahat.motor.noise import low_pass
from sigmahat.recording import notes
from sigmahat.recording.configuration import Configuration
from sigmahat.recording.counters import JointCounter
from sigmahat.recording.estimator_parameters import all_parameters
from sigmahat.recording.gaps import stretches
from sigmahat.recording.log import Array, Log, LogError
from sigmahat.recording.notes import RecordingNote
from sigmahat.recording.replay import play
from sigmahat.recording.sampling import Samples
from sigmahat.result import sheet
from sigmahat.result.curve import NORMAL_95
from sigmahat.result.curve_of_log import union
from sigmahat.result.learned import read_learned
from sigmahat.result.replayed_log import Replay
from sigmahat.result.stored import LearnedLog

_INSTANTS = 20_000
"""Largest number of instants at which the stiffness is compared, evenly spaced in the log."""
_MOST_ERROR = 0.15
"""Largest ratio of torque error to standard deviation of the torque, if the curve is right. Logs of
a robot have up to 0.13 below 2 Hz (docs/robot.md), a log with a wrong zero has 0.19."""
LOW = 2.0  # frequency of the low pass [Hz]
_CHUNK = 1 << 16
_UNITS = {
    "rms": "N.m",
    "std": "N.m",
    "relative": "1",
    "share": "1",
    "stiffness_learned": "N.m/rad",
    "stiffness_of_this_log": "N.m/rad",
    "this_log_within_learned": "1",
    "learned_within_this_log": "1",
    "overlap": "1",
    "z": "1",
    **notes.UNITS,
}
"""Units of the numbers with these keys in JSON."""
_SHORTEST = 2.0
"""Shortest stretch that is filtered: beyond both ends, the filter has no data [1/LOW]."""


@dataclass(frozen=True)
class TorqueError:
    """Difference of predicted and measured torque of the spring."""

    rms: float  #: Root mean square of the error [N.m].
    std: float  #: Standard deviation of the measured torque [N.m].
    share: float  #: Fraction of the instants of the log that the error covers [1].

    @property
    def relative(self) -> float:
        """The error divided by this standard deviation [1]."""
        return self.rms / self.std if self.std > 0 else float("nan")

    @staticmethod
    def of(error: Array, torque: Array, ticks: int) -> TorqueError | None:
        """The error from samples of a log with `ticks` ticks; None without samples."""
        if not len(error):
            return None
        rms, std = float(np.sqrt(np.mean(error**2))), float(np.std(torque))
        return TorqueError(rms, std, len(error) / ticks)

    def as_dict(self) -> dict[str, float]:
        """For JSON; the units are in _UNITS."""
        return {
            "rms": self.rms,
            "std": self.std,
            "relative": self.relative,
            "share": self.share,
        }


def torque_errors(
    samples: Samples, start: Mapping[str, Value]
) -> tuple[TorqueError | None, TorqueError | None]:
    """The error at all instants that count, and the error below 2 Hz; None without such instants.

    The log is replayed twice: the first replay finds friction and bias of this log, the second
    replay counts. If the motor is slower than regression.slow, the sign of its friction is unknown,
    and so is the torque of the spring. These instants do not count.

    start  parameters with which the curve does not change, sheet.as_fixed_curve
    """
    record = ("valid", "a", "theta_dot", "epsilon", "tau_e_residual")
    estimator = Estimator(start, record, warn_of_range=False)
    for _ in play(estimator, samples, _CHUNK):
        pass
    estimator.restart_filters()
    parts = list(play(estimator, samples, _CHUNK))
    played = {name: np.concatenate([part[name] for part in parts]) for name in parts[0]}
    used = played["valid"] & (played["a"] > 0)
    moving = used
    if start["modality"] == "Residual":
        moving = used & (np.abs(played["theta_dot"]) >= float(start["regression.slow"]))
    both = played["epsilon"], played["tau_e_residual"]
    error, torque = (values[moving] for values in both)
    ticks = len(samples.values)
    every = TorqueError.of(error, torque, ticks)
    if 2 * LOW * samples.T >= 1:
        return every, None
    error, torque = (_below(values, used, samples.T) for values in both)
    counts = moving & np.isfinite(error)
    return every, TorqueError.of(error[counts], torque[counts], ticks)


def _below(values: Array, used: NDArray[np.bool_], T: float) -> Array:
    """Values after a low pass without phase; nan outside of stretches that are long enough."""
    filtered = np.full(len(values), np.nan)
    for first, last in zip(*stretches(used), strict=True):
        if (last - first) * T * LOW >= _SHORTEST:
            filtered[first:last] = low_pass(values[first:last], LOW, T)
    return filtered


@dataclass(frozen=True)
class Agreement:
    """Comparison of the stiffness from earlier logs with the stiffness from one log alone."""

    before: tuple[float, float]
    """Stiffness from earlier logs, and half the width of its interval; medians [N.m/rad]."""
    alone: tuple[float, float]
    """Stiffness from one log alone, and half the width of its interval; both are medians."""
    alone_in_before: float
    """Fraction of instants at which the interval of `before` contains the stiffness of `alone`."""
    before_in_alone: float
    """Fraction of instants at which the interval of `alone` contains the stiffness of `before`."""
    overlap: float  #: Fraction of the instants at which both intervals overlap.
    z: float  #: Difference divided by its standard deviation, root mean square over the instants.
    agree: bool | None
    """Whether z is at most 1.96; None if an interval contains 0 at half of the instants or more,
    because agreement would then mean nothing."""


def agreement(
    before: Mapping[str, Array], alone: Mapping[str, Array], torque_gain: float
) -> Agreement:
    """Compares two estimates at the same points, both from Estimator.evaluate.

    torque_gain  relative standard deviation of the gain of the torque: both estimates have the same
                 error of this gain, which does not explain a difference
    """
    names = ("sigma", "sigma_std", "sigma_per_gain")
    sigma, std, per_gain = (np.stack([before[name], alone[name]]) for name in names)
    difference = sigma[1] - sigma[0]
    half = NORMAL_95 * std
    by_gain = torque_gain * per_gain * np.abs(sigma)
    own = np.maximum(std**2 - by_gain**2, 0.0)
    of_difference = np.sqrt(own[0] + own[1] + (by_gain[1] - by_gain[0]) ** 2)
    with np.errstate(divide="ignore", invalid="ignore"):
        ratio = np.where(difference == 0, 0.0, difference / of_difference)
    z = float(np.sqrt(np.mean(ratio**2)))
    says_nothing = bool(np.any(np.median(half - np.abs(sigma), axis=1) >= 0))
    values, halves = np.median(sigma, axis=1).tolist(), np.median(half, axis=1).tolist()
    first, second = zip(values, halves, strict=True)
    alone_in_before, before_in_alone, overlap = (
        float(np.mean(np.abs(difference) <= width)) for width in (*half, half[0] + half[1])
    )
    agree = None if says_nothing else z <= NORMAL_95
    return Agreement(first, second, alone_in_before, before_in_alone, overlap, z, agree)


@dataclass(frozen=True)
class TurnedCounter:
    """The counter of theta or q began in another turn than in earlier logs."""

    port: str  # theta or q
    periods: int  # away from the earlier logs
    phi: float  # largest magnitude of the deformation in the earlier logs [rad]

    @property
    def in_words(self) -> str:
        return (
            f"the counter of {self.port} began {self.periods:+d} of its periods away from the logs "
            "of the learned curve, so that the deformation is wrong: set range.phi to the largest "
            f"deformation, {self.phi:.2g} rad or a little more, or ports.{self.port}.zero for this "
            "log"
        )


@dataclass(frozen=True)
class Validation:
    """Comparison of a log with the estimate from earlier logs."""

    log: Path  #: The file.
    configuration: Path  #: File of the configuration of the estimator.
    start_from: Path  #: File of the estimator state from earlier logs.
    learned_from: Sequence[str]  #: Logs from which the estimator state was computed.
    repeated: bool  #: Whether the log is among these logs: then the log confirms nothing.
    ticks: int  #: Number of ticks of the estimator over the log.
    torque: TorqueError | None
    """Error of the torque by the curve of earlier logs; None if the regression used no sample."""
    torque_below: TorqueError | None
    """Error of this torque below 2 Hz; None if the log is too short."""
    stiffness: Agreement  #: Stiffness from earlier logs compared with this log.
    notes: Sequence[RecordingNote]  #: On reading the log and on its samples.
    turned: TurnedCounter | None
    """A counter that began in another turn than in earlier logs."""

    @property
    def agree(self) -> bool | None:
        """Whether the logs agree; None if the log decides nothing, or both results are wrong."""
        agree = self.stiffness.agree
        return None if self.repeated or (agree and self.fault is not None) else agree

    @property
    def fault(self) -> str | None:
        """An error of the estimates, with its likely cause; None without an error."""
        if self.turned is not None:
            return self.turned.in_words
        for which, (value, half) in (
            ("that was learned", self.stiffness.before),
            ("of this log", self.stiffness.alone),
        ):
            if value + half < 0:
                return (
                    f"the stiffness {which} is negative, {value:.5g} +- {half:.2g} N.m/rad: a "
                    "torque or an angle has the wrong sign; check sign of the ports, motor.gamma"
                )
        error = self.torque_below or self.torque
        if error is not None and error.relative > _MOST_ERROR:
            return (
                f"the learned curve does not predict the torque, its error is "
                f"{100 * error.relative:.3g} % of the standard deviation: check the sign, "
                "zero, counts_per_turn, torque_constant and gear_ratio of the ports, motor.gamma "
                "and prior.torque_gain; or the joint has changed"
            )
        return None

    def as_dict(self) -> dict[str, Any]:
        """For JSON, with the units of its numbers by key."""
        both = self.stiffness
        return {
            "units": _UNITS,
            "log": str(self.log),
            "with": str(self.configuration),
            "start_from": str(self.start_from),
            "learned_from": self.learned_from,
            "repeated": self.repeated,
            "ticks": self.ticks,
            "torque": self.torque and self.torque.as_dict(),
            "torque_below_2_Hz": self.torque_below and self.torque_below.as_dict(),
            "stiffness_learned": both.before,
            "stiffness_of_this_log": both.alone,
            "this_log_within_learned": both.alone_in_before,
            "learned_within_this_log": both.before_in_alone,
            "overlap": both.overlap,
            "z": both.z,
            "agree": self.agree,
            "fault": self.fault,
            "notes": [note.as_dict() for note in self.notes],
        }


def validate(log: Log, configuration: Configuration, start_from: str | Path) -> Validation:
    """Replays a log with what was learned before, and without, and compares the results.

    start_from  a folder of results of `estimate`, or its state.json

    Raises LogError if log, configuration and start_from do not fit together, or for Paper2011,
    which gives no interval.
    """
    learned = read_learned(Path(start_from))
    method = all_parameters(configuration)["method"]
    if method != "FilteredRegression":
        raise LogError(
            f"{configuration.path}: method = {method} gives no interval, which validate "
            "needs; expected method = FilteredRegression"
        )
    replay = Replay(log, configuration, learned)
    samples = replay.samples
    phi, set_point = _points(samples, replay.parameters)
    if not len(phi):
        raise LogError(f"{log.path}: expected values of all ports at the same time, found none")
    start = sheet.start_values(replay.estimator)
    before = replay.estimator.evaluate(phi, set_point)
    polynomial = sheet.polynomial(start, None, None)
    start |= sheet.start_of(
        sheet.with_knees(polynomial, phi, set_point, before["tau_e"], before["sigma"])
    )
    replay = Replay(log, configuration)
    replay.run()
    alone = replay.estimator.evaluate(phi, set_point)
    torque, below = torque_errors(samples, sheet.as_fixed_curve(start))
    digest = sha256(log.path)
    return Validation(
        log=log.path,
        configuration=configuration.path,
        start_from=learned.path,
        learned_from=[each.file for each in learned.logs],
        repeated=any(each.sha256 == digest for each in learned.logs),
        ticks=len(samples.values),
        torque=torque,
        torque_below=below,
        stiffness=agreement(before, alone, float(replay.parameters["prior.torque_gain"])),
        notes=samples.notes,
        turned=_turned(samples, configuration, learned.logs),
    )


def _points(samples: Samples, parameters: Mapping[str, Value]) -> tuple[Array, Array]:
    """Returns deformation [rad] and set-point [1] at up to _INSTANTS samples with all values."""
    complete = samples.values[np.isfinite(samples.values).all(axis=1)]
    chosen = complete[:: -(-len(complete) // _INSTANTS) or 1]
    columns = dict(zip(samples.names, chosen.T, strict=True))
    nothing = np.zeros(len(chosen))
    phi = columns.get("q", nothing) - columns.get("theta", nothing)
    scale, offset = float(parameters["setPoint.scale"]), float(parameters["setPoint.offset"])
    return phi, offset + scale * columns.get("theta_c", nothing)


def _turned(
    samples: Samples, configuration: Configuration, logs: Sequence[LearnedLog]
) -> TurnedCounter | None:
    """Returns a counter whose whole periods explain that the deformation differs from `logs`."""
    reach = union([each.phi for each in logs])
    counter = JointCounter.of(configuration.ports)
    if reach is None or counter is None:
        return None
    low, high = reach
    center, most = (low + high) / 2, high - low
    periods = counter.periods_into(center, most, samples.values)
    if not periods:
        return None
    return TurnedCounter(counter.port, -periods, max(abs(low), abs(high)))


def summary(result: Validation) -> str:
    both = result.stiffness
    lines = [f"{result.log}", *(f"  {note.in_words}" for note in result.notes), ""]
    lines += [
        f"learned before from {', '.join(result.learned_from)} ({result.start_from})",
        "",
        "torque with the learned stiffness, in motion; friction and bias from this log:",
        f"  error RMS         {_error(result.torque)}",
        f"  below 2 Hz        {_error(result.torque_below)}",
        "stiffness at the end, median over the instants of this log, with 95 % interval:",
        f"  learned before    {_value(both.before)}",
        f"  this log alone    {_value(both.alone)}",
        f"  this log is within the learned interval at {100 * both.alone_in_before:.3g} % of the "
        f"instants, the learned stiffness within this log's at {100 * both.before_in_alone:.3g} %",
        f"  intervals overlap at {100 * both.overlap:.3g} %; difference over its standard "
        f"deviation {both.z:.3g} (RMS)",
        "",
        *_verdict(result),
    ]
    return "\n".join(lines)


def _error(error: TorqueError | None) -> str:
    if error is None:
        return "  cannot tell: too few samples in motion"
    return (
        f"{error.rms:10.4g} N.m, {100 * error.relative:.3g} % of its standard deviation "
        f"(at {100 * error.share:.3g} % of the instants)"
    )


def _value(value: tuple[float, float]) -> str:
    return f"{value[0]:10.5g} +- {value[1]:.2g} N.m/rad"


def _verdict(result: Validation) -> Iterator[str]:
    if result.fault is not None:
        yield result.fault
    if result.repeated:
        yield "cannot tell: the stiffness was learned from this same log"
    elif result.agree is None:
        wide = "an interval is wider than the stiffness itself"
        yield f"cannot tell: {'see above' if result.stiffness.agree else wide}"
    elif result.agree:
        yield "the logs agree"
    else:
        yield (
            "the logs do not agree: the stiffness differs by more than its intervals explain; "
            "the configuration does not fit both logs, or the joint has changed between them"
        )
