"""A log that is replayed through one estimator: the steps of every command, in their order."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from sigmahat.fmi.instance import Slave
from sigmahat.joint.stored import LearnedLog
from sigmahat.logs.configuration import Configuration
from sigmahat.logs.curve import Answer, curve
from sigmahat.logs.learned import Learned, go_on
from sigmahat.logs.log import Log
from sigmahat.logs.measured import points_of, shown_points
from sigmahat.logs.replay import parameters, play
from sigmahat.logs.sampling import sample
from sigmahat.logs.statistics import ReplayStatistics

_CHUNK = 1 << 14  # ticks that are replayed at a time, about


class Replay:
    """Every row of the log goes through the estimator once."""

    def __init__(
        self,
        slave: Slave,
        log: Log,
        configuration: Configuration,
        learned: Learned | None = None,
    ) -> None:
        """Initialises the slave, lets it go on from what was learned, and samples the log.

        Raises LogError for what does not fit the configuration, FmuError if the FMU refuses.
        """
        start = parameters(slave.fmu, configuration)
        self.slave, self.log, self.configuration = slave, log, configuration
        self.every = slave.fmu.parameters(start)
        """All parameters of the estimator."""
        configuration.need_ports(str(self.every["modality"]))
        slave.initialize(start)
        # Before the log is read: it may not fit.
        self.t = 0.0 if learned is None else go_on(slave, learned, self.every, configuration.path)
        """Time that the estimator has reached [s]."""
        self.samples = sample(log, configuration, float(self.every["samplePeriod"]))
        self.statistics = ReplayStatistics(len(self.samples.values))
        self.logs = [] if learned is None else list(learned.logs)
        """What the estimator has learned from; at the end this log, too."""

    @property
    def method(self) -> str:
        """Of the estimator."""
        return str(self.every["method"])

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
        chunk = statistics.bucket * max(1, _CHUNK // statistics.bucket)
        for outputs in play(self.slave, self.samples, chunk, self.t):
            statistics.add(outputs)
            add(outputs)
            now = done + len(outputs["valid"])
            progress(1000 * now // ticks - 1000 * done // ticks)
            done = now
        self.t += self.samples.T * ticks
        phi, set_point = statistics.used("phi"), statistics.used("setPoint")
        file = str(self.log.path)
        self.logs.append(LearnedLog(file, digest, ticks, statistics.skipped, phi, set_point))

    def answer(self) -> Answer:
        """The curve and the points behind it, at the end."""
        outputs = self.statistics.spread_over_log
        found = curve(self.slave, self.every, self.logs, points_of(outputs, self.method))
        return Answer(found, shown_points(outputs, self.method))
