"""Joint states in, estimates and diagnostics out.

A column of the configuration names topic, field and joint as in a bag:
"/joint_states.position[knee]"; "/joint_states.time" are the times of the topic [s], since the first
message. ROS_DOMAIN_ID and CYCLONEDDS_URI have their usual effect.
"""

from __future__ import annotations

import math
import os
import re
from collections.abc import Sequence
from functools import partial
from itertools import groupby
from typing import Any

from cyclonedds.core import (
    InstanceState,
    Policy,
    Qos,
    ReadCondition,
    SampleState,
    ViewState,
    WaitSet,
)
from cyclonedds.domain import DomainParticipant
from cyclonedds.pub import DataWriter
from cyclonedds.sub import DataReader
from cyclonedds.topic import Topic
from cyclonedds.util import duration

from sigmahat.live.joint import Estimated
from sigmahat.live.messages import Columns, number
from sigmahat.live.ros2.types import (
    DiagnosticArray,
    DiagnosticStatus,
    DynamicJointState,
    Header,
    InterfaceValue,
    JointState,
    KeyValue,
    Time,
)
from sigmahat.live.sinks import Sink
from sigmahat.live.sources import Inbox, Source

ESTIMATES, DIAGNOSTICS = "/sigmahat/estimates", "/diagnostics"
"""Topics that are written."""

_COLUMN = re.compile(r"(?P<topic>/[\w/]+)\.(?:time|(?:position|velocity|effort)\[.+\])")
_SECOND = 1_000_000_000
_RARELY = 1.0
"""Seconds between diagnostics."""
_OK, _WARN = 0, 1
_LARGEST_DOMAIN = 232
_AT_ONCE = 1000
_MOST_JOINTS = 1000
_INTERFACES = {
    "stiffness": "sigma",
    "stiffness_std": "sigma_std",
    "torque": "tau_e",
    "torque_std": "tau_e_std",
    "confident": "confident",
}
_WHOLE = Qos(Policy.Reliability.Reliable(duration(milliseconds=100)), Policy.History.KeepLast(100))
# Writers of either kind are heard.
_ANY = Qos(Policy.Reliability.BestEffort, Policy.History.KeepLast(1000))


class Ros2:
    """Topics in one domain."""

    def __init__(self) -> None:
        """In the domain of ROS_DOMAIN_ID. Raises ValueError if that is no number."""
        text = os.environ.get("ROS_DOMAIN_ID") or "0"
        if not text.isdecimal() or int(text) > _LARGEST_DOMAIN:
            raise ValueError(
                f"ROS_DOMAIN_ID: expected a number from 0 to {_LARGEST_DOMAIN}, got {text!r}"
            )
        self._domain = DomainParticipant(int(text))
        self._wanted: frozenset[str] = frozenset()
        self._first: int | None = None
        """Time of the first message [ns], from which the columns count."""

    def joint_states(self, columns: Sequence[str]) -> Source:
        """Reads the topics of columns. Raises ValueError for a column that names none."""
        self._wanted = frozenset(columns)
        readers: dict[str, Any] = {}
        for column in columns:
            found = _COLUMN.fullmatch(column)
            if found is None:
                raise ValueError(
                    f"column {column!r}: expected one such as /joint_states.position[knee], "
                    "/joint_states.effort[knee] or /joint_states.time"
                )
            name = found["topic"]
            if name not in readers:
                topic = Topic(self._domain, f"rt{name}", JointState)
                readers[name] = DataReader(self._domain, topic, qos=_ANY)

        def read(inbox: Inbox) -> None:
            wake = WaitSet(self._domain)
            state = SampleState.Any | ViewState.Any | InstanceState.Any
            conditions = [ReadCondition(each, state) for each in readers.values()]
            for each in conditions:
                wake.attach(each)
            while True:
                wake.wait(duration(seconds=1))
                for name, reader in readers.items():
                    for message in reader.take(N=_AT_ONCE):
                        if isinstance(message, JointState):  # not the end of a writer
                            inbox.put(partial(self._columns, name, message), can_wait=False)

        return read

    def _columns(self, topic: str, message: JointState) -> Columns:
        """The numbers of a message by column.

        Raises ValueError for one without a stamp, or with other numbers of names and values.
        """
        stamp = message.header.stamp.sec * _SECOND + message.header.stamp.nanosec
        if not stamp:
            raise ValueError(f"{topic}: expected a time in the header, got 0")
        if self._first is None:
            self._first = stamp
        found: dict[str, int | float] = {f"{topic}.time": (stamp - self._first) / _SECOND}
        names = message.name
        if len(names) > _MOST_JOINTS:
            raise ValueError(f"{topic}: expected at most {_MOST_JOINTS} names, got {len(names)}")
        for field in ("position", "velocity", "effort"):
            values = getattr(message, field)
            if len(values) not in (0, len(names)):
                raise ValueError(
                    f"{topic}.{field}: expected {len(names)} values, got {len(values)}"
                )
            for name, value in zip(names, values, strict=False):
                column = f"{topic}.{field}[{name}]"
                if column in self._wanted:
                    found[column] = number(column, value)
        return found

    def publish(self) -> Sink:
        """Writes the estimates of each tick, and the doubts once a second."""
        estimates = self._writer(ESTIMATES, DynamicJointState)
        diagnostics = self._writer(DIAGNOSTICS, DiagnosticArray)
        said = -math.inf

        def send(ticks: Sequence[Estimated]) -> None:
            nonlocal said
            for t, each in groupby(ticks, key=lambda tick: tick.t):
                at_once = list(each)
                header = _header(t, self._first or 0)
                names = [tick.name for tick in at_once]
                estimates.write(DynamicJointState(header, names, [_values(e) for e in at_once]))
                if abs(t - said) >= _RARELY:
                    said = t
                    diagnostics.write(DiagnosticArray(header, [_status(e) for e in at_once]))

        return send

    def _writer(self, name: str, kind: type[Any]) -> Any:
        return DataWriter(self._domain, Topic(self._domain, f"rt{name}", kind), qos=_WHOLE)


def _header(t: float, first: int) -> Header:
    seconds, rest = divmod(max(round(t * _SECOND) + first, 0), _SECOND)
    return Header(Time(seconds % 2**31, rest), "")


def _values(tick: Estimated) -> InterfaceValue:
    return InterfaceValue(
        list(_INTERFACES), [float(tick.outputs[name]) for name in _INTERFACES.values()]
    )


def _status(tick: Estimated) -> DiagnosticStatus:
    is_ok = bool(tick.outputs["confident"])
    text = "confident" if is_ok else f"not confident: {tick.outputs['doubt']}"
    values = [
        KeyValue(f"{name} [{unit}]" if unit else name, f"{tick.outputs[name]:.6g}")
        for name, unit in (("sigma", "N.m/rad"), ("sigma_std", "N.m/rad"), ("misfit", ""))
    ]
    name = f"sigmahat: stiffness of {tick.name}"
    return DiagnosticStatus(_OK if is_ok else _WARN, name, text, "", values)
