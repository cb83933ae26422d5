"""A log that is replayed through one estimator: its steps, and the statistics of its outputs."""

from collections import Counter
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from sigmahat.fmi.instance import Slave
from sigmahat.joint.stored import LearnedLog, Range
from sigmahat.logs.changes import Changes
from sigmahat.logs.configuration import Configuration
from sigmahat.logs.curve import NEEDED, Answer, curve, points_of, shown_points, spread
from sigmahat.logs.learned import Learned, go_on
from sigmahat.logs.log import Array, Log
from sigmahat.logs.replay import OUTPUTS, parameters, play
from sigmahat.logs.sampling import sample

_BUCKETS = 4000
_OPERATION = ("phi", "setPoint")
_POINTS = 20_000
_NOTHING = (np.inf, -np.inf)  # range of no value
DRAWN = ("sigma", "sigma_std", "tau_e", "tau_e_residual", "phi", "setPoint")


def _wider(known: Range, values: Array) -> Range:
    """The range of what is known and of further values."""
    return min(known[0], float(values.min())), max(known[1], float(values.max()))


class ReplayStatistics:
    """Extrema of each output in up to 4000 intervals, and statistics of the second half.

    The minima and maxima give the same picture as all values, and their number does not grow with
    the log.
    """

    def __init__(self, ticks: int) -> None:
        self.bucket = -(-ticks // _BUCKETS)
        """Ticks in an interval; each chunk but the last must be a multiple of this number."""
        self._parts: dict[str, list[Array]] = {name: [] for name in DRAWN}
        self._half = ticks // 2
        self.ticks = self._later = self.skipped = 0
        self._doubts: Counter[str] = Counter()
        self._squares = 0.0
        self.later = dict.fromkeys(DRAWN, _NOTHING)
        """Minimum and maximum in the second half of the log, by output."""
        self.used: dict[str, Range] = {}
        """Range of phi and setPoint at the samples that the regression used, if any."""
        self._stride = -(-ticks // _POINTS)
        self.points: dict[str, list[np.ndarray[Any, Any]]] = {name: [] for name in NEEDED}
        """Parts of the outputs NEEDED of up to 20000 ticks, evenly over the log."""
        self.last: dict[str, float] = {}  # Real outputs of the last tick
        self.last_doubt = ""  # item of the output doubt at the last tick

    def add(self, outputs: Mapping[str, np.ndarray[Any, Any]]) -> None:
        """Adds the outputs of the next ticks."""
        count = len(outputs["valid"])
        starts = np.arange(0, count, self.bucket)
        for name in DRAWN:
            ends = [each.reduceat(outputs[name], starts) for each in (np.minimum, np.maximum)]
            self._parts[name].append(np.column_stack(ends))
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
        """Minimum and maximum in each interval, [size: intervals x 2]."""
        return np.concatenate(self._parts[name])

    @property
    def doubts(self) -> dict[str, float]:
        """Fraction of the ticks in the second half by item of the output doubt, largest first."""
        ticks = self._doubts.total()
        return {item: count / ticks for item, count in self._doubts.most_common()}

    @property
    def rms(self) -> float:
        """RMS of the prediction error of the torque in the second half [N.m]."""
        return float(np.sqrt(self._squares / max(self._later, 1)))


_CHUNK = 1 << 15  # ticks that are replayed at a time, about, and rows of a group in Parquet


class Replay:
    """Replays every row of a log once through an estimator."""

    def __init__(
        self, slave: Slave, log: Log, configuration: Configuration, learned: Learned | None = None
    ) -> None:
        """Initialises the slave, gives it the learned state, and samples the log.

        Raises LogError if log or state do not fit the configuration, FmuError if the FMU refuses.
        """
        start = parameters(slave.fmu, configuration)
        self.slave, self.log, self.configuration = slave, log, configuration
        self.every = slave.fmu.parameters(start)  # all parameters of the estimator
        configuration.need_ports(str(self.every["modality"]))
        slave.initialize(start)
        # Before the log is read, because the learned state may not fit.
        self.t = 0.0 if learned is None else go_on(slave, learned, self.every, configuration.path)
        """Present time of the estimator [s]."""
        self.samples = sample(log, configuration, float(self.every["samplePeriod"]))
        self.statistics = ReplayStatistics(len(self.samples.values))
        self.changes = Changes(self.every, self.samples.T)
        """Changes of the stiffness in the replayed part of the log."""
        self.method = str(self.every["method"])  # method of the estimator
        self.logs = [] if learned is None else list(learned.logs)
        """Logs from which the estimator has learned; at the end also the present log."""

    def run(
        self,
        add: Callable[[Mapping[str, Any]], object] = lambda outputs: None,
        progress: Callable[[int], object] = lambda thousandths: None,
        digest: str = "",
    ) -> None:
        """Plays all samples; `add` is given the outputs, `progress` the thousandths since its last
        call. digest is the SHA-256 of the log for the record.
        """
        statistics, ticks, done = self.statistics, len(self.samples.values), 0
        of_curve = self.changes.names
        chunk = statistics.bucket * max(1, _CHUNK // statistics.bucket)
        for outputs in play(self.slave, self.samples, chunk, self.t, of_curve):
            self.changes.add(outputs)
            for name in of_curve:
                del outputs[name]
            statistics.add(outputs)
            add(outputs)
            now = done + len(outputs["valid"])
            progress(1000 * now // ticks - 1000 * done // ticks)
            done = now
        self.t += self.samples.T * ticks
        phi, set_point = (statistics.used.get(name) for name in _OPERATION)
        file = str(self.log.path)
        self.logs.append(LearnedLog(file, digest, ticks, statistics.skipped, phi, set_point))

    def answer(self) -> Answer:
        """The curve and its measured points, at the end."""
        parts = self.statistics.points.items()
        outputs = {name: np.concatenate(of_chunks) for name, of_chunks in parts}
        found = curve(self.slave, self.every, self.logs, points_of(outputs, self.method))
        return Answer(found, shown_points(outputs, self.method), self.statistics.last_doubt)
