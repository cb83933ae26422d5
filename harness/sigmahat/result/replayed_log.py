"""Replays a log through one estimator, and collects statistics of the outputs."""

from collections import Counter
from collections.abc import Callable, Mapping
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sigmahat.estimator.powers import powers_of_phi
from sigmahat.fmi.model import Value
from sigmahat.recording.configuration import Configuration
from sigmahat.recording.estimator_parameters import all_parameters
from sigmahat.recording.log import Array, Log
from sigmahat.recording.replay import OUTPUTS, RECORDED, estimator_for, play
from sigmahat.recording.sampling import sample
from sigmahat.result.curve_of_log import (
    NEEDED,
    Answer,
    curve,
    extremes,
    points_of,
    restarts,
    shown_points,
    since_change,
    spread,
)
from sigmahat.result.excitation import ExcitationSums
from sigmahat.result.headline import Confidence, StiffnessChange
from sigmahat.result.learned import Learned, continue_from
from sigmahat.result.stored import LearnedLog, Range

_BUCKETS = 4000
_OPERATION = ("phi", "setPoint")
_POINTS = 20_000
_NOTHING = (np.inf, -np.inf)  # range of no value
DRAWN = ("sigma", "sigma_std", "tau_e", "tau_e_residual", "phi", "setPoint")


def _wider(known: Range, values: Array) -> Range:
    """Extends a known range so that the range contains further values."""
    return min(known[0], float(values.min())), max(known[1], float(values.max()))


