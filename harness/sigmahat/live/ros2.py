"""Topics of ROS 2 over DDS, without an installation of ROS: joint states in, estimates and
diagnostics out.

A column of the configuration names topic, field and joint as in a bag,
"/joint_states.position[knee]". "/joint_states.time" is the time of the topic [s], since the first
message. ROS_DOMAIN_ID and CYCLONEDDS_URI have their usual effect.
"""

import math
import os
import re
from collections.abc import Iterator, Sequence
from contextlib import suppress
from functools import partial
from itertools import groupby
from typing import Any

from cyclonedds import core
from cyclonedds.core import Policy, Qos
from cyclonedds.domain import DomainParticipant
from cyclonedds.idl import make_idl_struct
from cyclonedds.idl.types import byte, float64, int32, sequence, uint32
from cyclonedds.pub import DataWriter
from cyclonedds.sub import DataReader
from cyclonedds.topic import Topic
from cyclonedds.util import duration

from sigmahat.live.events import Event
from sigmahat.live.live_joint import NO_DATA, Estimated, News
from sigmahat.live.loop import Inbox, Sink, Source
from sigmahat.live.messages import Columns, number

ESTIMATES, DIAGNOSTICS = "/sigmahat/estimates", "/diagnostics"  # topics that are written

_COLUMN = re.compile(r"(?P<topic>/[\w/]+)\.(?:time|(?:position|velocity|effort)\[.+\])")
_SECOND = 1_000_000_000
_RARELY = 1.0  # [s] between diagnostics
_OK, _WARN, _STALE = 0, 1, 3  # levels of diagnostic_msgs/DiagnosticStatus
_LARGEST_DOMAIN, _MOST_JOINTS, _AT_ONCE = 232, 1000, 1000
# The library keeps as many messages as a reader asks for, of any size unless it is told.
_LIMITS = "<Internal><MaxSampleSize>128 kB</MaxSampleSize></Internal>"
_INTERFACES = {
    "stiffness": "sigma",
    "stiffness_std": "sigma_std",
    "torque": "tau_e",
    "torque_std": "tau_e_std",
    "confident": "confident",
}
# No estimate waits for a reader that does not keep up.
_WHOLE = Qos(Policy.Reliability.Reliable(duration(seconds=0)), Policy.History.KeepLast(100))
# Readers accept messages of reliable and of best-effort writers.
_ANY = Qos(Policy.Reliability.BestEffort, Policy.History.KeepLast(1000))


def _type(ros: str, **fields: Any) -> Any:
    """Creates the DDS type of a message from its ROS 2 name, such as "package/Name"."""
    package, _, name = ros.partition("/")
    return make_idl_struct(name, f"{package}::msg::dds_::{name}_", fields)


_list_of: Any = sequence  # generic, but not for the type checker
_Time = _type("builtin_interfaces/Time", sec=int32, nanosec=uint32)
_Header = _type("std_msgs/Header", stamp=_Time, frame_id=str)
_fields = dict.fromkeys(("position", "velocity", "effort"), _list_of[float64])
_JointState = _type("sensor_msgs/JointState", header=_Header, name=_list_of[str], **_fields)
_Interfaces = _type(
    "control_msgs/InterfaceValue", interface_names=_list_of[str], values=_list_of[float64]
)
_lists = {"joint_names": _list_of[str], "interface_values": _list_of[_Interfaces]}
_DynamicJointState = _type("control_msgs/DynamicJointState", header=_Header, **_lists)
_KeyValue = _type("diagnostic_msgs/KeyValue", key=str, value=str)
_texts = dict.fromkeys(("name", "message", "hardware_id"), str)
_Status = _type(
    "diagnostic_msgs/DiagnosticStatus", level=byte, **_texts, values=_list_of[_KeyValue]
)
_Diagnostics = _type("diagnostic_msgs/DiagnosticArray", header=_Header, status=_list_of[_Status])


