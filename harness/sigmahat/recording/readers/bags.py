"""Reads ROS 2 bags: a folder with SQLite or MCAP files, or one MCAP file.

Every number of a message becomes a column, such as "/knee/angle.data". Elements of arrays have an
index, or in a sensor_msgs/JointState the name of the joint: "/joint_states.position[knee]". Each
topic has a column of times, such as "/joint_states.time", in seconds since the start of the bag.
Times are from the headers of the messages; without headers, times of the recording are used.
"""

import struct
from collections import defaultdict
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from sigmahat.recording.log import LogError, LogInMemory

_MAGIC = 8  # bytes at the beginning of an MCAP file
_RECORD = struct.Struct("<BQI")  # opcode and length of a record, length of its first text
_HEADER = 1  # opcode of the first record
_LONGEST_PROFILE = 1000  # bytes


def read_bag(path: Path) -> LogInMemory:
    """Reads a ROS 2 bag. Raises LogError for a bag that is damaged or contains no numbers."""
    profile = _profile(path)
    if profile not in ("ros2", None):
        raise LogError(
            f"{path}: the messages of this MCAP file are not of ROS 2 (its profile is {profile!r}, "
            "expected 'ros2'); save them as a CSV file, one column for each number"
        )
    from rosbags.highlevel import AnyReader, AnyReaderError
    from rosbags.typesys import Stores, get_typestore

    values: dict[str, list[float]] = defaultdict(list)
    stamps: dict[str, list[int]] = defaultdict(list)
    try:
        typestore = get_typestore(Stores.LATEST)
        with AnyReader([path], default_typestore=typestore) as reader:
            start = reader.start_time
            for connection, recorded, raw in reader.messages():
                message = reader.deserialize(raw, connection.msgtype)
                topic = connection.topic
                stamp = _stamp(message)
                row = len(stamps[topic])
                stamps[topic].append(recorded if stamp is None else stamp)
                for name, number in _numbers(message):
                    column = values[f"{topic}.{name}"]
                    column.extend([np.nan] * (row - len(column)))  # messages without this number
                    column.append(number)
    except (AnyReaderError, OSError, ValueError, KeyError, AssertionError) as error:
        raise LogError(f"{path}: incomplete ROS 2 bag ({error}); copy it again") from error
    if not values:
        raise LogError(f"{path}: expected messages with numbers, found none")
    arrays = {}
    for topic, times in stamps.items():
        arrays[f"{topic}.time"] = (np.array(times, dtype=np.int64) - start) / 1e9
        for name, column in values.items():
            if name.startswith(f"{topic}."):
                column.extend([np.nan] * (len(times) - len(column)))
                arrays[name] = np.array(column)
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


def _stamp(message: Any) -> int | None:
    """Returns the time in the header of a message [ns]; None without a header or a set time."""
    stamp = getattr(getattr(message, "header", None), "stamp", None)
    if stamp is None:
        return None
    return int(stamp.sec) * 1_000_000_000 + int(stamp.nanosec) or None


def _numbers(message: Any, above: str = "") -> Iterator[tuple[str, float]]:
    """Yields path and value of each number in a message, without the header of the message."""
    names = getattr(message, "name", None)
    for field, value in vars(message).items():
        if field in ("header", "layout") or field.startswith("__"):
            continue
        if isinstance(value, (bool, int, float, np.number)):
            yield f"{above}{field}", float(value)
        elif isinstance(value, np.ndarray) and value.dtype.kind in "biuf":
            labels = names if isinstance(names, list) and len(names) == len(value) else None
            for i, number in enumerate(value.tolist()):
                yield f"{above}{field}[{labels[i] if labels else i}]", float(number)
        elif hasattr(value, "__dataclass_fields__"):
            yield from _numbers(value, f"{above}{field}.")
