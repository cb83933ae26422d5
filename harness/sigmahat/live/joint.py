"""Runs the estimator of one joint on line, with samples at the ticks of the estimator.

Samples are interpolated at the ticks, and units and counters converted, as in
recording/resampling.py.
"""

import math
from collections import deque
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sigmahat.files.output import finite
from sigmahat.live.clock import Clock
from sigmahat.live.messages import Columns
from sigmahat.recording.configuration import PORTS, Configuration, Port
from sigmahat.recording.log import LogError
from sigmahat.recording.replay import estimator_for
from sigmahat.recording.resampling import AT_TICK, counter, turns_from
from sigmahat.recording.units import scale, seconds
from sigmahat.result.curve import NORMAL_95
from sigmahat.result.learned import Learned, continue_from, write_learned
from sigmahat.result.stored import LearnedLog

OUTPUTS = ("sigma", "sigma_std", "tau_e", "tau_e_std", "phi", "setPoint", "misfit", "change_age")
"""Real outputs that are sent to the sinks."""
_FLAGS = ("confident", "valid")
GIVEN = (*OUTPUTS, *_FLAGS, "doubt")  # all outputs that are sent to the sinks
BANDED = ("sigma", "tau_e")  # outputs whose 95 % intervals are sent, too: sigma_low, ...
_PATIENCE = 0.2  # [s] a tick waits for a port without samples while other ports have some
_WAITING, _MOST = 1000, 10_000  # most samples that wait for the first time, for slower ports
_USUAL_GAP = 3.0  # longest gap that is interpolated, in periods, if none is configured


@dataclass(frozen=True)
class Estimated:
    joint: str  # liveJoint.name
    t: float  # time of the tick, as the sender counts it [s]
    outputs: Mapping[str, Any]  # values of the outputs GIVEN

    def shown(self) -> dict[str, Any]:
        """Returns outputs and intervals for JSON, which has no nan and no infinity."""
        values = dict(self.outputs)
        for name in BANDED:
            half = NORMAL_95 * values[f"{name}_std"]
            values[f"{name}_low"], values[f"{name}_high"] = values[name] - half, values[name] + half
        found: dict[str, Any] = finite(values)
        return found


class LivePort:
    """Samples of a port, from which the value of the port at the next tick is computed."""

    def __init__(self, name: str, port: Port, T: float, longest_gap: float) -> None:
        """T  time between ticks [s]; longest_gap  longest gap that is interpolated [s]"""
        self.port, self._T = port, T
        self._longest = longest_gap * (1 + AT_TICK)
        self._scale = scale(name, port)
        self.interpolated = 0  # number of interpolated ticks
        self.restart()

    def restart(self) -> None:
        self._before = -math.inf, math.nan
        self._next: deque[tuple[float, float]] = deque(maxlen=_MOST)
        self._last = math.nan
        self._jumps = 0.0

    def add(self, t: float, value: float) -> None:
        """Adds the next sample of the column; t is the time since the first tick [s]."""
        period = self.port.wrap
        if not math.isfinite(value):
            return
        if period is not None:
            if self._last == self._last:
                self._jumps -= round((value - self._last) / period)
            self._last = value
            value += period * self._jumps
        self._next.append((t - self.port.delay, (value - self.port.zero) * self._scale))

    def at(self, tick: int) -> float | None:
        """Returns the value at a tick, nan without a value; None if a later sample is needed.

        The ticks of successive calls must increase.
        """
        if self.port.value is not None:
            return self.port.value
        while self._next:
            t, value = self._next[0]
            position = t / self._T
            if abs(position - tick) <= AT_TICK:
                return value
            if position > tick:
                before, old = self._before
                if t - before > self._longest:
                    return math.nan
                self.interpolated += 1
                return float(np.interp(float(tick), (before / self._T, position), (old, value)))
            self._before = self._next.popleft()
        return None


