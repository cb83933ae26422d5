"""One joint on line: its samples on the ticks, its estimator, and what this has learned from."""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from sigmahat.fmi.instance import Slave
from sigmahat.fmi.opened import installed
from sigmahat.fmi.sample_loop import Recorder, SampleLoop
from sigmahat.joint.stored import LearnedLog
from sigmahat.live.clock import Clock
from sigmahat.live.messages import Columns
from sigmahat.live.ticks import PortTicks
from sigmahat.logs.configuration import Configuration
from sigmahat.logs.learned import Learned, go_on, write_learned
from sigmahat.logs.log import LogError
from sigmahat.logs.replay import gap, parameters
from sigmahat.logs.resampling import AT_TICK
from sigmahat.logs.sampling import counter_period, turns_from

OUTPUTS = ("sigma", "sigma_std", "tau_e", "tau_e_std", "phi", "setPoint", "misfit", "change_age")
"""Real outputs that are given on."""
_FLAGS = ("confident", "valid")
GIVEN = (*OUTPUTS, *_FLAGS, "doubt")
"""All that are given on."""
_PATIENCE = 0.2
"""How long a tick waits for a port of which nothing arrives while others go on [s]."""
_WAITING = 1000
"""Samples before the first one of the column time."""
_USUAL_GAP = 3.0
"""Longest gap that is interpolated, in periods, if the configuration has none."""


@dataclass(frozen=True)
class Estimated:
    """The outputs of a tick."""

    joint: str
    t: float
    """Time of the tick, as the sender counts it [s]."""
    outputs: Mapping[str, Any]
    """GIVEN."""

    @property
    def name(self) -> str:
        """Of the joint, for people: that of a configuration of one joint has none."""
        return self.joint or "joint"