class ReplayStatistics:
    """Collects extrema of each output in up to 4000 intervals, and statistics of the second half.

    A plot of minima and maxima looks like a plot of all values. The number of extrema does not grow
    with the log.
    """

    def __init__(self, ticks: int) -> None:
        self.bucket = -(-ticks // _BUCKETS)
        """Ticks per interval; the length of each chunk but the last must be a multiple of it."""
        self._parts: dict[str, list[Array]] = {name: [] for name in DRAWN}
        self._half = ticks // 2
        self.ticks = self._later = self.skipped = 0
        self._doubts: Counter[str] = Counter()
        self._squares = 0.0
        self.later = dict.fromkeys(DRAWN, _NOTHING)
        """Minimum and maximum of each output in the second half of the log, by output."""
        self.used: dict[str, Range] = {}
        """Ranges of phi and setPoint at the samples that the regression used, if any."""
        self._stride = -(-ticks // _POINTS)
        self.points: dict[str, list[np.ndarray[Any, Any]]] = {name: [] for name in NEEDED}
        """Values of the outputs NEEDED at up to 20000 ticks, evenly distributed in the log."""
        self.last: dict[str, float] = {}  # Real outputs of the last tick
        self.last_doubt = ""  # item of the output doubt at the last tick

    def add(self, outputs: Mapping[str, np.ndarray[Any, Any]]) -> None:
        """Adds the outputs of the next ticks."""
        count = len(outputs["valid"])
        for name in DRAWN:
            self._parts[name].append(extremes(outputs[name], self.bucket))
        first = max(0, self._half - self.ticks)
        if first < count:
            valid = outputs["valid"][first:]
            self._squares += float(np.sum(outputs["epsilon"][first:][valid] ** 2))
            self._later += int(np.count_nonzero(valid))
            self._doubts.update(outputs["doubt"][first:].tolist())
            for name in DRAWN:
                self.later[name] = _wider(self.later[name], outputs[name][first:])
        shown = spread(self.ticks, count, self._stride)
        for name in NEEDED:
            self.points[name].append(outputs[name][shown])
        self.skipped += int(np.count_nonzero(~outputs["valid"]))
        self.ticks += count
        self.last = {name: float(outputs[name][-1]) for name in OUTPUTS}
        self.last_doubt = str(outputs["doubt"][-1])
        learning = outputs["valid"] & (outputs["a"] > 0)
        for name in _OPERATION if learning.any() else ():
            self.used[name] = _wider(self.used.get(name, _NOTHING), outputs[name][learning])

    def ends(self, name: str) -> Array:
        """Returns minimum and maximum of an output in each interval [size: 2 intervals]."""
        return np.concatenate(self._parts[name])

    @property
    def doubts(self) -> dict[str, float]:
        """Fractions of the ticks in the second half, by item of the output `doubt`, sorted."""
        ticks = self._doubts.total()
        return {item: count / ticks for item, count in self._doubts.most_common()}

    @property
    def confidence(self) -> Confidence:
        return Confidence(self.last_doubt, self.doubts)

    @property
    def rms(self) -> float:
        """RMS of the prediction error of the torque in the second half [N.m]."""
        return float(np.sqrt(self._squares / max(self._later, 1)))


def coefficients(parameters: Mapping[str, Value]) -> list[str]:
    """Returns the names of the outputs with the coefficients of the torque, (21)."""
    n, m = int(parameters["rls.n"]), int(parameters["rls.m"])
    return [f"eta[{i},{j}]" for i in range(n) for j in range(m)]


_FOLLOWED = 1.0  # time in which the estimate follows a change [s]


class Changes:
    """Collects changes of the stiffness from the outputs of a replay.

    The estimator may start again several times before the estimate follows a change. A further
    change counts only after an estimate that is confident a second after the last change or later.
    """

    def __init__(self, parameters: Mapping[str, Value], T: float) -> None:
        """parameters  all parameters of the estimator; T  time between ticks [s]"""
        n, m = int(parameters["rls.n"]), int(parameters["rls.m"])
        self.names = coefficients(parameters)
        """Names of the required outputs besides change_age, confident, phi and setPoint."""
        self._powers = np.repeat(powers_of_phi(bool(parameters["rls.symmetric"]), n), m)
        self._powers_of_set_point = np.tile(np.arange(m), n)
        self._T, self._ticks, self._age, self._followed = T, 0, -1.0, True
        self._begin = 0  # tick of the last change
        self._eta: NDArray[np.float64] | None = None  # at the last confident tick since a change
        self._at = 0.0, 0.0  # deformation and set-point of the last change
        self._before: float | None = None  # stiffness before the last change, at this point
        self.found: list[StiffnessChange] = []  # all changes until now

    def add(self, outputs: Mapping[str, NDArray[Any]]) -> None:
        """Adds the outputs of the next ticks."""
        age = outputs["change_age"]
        eta = np.column_stack([outputs[name] for name in self.names])
        confident = np.flatnonzero(outputs["confident"])
        for begin, end in pairwise([-1, *restarts(age, self._age).tolist(), len(age)]):
            if begin >= 0 and self._followed:
                self._at = float(outputs["phi"][begin]), float(outputs["setPoint"][begin])
                self._before = None if self._eta is None else self._stiffness(self._eta)
                self._eta, self._followed = None, False
                self._begin = self._ticks + begin
                self.found.append(StiffnessChange(self._T * (self._ticks + begin), None))
            inside = confident[(confident >= begin) & (confident < end)]
            if len(inside):
                self._eta = eta[inside[-1]]
                since = self._ticks + inside[-1] - self._begin
                self._followed = self._followed or self._T * since >= _FOLLOWED
                if self._before is not None and self._before > 0:
                    relative = self._stiffness(self._eta) / self._before - 1
                    self.found[-1] = StiffnessChange(self.found[-1].t, relative)
        self._ticks, self._age = self._ticks + len(age), float(age[-1])

    def _stiffness(self, eta: NDArray[np.float64]) -> float:
        """Computes the stiffness by (21) at the point of the last detected change [N.m/rad]."""
        (phi, set_point), p = self._at, self._powers
        slopes = p * np.power(phi, np.maximum(p - 1, 0))
        return float(eta @ (slopes * np.power(set_point, self._powers_of_set_point)))


_CHUNK = 1 << 15  # approximate number of ticks per chunk, and of rows per group in Parquet


class Replay:
    """Replays every row of a log once through an estimator."""

    def __init__(
        self, log: Log, configuration: Configuration, learned: Learned | None = None
    ) -> None:
        """Starts an estimator, restores its state from earlier logs, and samples the log.

        Raises LogError if log or state do not fit the configuration.
        """
        self.log, self.configuration = log, configuration
        self.parameters = all_parameters(configuration)  # of the estimator
        self.method = str(self.parameters["method"])  # method of the estimator
        configuration.need_ports(str(self.parameters["modality"]))
        record = (*RECORDED, *coefficients(self.parameters))
        self.estimator = estimator_for(configuration, record)
        if learned is not None:  # before the log is read, because this step may fail
            continue_from(learned, self.estimator, configuration.path)
        self.samples = sample(log, configuration, float(self.parameters["samplePeriod"]))
        self.statistics = ReplayStatistics(len(self.samples.values))
        self.changes = Changes(self.parameters, self.samples.T)
        """Changes of the stiffness in the replayed part of the log."""
        self.excitation = ExcitationSums(self.samples.T)  # of the replayed part of the log
        self.logs = [] if learned is None else list(learned.logs)
        """Logs that the estimator has processed; at the end also the present log."""

    def run(
        self,
        add: Callable[[Mapping[str, Any]], object] = lambda outputs: None,
        progress: Callable[[int], object] = lambda thousandths: None,
        digest: str = "",
    ) -> None:
        """Replays all samples; calls `add` with outputs, and `progress` with thousandths since the
        last call. The argument digest is the SHA-256 of the log, which is stored with the state.
        """
        statistics, ticks, done = self.statistics, len(self.samples.values), 0
        chunk = statistics.bucket * max(1, _CHUNK // statistics.bucket)
        for recorded in play(self.estimator, self.samples, chunk):
            self.changes.add(recorded)
            outputs = {name: recorded[name] for name in RECORDED}
            statistics.add(outputs)
            self.excitation.add(outputs)
            add(outputs)
            now = done + len(outputs["valid"])
            progress(1000 * now // ticks - 1000 * done // ticks)
            done = now
        phi, set_point = (statistics.used.get(name) for name in _OPERATION)
        file = str(self.log.path)
        self.logs.append(LearnedLog(file, digest, ticks, statistics.skipped, phi, set_point))

    def answer(self) -> Answer:
        """Computes the curve and its measured points at the end of the replay."""
        parts = self.statistics.points.items()
        outputs = since_change({name: np.concatenate(of_chunks) for name, of_chunks in parts})
        found = curve(self.estimator, self.logs, points_of(outputs, self.method))
        shown = shown_points(outputs, self.method)
        return Answer(found, shown, self.statistics.confidence, self.changes.found)