class LiveJoint:
    """The estimator of one joint, and the samples that wait for its next tick."""

    def __init__(
        self, configuration: Configuration, clocks: dict[str, Clock], learned: Learned | None
    ) -> None:
        """clocks  by time column, "" for the time of arrival; missing clocks are added

        Raises the errors of result/replayed_log.py for a configuration or state that does not fit.
        """
        self.configuration, ports = configuration, configuration.ports
        self.name = configuration.joint or "joint"  # name for people and topics
        self._estimator = estimator_for(configuration, ("a", *GIVEN))
        (parameters,) = self._estimator.parameters
        configuration.need_ports(str(parameters["modality"]))
        self.T = float(parameters["samplePeriod"])
        self.longest_gap = configuration.time.longest_gap or _USUAL_GAP * self.T
        """Longest gap over which values are interpolated [s]."""
        self.ports = {n: LivePort(n, p, self.T, self.longest_gap) for n, p in ports.items()}
        if not any(port.column for port in ports.values()):
            raise LogError(
                f"{configuration.path}: expected a column for at least one port, found none"
            )
        unit = configuration.time.unit if configuration.time.column else "ns"
        for name in ("", *ports):
            clocks.setdefault(self.time_column(name), Clock(seconds(unit)))
        self._clocks = clocks
        self._logs = [*learned.logs] if learned else []
        self.skipped_of_all = 0  # ticks that were skipped, in all recordings
        if learned is not None:
            continue_from(learned, self._estimator, configuration.path)
        self._values = np.zeros(len(ports))  # of the ports at a tick
        self._begin()

    def _begin(self) -> None:
        self._start: float | None = None
        self._waiting: deque[tuple[LivePort, float, float]] = deque(maxlen=_WAITING)
        self._ticks = self._skipped = 0
        self._used: dict[str, tuple[float, float] | None] = {"phi": None, "setPoint": None}
        self._counter = _Counter(self.configuration)
        for port in self.ports.values():
            port.restart()

    def take(self, columns: Columns, times: Mapping[str, float]) -> Iterator[Estimated]:
        """Yields the estimates at all ticks that a new message allows to compute.

        times  values of the time columns in the message [s]
        """
        for name, port in self.ports.items():
            t, value = times.get(self.time_column(name)), columns.get(port.port.column)
            if t is not None and value is not None:
                self._waiting.append((port, t, value))
        if self._start is None:
            self._start = times.get(self.time_column(""))
        if self._start is None:
            return
        while self._waiting:
            port, t, value = self._waiting.popleft()
            port.add(t - self._start, value)
        yield from self._run(self._start, is_end=False)

    def time_column(self, port: str) -> str:
        """Returns the name of the column with the times of a port; "" for the time of arrival."""
        own = self.ports[port].port.time if port else None
        return own or self.configuration.time.column or ""

    def end(self, recording: Path, digest: str, learned: Path) -> Iterator[Estimated]:
        """Yields the last estimates of a recording, and writes the state of the estimator.

        recording, digest  recorded file and its SHA-256; learned  file for the state
        """
        if self._start is not None:
            yield from self._run(self._start, is_end=True)
        counts = self._ticks, self._skipped
        self._logs.append(LearnedLog(str(recording), digest, *counts, *self._used.values()))
        self.skipped_of_all += self._skipped
        self._begin()
        write_learned(self._estimator, self._logs, learned)

    def go_on(self) -> None:
        """Continues after the end of a recording; filters start again with the next sample."""
        self._estimator.restart_filters()

    def _run(self, start: float, is_end: bool) -> Iterator[Estimated]:
        clock = self._clocks[self.time_column("")]
        newest = max(self._clocks[self.time_column(each)].now for each in self.ports)
        while self._ticks <= (clock.now - start) / self.T + AT_TICK:
            for place, (name, port) in enumerate(self.ports.items()):
                value = port.at(self._ticks)
                if value is None:
                    at_tick = start + self._ticks * self.T + port.port.delay
                    # If other ports are far ahead, the tick no longer waits for this port.
                    patience = max(_PATIENCE, self.longest_gap * (1 + AT_TICK))
                    if not is_end and newest <= at_tick + patience:
                        return
                    self._clocks[self.time_column(name)].give_up(at_tick + AT_TICK * self.T)
                    value = math.nan
                self._values[place] = value
            yield self._tick(start + (clock.shift or 0) * clock.seconds)

    def _tick(self, start: float) -> Estimated:
        self._counter.put_right(self._values)
        values = dict(zip(self.ports, self._values.tolist(), strict=True))
        outputs = self._estimator.tick(**{name: values.get(name, 0.0) for name in PORTS})
        t = start + self.T * self._ticks
        self._ticks += 1
        self._skipped += not outputs["valid"]
        if outputs.pop("a") > 0 and outputs["valid"]:
            for name, used in self._used.items():
                low, high = used or (math.inf, -math.inf)
                self._used[name] = min(low, outputs[name]), max(high, outputs[name])
        return Estimated(self.name, t, outputs)


class _Counter:
    """Corrects a counter by whole periods after gaps and at the start, as for a log."""

    def __init__(self, configuration: Configuration) -> None:
        self._ports = configuration.ports
        self._most = configuration.parameters.get("range.phi")
        both, self._period = counter(self._ports)
        self._both = [list(self._ports).index(name) for name in both]  # the corrected port is first
        self._last: NDArray[Any] | None = None
        self._was_missing = False
        self._total = self._at_start = 0

    def put_right(self, values: NDArray[Any]) -> None:
        """values  of the ports at a tick, nan for a missing value; this array is changed"""
        if self._period == math.inf:
            return
        now = values[self._both]  # a copy
        is_known = bool(np.isfinite(now).all())
        if is_known:
            if self._last is None:
                if self._most is not None:
                    row, most = values.reshape(1, -1), float(self._most)
                    _, self._at_start = turns_from(0.0, most, row, self._ports)
            elif self._was_missing:
                step, other_step = now - self._last
                self._total += round((other_step - step) / self._period)
            self._last = now
        self._was_missing = not is_known
        for periods in (self._total, self._at_start):
            if periods:
                values[self._both[0]] += periods * self._period
