"""Runs the estimator of one joint on line, with samples at the ticks of the estimator.

The values at the ticks come from recording/resampling.py and recording/counters.py, as for a log.
"""

import math
from collections import deque
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from sigmahat.files.output import finite
from sigmahat.live.changes import ChangesOnLine
from sigmahat.live.clock import Clock
from sigmahat.live.events import Event, PositionJumped, in_seconds
from sigmahat.live.jumps import Jumps
from sigmahat.live.limits import Limits
from sigmahat.live.messages import Columns
from sigmahat.recording.configuration import INPUTS, Configuration
from sigmahat.recording.counters import WholePeriods
from sigmahat.recording.deformation import with_positions
from sigmahat.recording.estimator_parameters import all_parameters
from sigmahat.recording.log import LogError
from sigmahat.recording.replay import estimator_for
from sigmahat.recording.resampling import AT_TICK, PortSamples, usual_gap, with_tolerance
from sigmahat.recording.units import seconds
from sigmahat.result.curve import NORMAL_95
from sigmahat.result.learned import Learned, continue_from, write_learned
from sigmahat.result.stored import LearnedLog

OUTPUTS = ("sigma", "sigma_std", "tau_e", "tau_e_std", "phi", "setPoint", "misfit", "change_age")
"""Real outputs that are sent to the sinks."""
_FLAGS = ("confident", "valid")
GIVEN = (*OUTPUTS, *_FLAGS, "doubt")  # all outputs that are sent to the sinks
NO_DATA = "NoData"  # value of doubt while a joint has no data; the estimator has no such item
JUMPED = "PositionJumped"  # value of doubt while a position is not where it was before a jump
BANDED = ("sigma", "tau_e")  # outputs whose 95 % intervals are sent, too: sigma_low, ...
_PATIENCE = 0.2  # [s] a tick waits for a port without samples while other ports have some
_WAITING, _MOST = 1000, 10_000  # most samples that wait for the first time, for slower ports


@dataclass(frozen=True)
class Estimated:
    joint: str  # liveJoint.name
    t: float  # time of the tick, as the sender counts it [s]
    outputs: Mapping[str, Any]  # values of the outputs GIVEN
    data_age: float = 0.0  # [s] since the last tick with data, if the joint is silent, else 0

    def without_data(self, t: float, age: float) -> "Estimated":
        """Returns this estimate for a later time t [s], age seconds after the last data.

        What was learned stays, but nobody knows whether it is still true.
        """
        outputs = {**self.outputs, "confident": False, "valid": False, "doubt": NO_DATA}
        return replace(self, t=t, outputs=outputs, data_age=age)

    @property
    def in_words(self) -> str:
        """Whether the estimate can be trusted, and why not."""
        doubt = self.outputs["doubt"]
        if doubt == NO_DATA:
            return f"no data for {in_seconds(self.data_age)}"
        return "confident" if doubt == "None" else f"not confident ({doubt})"

    def shown(self) -> dict[str, Any]:
        """Returns outputs and intervals for JSON, which has no nan and no infinity."""
        values = {**self.outputs, "data_age": self.data_age}
        for name in BANDED:
            half = NORMAL_95 * values[f"{name}_std"]
            values[f"{name}_low"], values[f"{name}_high"] = values[name] - half, values[name] + half
        found: dict[str, Any] = finite(values)
        return found


News = Estimated | Event  # what the sinks are told