class Ros2:
    def __init__(self) -> None:
        """Joins the domain of ROS_DOMAIN_ID. Raises ValueError if this variable is no number."""
        text = os.environ.get("ROS_DOMAIN_ID") or "0"
        if not text.isdecimal() or int(text) > _LARGEST_DOMAIN:
            raise ValueError(
                f"ROS_DOMAIN_ID: expected a number from 0 to {_LARGEST_DOMAIN}, got {text!r}"
            )
        # The settings of the user come later, so they win.
        own = os.environ.get("CYCLONEDDS_URI")
        os.environ["CYCLONEDDS_URI"] = f"{_LIMITS},{own}" if own else _LIMITS
        self._domain = DomainParticipant(int(text))
        self._wanted: frozenset[str] = frozenset()
        self._first: int | None = None  # time of the first message [ns], zero of the columns

    def joint_states(self, columns: Sequence[str]) -> Source:
        """Reads the topics of columns. Raises ValueError for a column that names no topic."""
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
                topic = Topic(self._domain, f"rt{name}", _JointState)
                readers[name] = DataReader(self._domain, topic, qos=_ANY)

        def read(inbox: Inbox) -> None:
            wake = core.WaitSet(self._domain)
            state = core.SampleState.Any | core.ViewState.Any | core.InstanceState.Any
            conditions = [core.ReadCondition(each, state) for each in readers.values()]
            for each in conditions:
                wake.attach(each)
            while True:
                wake.wait(duration(seconds=1))
                for name, reader in readers.items():
                    for message in _messages(reader):
                        columns = partial(self._columns, name, message)
                        inbox.add(columns, _memory(message), can_wait=False)

        return read

    def _columns(self, topic: str, message: Any) -> Columns:
        """Returns the numbers of a JointState message by column.

        Raises ValueError for a message without a stamp, unequal numbers of names and values, and
        an error in place of a message.
        """
        if isinstance(message, Exception):
            raise ValueError(f"{topic}: expected a JointState, got {message}") from message
        stamp = message.header.stamp.sec * _SECOND + message.header.stamp.nanosec
        if not stamp:
            raise ValueError(f"{topic}: expected a time in the header, got 0")
        if self._first is None:
            self._first = stamp
        found: dict[str, int | float] = {f"{topic}.time": (stamp - self._first) / _SECOND}
        names = message.name
        if len(names) > _MOST_JOINTS:
            raise ValueError(f"{topic}: expected at most {_MOST_JOINTS} names, got {len(names)}")
        for field in _fields:
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
        estimates, diagnostics = (
            DataWriter(self._domain, Topic(self._domain, f"rt{name}", kind), qos=_WHOLE)
            for name, kind in ((ESTIMATES, _DynamicJointState), (DIAGNOSTICS, _Diagnostics))
        )
        said = -math.inf

        def send(news: Sequence[News]) -> None:
            nonlocal said
            for event in (each for each in news if isinstance(each, Event)):
                status = _status_of_event(event)
                _write(diagnostics, _Diagnostics(self._header(event.t), [status]))
            ticks = [each for each in news if isinstance(each, Estimated)]
            for t, group in groupby(ticks, key=lambda tick: tick.t):
                at_once = list(group)
                header = self._header(t)
                values = [_values(each) for each in at_once]
                interfaces = [_Interfaces(list(each), list(each.values())) for each in values]
                names = [each.joint for each in at_once]
                _write(estimates, _DynamicJointState(header, names, interfaces))
                if abs(t - said) >= _RARELY:
                    said = t
                    _write(diagnostics, _Diagnostics(header, [_status(e) for e in at_once]))

        return send

    def _header(self, t: float) -> Any:
        seconds, rest = divmod(max(round(t * _SECOND) + (self._first or 0), 0), _SECOND)
        return _Header(_Time(seconds % 2**31, rest), "")


def _messages(reader: Any) -> Iterator[Any]:
    """Yields the messages that wait, and an error in place of each that cannot be decoded.

    They are taken one by one: the library would lose all messages that it takes with a bad one.
    """
    for _ in range(_AT_ONCE):
        try:
            taken = reader.take()
        except core.DDSException:
            raise
        except Exception as error:  # a decoder fails in many ways, such as on names not in UTF-8
            yield error
            continue
        if not taken:
            return
        if isinstance(taken[0], _JointState):  # not the end of a writer
            yield taken[0]


def _memory(message: Any) -> int:
    """Returns about the memory of a JointState message, or of an error in its place [bytes]."""
    if isinstance(message, Exception):
        return 0
    numbers = sum(len(getattr(message, field)) for field in _fields)
    return 32 * numbers + sum(64 + len(name) for name in message.name)


def _write(writer: Any, message: Any) -> None:
    """Sends a message. It is lost if a reader does not keep up, which must not stop the others."""
    with suppress(core.DDSException):
        writer.write(message)


def _values(tick: Estimated) -> dict[str, float]:
    """Values of the interfaces of a joint, by name."""
    values = {name: float(tick.outputs[output]) for name, output in _INTERFACES.items()}
    return {**values, "data_age": tick.data_age}


def _status(tick: Estimated) -> Any:
    is_ok = bool(tick.outputs["confident"])
    level = _STALE if tick.outputs["doubt"] == NO_DATA else _OK if is_ok else _WARN
    values = [
        _KeyValue(key, f"{tick.outputs[key.partition(' ')[0]]:.6g}")
        for key in ("sigma [N.m/rad]", "sigma_std [N.m/rad]", "misfit")
    ]
    values.append(_KeyValue("data_age [s]", f"{tick.data_age:.6g}"))
    name = f"sigmahat: stiffness of {tick.joint}"
    return _Status(level, name, tick.in_words, "", values)


def _status_of_event(event: Event) -> Any:
    values = [_KeyValue(key, str(value)) for key, value in event.shown().items() if key != "text"]
    level = _WARN if event.is_warning else _OK
    return _Status(level, "sigmahat: events", event.in_words, "", values)
