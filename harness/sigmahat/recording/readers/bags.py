"""Reads ROS 2 bags: a folder with SQLite or MCAP files, or one such file.

Every number of a message becomes a column, such as "/knee/angle.data". Elements of arrays have an
index, or in a sensor_msgs/JointState the name of the joint: "/joint_states.position[knee]". Arrays
of more than 256 elements and messages of more than 64 kB are no signals, and are left out. Each
topic has a column of times, such as "/joint_states.time", in seconds since the start of the bag.
Times are from the headers of the messages; without headers, times of the recording are used.
"""

import re
import struct
from collections import defaultdict
from collections.abc import Collection, Iterable
from contextlib import closing
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from sigmahat.fmi.quoted import cause, quoted
from sigmahat.recording.limits import check_bytes, check_columns, check_data
from sigmahat.recording.log import LogError, LogInMemory
from sigmahat.recording.readers.cdr import STAMP, CdrError, Decoder, Types

if TYPE_CHECKING:
    from sigmahat.recording.readers.bag_files import Topic

_LONGEST_DEFINITIONS = 1_000_000  # characters; a second or two to parse
_IDL_HEAD = re.compile(r"={80}\nIDL: .*\n")

_MAGIC = 8  # bytes at the beginning of an MCAP file
_RECORD = struct.Struct("<BQI")  # opcode and length of a record, length of its first text
_HEADER = 1  # opcode of the first record
_LONGEST_PROFILE = 1000  # bytes


@dataclass
class _Recorded:
    """The messages of a topic."""

    messages: list[bytes] = field(default_factory=list)
    times: list[int] = field(default_factory=list)  #: Of the recording [ns].


def read_bag(path: Path, wanted: Collection[str] | None = None) -> LogInMemory:
    """Reads a ROS 2 bag.

    wanted  columns, of whose topics alone the messages are read. If the bag lacks one of them, all
            topics are read, so that a message can name those that there are

    Raises LogError for a bag that is damaged, beyond the limits, or contains no numbers.
    """
    profile = _profile(path)
    if profile not in ("ros2", None):
        raise LogError(
            f"{path}: the messages of this MCAP file are not of ROS 2 (its profile is "
            f"{quoted(profile)}, expected 'ros2'); save them as CSV, a column for each number"
        )
    from rosbags.typesys import Stores, get_typestore

    from sigmahat.recording.readers.bag_files import BagFiles

    def is_wanted(topic: str) -> bool:
        return wanted is None or any(name.startswith(f"{topic}.") for name in wanted)

    topics: dict[Topic, _Recorded] = defaultdict(_Recorded)
    start, size = None, 0
    try:
        with closing(BagFiles(path, is_wanted).messages()) as messages:
            for topic, time, data in messages:
                start = time if start is None else min(start, time)
                if data is not None:
                    topics[topic].messages.append(data)
                    topics[topic].times.append(time)
                    size += len(data)
                    check_data(path, size)
    except LogError:
        raise
    except Exception as error:  # any: for a damaged file the libraries raise many kinds
        raise LogError(f"{path}: incomplete ROS 2 bag ({cause(error)}); copy it again") from error
    decoder = Decoder({**get_typestore(Stores.LATEST).fielddefs, **_types(path, topics)})
    arrays = _columns(path, topics, start or 0, decoder)
    if wanted is not None and not arrays.keys() >= set(wanted):
        return read_bag(path)
    if not arrays:
        raise LogError(f"{path}: expected messages with numbers, found none")
    return LogInMemory(path, arrays)


def _profile(path: Path) -> str | None:
    """Returns the profile in the first record of an MCAP file; None for any other file.

    A record has an opcode, its length, and its fields; the first field of the header is the profile
    (https://mcap.dev/spec#header-op0x01).
    """
    if path.is_dir():
        return None
    with path.open("rb") as file:
        begin = file.read(_MAGIC + _RECORD.size)
        if len(begin) < _MAGIC + _RECORD.size or not begin.startswith(b"\x89MCAP"):
            return None
        opcode, _, length = _RECORD.unpack_from(begin, _MAGIC)
        if opcode != _HEADER or length > _LONGEST_PROFILE:
            return None
        return file.read(length).decode("utf-8", errors="replace")


class _Columns:
    """The columns of a bag."""

    def __init__(self, path: Path, start: int) -> None:
        self.arrays: dict[str, NDArray[np.float64]] = {}
        self._path, self._start = path, start

    def add(self, topic: str, times: NDArray[np.int64]) -> None:
        """Adds the times of a topic: those of the headers where they are set."""
        seconds, nanoseconds = (self.arrays.pop(f"{topic}.{name}", None) for name in STAMP)
        if seconds is not None and nanoseconds is not None:
            has_stamp = (seconds > 0) | (nanoseconds > 0)  # not where it is nan
            stamps = seconds[has_stamp].astype(np.int64) * 1_000_000_000
            times[has_stamp] = stamps + nanoseconds[has_stamp].astype(np.int64)
        self.arrays[f"{topic}.time"] = (times - self._start) / 1e9

    def column(self, topic: str, rows: int, name: str) -> NDArray[np.float64]:
        """The column of a number of a topic; nan in messages without this number."""
        full_name = f"{topic}.{name}"
        if full_name not in self.arrays:
            check_columns(self._path, len(self.arrays) + 1)
            taken = sum(each.nbytes for each in self.arrays.values())
            check_bytes(self._path, taken + rows * np.dtype(np.float64).itemsize)
            self.arrays[full_name] = np.full(rows, np.nan)
        return self.arrays[full_name]


def _columns(
    path: Path, topics: dict["Topic", _Recorded], start: int, decoder: Decoder
) -> dict[str, NDArray[np.float64]]:
    """Reads the numbers of all topics, and removes the messages."""
    columns = _Columns(path, start)
    names = [topic.name for topic in topics]
    for topic in list(topics):
        if names.count(topic.name) > 1:
            raise LogError(
                f"{path}: expected messages of one type in {quoted(topic.name)}, got "
                f"{quoted(topic.type)} and others; record other topics"
            )
        recorded = topics.pop(topic)
        times = np.array(recorded.times, dtype=np.int64)
        order = np.argsort(times, kind="stable")  # the files of a bag need not be in order
        messages = [recorded.messages[i] for i in order]
        try:
            decoder.read(topic.type, messages, partial(columns.column, topic.name, len(messages)))
        except CdrError as error:
            raise LogError(
                f"{path}: messages of {quoted(topic.name)} cannot be read ({error}); "
                "copy the bag again, or record other topics"
            ) from error
        columns.add(topic.name, times[order])
    return columns.arrays


def _types(path: Path, topics: Iterable["Topic"]) -> Types:
    """The types of messages that these topics define."""
    from rosbags.typesys import get_types_from_idl, get_types_from_msg

    types: dict[str, Any] = {}
    length = 0
    for topic in topics:
        length += len(topic.definition)
        if length > _LONGEST_DEFINITIONS:
            raise LogError(
                f"{path}: expected at most {_LONGEST_DEFINITIONS} characters that define types of "
                "messages, got more; record fewer topics"
            )
        try:
            if topic.language == "ros2msg":
                types |= get_types_from_msg(topic.definition, topic.type)
            elif topic.language == "ros2idl":
                for part in _IDL_HEAD.split(topic.definition):
                    types |= get_types_from_idl(part) if part.strip() else {}
        except Exception as error:  # any: for a damaged definition rosbags raises many kinds
            raise LogError(
                f"{path}: the type {quoted(topic.type)} cannot be read "
                f"({cause(error)}); copy the bag again, or record other topics"
            ) from error
    return types