class LiveJoint:
    """The estimator of one joint, and the samples that wait for its next tick."""

    def __init__(
        self,
        configuration: Configuration,
        clocks: dict[str, Clock],
        learned: Learned | None,
        limits: Limits | None = None,
    ) -> None:
        """clocks  by time column, "" for the time of arrival; missing clocks are added

        Raises the errors of result/replayed_log.py for a configuration or state that does not fit.
        """
        self.configuration, ports = configuration, configuration.ports
        self.name = configuration.joint or "joint"  # name for people and topics
        of_results = configuration.joint or configuration.path.stem  # name in the results
        self._limit = None if limits is None else limits.of(of_results, configuration.path)
        parameters = all_parameters(configuration)
        self.T = float(parameters["samplePeriod"])
        self._changes = ChangesOnLine(self.name, parameters, self.T)
        self._estimator = estimator_for(configuration, ("a", *GIVEN, *self._changes.names))
        configuration.need_ports(str(parameters["modality"]))
        self.longest_gap = configuration.time.longest_gap or usual_gap(self.T)
        """Longest gap over which values are interpolated [s]."""
        self.ports = {
            name: PortSamples(name, port, self.T, self.longest_gap) for name, port in ports.items()
        }
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
        self._waiting: deque[tuple[PortSamples, float, float]] = deque(maxlen=_WAITING)
        self._ticks = self._skipped = 0
        self._used: dict[str, tuple[float, float] | None] = {"phi": None, "setPoint": None}
        self._whole_periods = WholePeriods.of(self.configuration)
        self._jumps = {name: Jumps(self.T) for name in ("theta", "q")}
        self._jumps_told: set[str] = set()
        for port in self.ports.values():
            port.restart()

    @property
    def columns(self) -> list[str]:
        """Columns of the messages that this joint uses, with those of the times; "" for arrival."""
        times = [self.time_column(each) for each in ("", *self.ports)]
        values = [each.port.column for each in self.ports.values() if each.port.column]
        return list(dict.fromkeys([*times, *values]))

    def take(self, columns: Columns, times: Mapping[str, float]) -> Iterator[News]:
        """Yields estimates and events at all ticks that a new message allows to compute.

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

    def end(self, recorded: tuple[Path, str] | None) -> Iterator[News]:
        """Yields the last news before a restart, or the end, of the sender.

        recorded  recorded file and its SHA-256; None: nothing was recorded
        """
        if self._start is not None:
            yield from self._run(self._start, is_end=True)
        if recorded is not None:
            file, digest = recorded
            counts = self._ticks, self._skipped
            self._logs.append(LearnedLog(str(file), digest, *counts, *self._used.values()))
        self.skipped_of_all += self._skipped
        self._begin()

    def write_learned(self, file: Path) -> None:
        """Writes the state of the estimator. Raises OSError if the file cannot be written."""
        write_learned(self._estimator, self._logs, file)

    def go_on(self) -> None:
        """Continues after the end of a recording; filters start again with the next sample."""
        self._estimator.restart_filters()

    def _run(self, start: float, is_end: bool) -> Iterator[News]:
        clock = self._clocks[self.time_column("")]
        newest = max(self._clocks[self.time_column(each)].now for each in self.ports)
        while self._ticks <= (clock.now - start) / self.T + AT_TICK:
            for place, (name, port) in enumerate(self.ports.items()):
                value = port.value_at(self._ticks)
                if value is None:
                    at_tick = start + self._ticks * self.T + port.port.delay
                    # If other ports are far ahead, the tick no longer waits for this port.
                    patience = max(_PATIENCE, with_tolerance(self.longest_gap))
                    if not is_end and newest <= at_tick + patience:
                        return
                    self._clocks[self.time_column(name)].give_up(at_tick + AT_TICK * self.T)
                    value = math.nan
                self._values[place] = value
            yield from self._tick(start + (clock.shift or 0) * clock.seconds)

    def _tick(self, start: float) -> Iterator[News]:
        if self._whole_periods is not None:
            self._whole_periods.put_right_one(self._values)
        values = with_positions(dict(zip(self.ports, self._values.tolist(), strict=True)))
        outputs = self._estimator.tick(**{name: values.get(name, 0.0) for name in INPUTS})
        t = start + self.T * self._ticks
        self._ticks += 1
        self._skipped += not outputs["valid"]
        if outputs["a"] > 0 and outputs["valid"]:
            for name, used in self._used.items():
                low, high = used or (math.inf, -math.inf)
                self._used[name] = min(low, outputs[name]), max(high, outputs[name])
        given = {name: outputs[name] for name in GIVEN}
        has_data = outputs["valid"] or outputs["doubt"] == "Outlier"
        yield from self._jumped(t, values if has_data else {})
        if any(each.offset for each in self._jumps.values()):
            # Nobody knows what the estimator learns now; a change would be one of the values.
            yield Estimated(self.name, t, given | {"confident": False, "doubt": JUMPED})
            return
        yield Estimated(self.name, t, given)
        if (change := self._changes.add(t, outputs)) is not None:
            yield change
        if self._limit is not None and outputs["confident"]:
            passed = self._limit.add(t - start, self.name, self._estimator, self._used)
            if passed is not None:
                yield replace(passed, t=t)

    def _jumped(self, t: float, values: Mapping[str, float]) -> Iterator[Event]:
        """Yields the first jump of each position: failed readings may jump often.

        values  of the ports; none at a tick without data, before which no position counts
        """
        for name, jumps in self._jumps.items():
            usual, jump = jumps.largest, jumps.add(values.get(name, math.nan))
            if jump and name not in self._jumps_told:
                self._jumps_told.add(name)
                yield PositionJumped(t=t, joint=self.name, port=name, jump=jump, usual=usual)