class LiveJoint:
    """The estimator of one joint, and the samples that wait for its next tick."""

    def __init__(self, configuration: Configuration, learned: Learned | None = None) -> None:
        """Raises what logs/job.py does for what does not fit."""
        fmu = installed("StiffnessEstimator")
        start = parameters(fmu, configuration)
        self.configuration = configuration
        self.every = fmu.parameters(start)
        """All parameters of the estimator."""
        configuration.need_ports(str(self.every["modality"]))
        self.T = float(self.every["samplePeriod"])
        self.longest_gap = configuration.time.longest_gap or _USUAL_GAP * self.T
        """Over which values are interpolated [s]."""
        self.ports = {
            name: PortTicks(name, port, self.T, self.longest_gap)
            for name, port in configuration.ports.items()
        }
        if not any(port.column for port in configuration.ports.values()):
            raise LogError(
                f"{configuration.path}: no port has a column; name those of the messages"
            )
        self.slave = Slave(fmu, configuration.joint or "estimator").__enter__()
        self.slave.initialize(start)
        self._t_0 = 0.0
        self._logs = [] if learned is None else list(learned.logs)
        self.skipped_of_all = 0
        """Ticks that were skipped, in all recordings."""
        if learned is not None:
            self._t_0 = go_on(self.slave, learned, self.every, configuration.path)
        self._prepare()
        self._begin()

    def _prepare(self) -> None:
        self._values, self._times = np.zeros((1, len(self.ports))), np.zeros((1, 2))
        self._recorder, self._loop = Recorder(self.slave, ("a", *GIVEN), 1), SampleLoop()
        inputs = self.slave.fmu.references(self.ports, "input")
        self._loop.set_real(self.slave, inputs, self._values)
        self._loop.step(self.slave, self._times)
        self._recorder.add_to(self._loop)

    def _begin(self) -> None:
        self._start: float | None = None
        self._waiting: deque[tuple[PortTicks, float, float]] = deque(maxlen=_WAITING)
        self.ticks = self.skipped = 0
        """Of this recording."""
        self._used: dict[str, tuple[float, float] | None] = {"phi": None, "setPoint": None}
        self._counter = _Counter(self.configuration)
        for port in self.ports.values():
            port.restart()

    def take(
        self, columns: Columns, times: Mapping[str, float], clocks: Mapping[str, Clock]
    ) -> Iterator[Estimated]:
        """Yields the ticks that a message makes possible.

        times   of the time columns in the message [s]
        clocks  by time column
        """
        for name, port in self.ports.items():
            t = times.get(self.time_column(name))
            value = columns.get(port.port.column)
            if t is not None and value is not None:
                self._waiting.append((port, t, value))
        if self._start is None:
            self._start = times.get(self.time_column(""))
        if self._start is None:
            return
        while self._waiting:
            port, t, value = self._waiting.popleft()
            port.add(t - self._start, value)
        yield from self._run(clocks, is_end=False)

    def time_column(self, port: str) -> str:
        """With the times of a port; "" for the time of arrival."""
        own = self.ports[port].port.time if port else None
        return own or self.configuration.time.column or ""

    def end(self, clocks: Mapping[str, Clock], recording: Path, digest: str) -> Iterator[Estimated]:
        """Yields the last ticks of a recording; the next sample will be the first of another one.

        recording, digest  the file, and its SHA-256
        """
        yield from self._run(clocks, is_end=True)
        used = self._used
        self._logs.append(
            LearnedLog(
                str(recording), digest, self.ticks, self.skipped, used["phi"], used["setPoint"]
            )
        )
        self._t_0 += self.T * self.ticks
        self.skipped_of_all += self.skipped
        self._begin()

    def go_on(self) -> None:
        """After the end of a recording: the filters start again with the next sample."""
        self._t_0 = gap(self.slave, self._t_0, self.every)

    def write(self, path: Path) -> None:
        """Writes what was learned, after the end of a recording."""
        write_learned(self.slave, self.every, self._logs, path)

    def close(self) -> None:
        """Frees the estimator."""
        self.slave.__exit__()

    def _run(self, clocks: Mapping[str, Clock], is_end: bool) -> Iterator[Estimated]:
        if self._start is None:
            return
        clock = clocks[self.time_column("")]
        reached = (clock.now - self._start) / self.T + AT_TICK
        while self.ticks <= reached:
            for place, (name, port) in enumerate(self.ports.items()):
                value = port.at(self.ticks)
                if value is None and not is_end and not self._gives_up(name, clocks):
                    return
                self._values[0, place] = math.nan if value is None else value
            yield self._tick(clock)

    def _gives_up(self, name: str, clocks: Mapping[str, Clock]) -> bool:
        """Whether a port has no value for the next tick, since others are far ahead of it."""
        assert self._start is not None
        newest = max(clocks[self.time_column(each)].now for each in self.ports)
        at_tick = self._start + self.ticks * self.T + self.ports[name].port.delay
        if newest <= at_tick + max(_PATIENCE, self.longest_gap * (1 + AT_TICK)):
            return False
        clocks[self.time_column(name)].give_up(at_tick + AT_TICK * self.T)
        return True

    def _tick(self, clock: Clock) -> Estimated:
        assert self._start is not None
        self._counter.put_right(self._values[0])
        self._times[0] = self._t_0 + self.T * self.ticks, self.T
        self._loop.run(0, 1)
        outputs = self._recorder.row(0)
        t = self._start + clock.absolute + self.T * self.ticks
        self.ticks += 1
        for flag in _FLAGS:
            outputs[flag] = bool(outputs[flag])
        self.skipped += not outputs["valid"]
        if outputs.pop("a") > 0 and outputs["valid"]:
            for name, used in self._used.items():
                low, high = used or (math.inf, -math.inf)
                self._used[name] = min(low, outputs[name]), max(high, outputs[name])
        return Estimated(self.configuration.joint, t, outputs)


class _Counter:
    """What logs/sampling.py puts right on the ticks of a log: whole periods of a counter after
    gaps, and at the start.
    """

    def __init__(self, configuration: Configuration) -> None:
        ports = configuration.ports
        self._names, self._ports = tuple(ports), ports
        self._most = configuration.parameters.get("range.phi")
        self._both = [self._names.index(n) for n in ("theta", "q") if n in ports]
        periods = [counter_period(n, ports[n]) for n in ("theta", "q") if n in ports]
        own = int(np.argmin(periods))
        self._column, self._other = self._both[own], self._both[own - 1]
        self._period = periods[own] if len(periods) == 2 else math.inf
        self._last: tuple[float, float] | None = None
        self._was_missing = False
        self._total = self._at_start = 0

    def put_right(self, values: Any) -> None:
        """values  of the ports at a tick, nan where there is none; they are changed"""
        if not math.isfinite(self._period):
            return
        own, other = float(values[self._column]), float(values[self._other])
        is_missing = not (math.isfinite(own) and math.isfinite(other))
        if not is_missing:
            if self._last is None and self._most is not None:
                row = values.reshape(1, -1)
                most = float(self._most)
                _, self._at_start = turns_from(0.0, most, row, self._names, self._ports)
            elif self._last is not None and self._was_missing:
                step, other_step = own - self._last[0], other - self._last[1]
                self._total += round((other_step - step) / self._period)
            self._last = own, other
        self._was_missing = is_missing
        if self._total:
            values[self._column] += self._total * self._period
        if self._at_start:
            values[self._column] += self._at_start * self._period
