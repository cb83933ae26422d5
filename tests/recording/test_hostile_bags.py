"""Bags of strangers: other files, endless queries, bombs; and what a usual bag leaves out."""

import os
import sqlite3
import struct
import time
from collections.abc import Callable, Iterator
from contextlib import closing
from pathlib import Path
from typing import Any

import lz4.frame
import numpy as np
import pytest
import zstandard
from rosbags.interfaces import Nodetype
from rosbags.typesys import Stores, get_typestore

from sigmahat.recording.log import LogError
from sigmahat.recording.readers.bag_files import BagFiles  # noqa: F401  so that times are without imports
from sigmahat.recording.readers.cdr import Decoder
from sigmahat.recording.readers.formats import open_log
from small_bags import FLOAT, mcap_bag, sqlite_bag

METADATA = "rosbag2_bagfile_information:\n  relative_file_paths:\n    - {}\n"


def refusal(path: Path) -> str:
    """The one line that refuses a log, which must come soon."""
    begin = time.process_time()
    with pytest.raises(LogError) as caught:
        open_log(path)
    assert time.process_time() - begin < 2
    text = str(caught.value)
    assert "\n" not in text and len(text) < 400 + len(str(path))
    return text


@pytest.mark.parametrize(
    "name", ["..%2Fsecret%2Fother.db3", "../secret/other.db3", "%2e%2e/other.db3", "other.db3"]
)
def test_no_file_outside_of_the_folder_of_a_bag_is_opened(name: str, tmp_path: Path) -> None:
    """GIVEN a bag that names another file, or has a link to it, THEN its values do not come out."""
    sqlite_bag(tmp_path / "secret" / "other.db3")
    bag = tmp_path / "bag"
    bag.mkdir()
    (bag / "metadata.yaml").write_text(METADATA.format(f"'{name}'"))
    (bag / "..%2Fsecret%2Fother.db3").write_bytes(b"not the secret")
    if name == "other.db3":
        (bag / name).symlink_to("../secret/other.db3")
    assert any(
        word in refusal(bag)
        for word in ("lies in another folder", "is missing", "expected SQLite or MCAP")
    )


@pytest.mark.parametrize("folder", ["a#b", "a?b", "a%41b", "a b", "a%2Fb"])
@pytest.mark.parametrize("whole", [True, False])
def test_folders_with_characters_of_addresses(folder: str, whole: bool, tmp_path: Path) -> None:
    if os.name == "nt" and "?" in folder:
        pytest.skip("no such name")
    sqlite_bag(tmp_path / folder / "b#%41.db3")
    (tmp_path / folder / "metadata.yaml").write_text(METADATA.format("'b#%41.db3'"))
    log = open_log(tmp_path / folder if whole else tmp_path / folder / "b#%41.db3")
    assert list(log.read("/a.data")) == [2.5, 2.5] and list(log.read("/a.time")) == [0, 1]


ENDLESS = "WITH RECURSIVE c(x) AS (SELECT 1 UNION ALL SELECT x + 1 FROM c)"


@pytest.mark.parametrize(
    "messages",
    [
        f"CREATE VIEW messages AS {ENDLESS} SELECT 1 topic_id, x timestamp, x'00' data FROM c",
        f"CREATE VIEW messages AS {ENDLESS} SELECT x topic_id, x timestamp, x FROM c WHERE x < 0",
        "CREATE VIEW messages AS SELECT 1 topic_id, 1 timestamp, zeroblob(900000000) data",
        "CREATE VIRTUAL TABLE messages USING fts5(topic_id, timestamp, data)",
        "CREATE TABLE messages(topic_id, timestamp, d, data AS (zeroblob(900000000)))",
    ],
)
def test_only_tables_are_read(messages: str, tmp_path: Path) -> None:
    try:
        with closing(sqlite3.connect(tmp_path / "a.db3")) as database:
            database.execute("CREATE TABLE topics(id, name, type, serialization_format)")
            database.execute("INSERT INTO topics VALUES(1, '/a', 'std_msgs/msg/Float64', 'cdr')")
            database.execute(messages)
            if "TABLE" in messages:
                database.execute("INSERT INTO messages(topic_id, timestamp) VALUES(1, 1)")
            database.commit()
    except sqlite3.OperationalError:
        pytest.skip("this SQLite lacks it")
    assert "ROS 2 bag" in refusal(tmp_path / "a.db3") or "found none" in refusal(tmp_path / "a.db3")


@pytest.mark.parametrize(
    "definition",
    [
        "string[300000] a",
        "C[300000] a\n" + "=" * 80 + "\nMSG: a/C\nstring b",
        "B a",
        "C a\n" + "=" * 80 + "\nMSG: a/C\nB b",
        "uint8 A=" + "9" * 5000,
        "wstring a",
        "Unknown a",
        "float64 a\n" * 200_000,
        "[" * 5000,
    ],
)
def test_types_that_take_memory_and_time(definition: str, tmp_path: Path) -> None:
    mcap_bag(tmp_path / "a.mcap", b"\0\1\0\0" + bytes(200), definition)
    assert "type" in refusal(tmp_path / "a.mcap") or "'/a'" in refusal(tmp_path / "a.mcap")


def test_elements_of_one_byte_take_no_time(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """GIVEN sequences of messages of one byte, with other lengths, THEN reading them ends."""
    monkeypatch.setattr("sigmahat.recording.readers.cdr._STEPS", 500)
    definition = "C[] a\n" + "=" * 80 + "\nMSG: a/C\nuint8 b"
    mcap_bag(tmp_path / "a.mcap", b"\0\1\0\0" + struct.pack("<I", 999) + bytes(999), definition)
    assert "too many forms or parts" in refusal(tmp_path / "a.mcap")


def chunk(compression: bytes, data: bytes, size: int) -> bytes:
    """An MCAP file of one chunk.

    size  number of bytes that the chunk declares
    """
    head = struct.pack("<QQQI", 0, 1, size, 0)
    body = head + struct.pack("<I", len(compression)) + compression + struct.pack("<Q", len(data))
    body += data
    magic, end = b"\x89MCAP0\r\n", b"\x0f" + struct.pack("<QI", 4, 0)
    return magic + b"\x06" + struct.pack("<Q", len(body)) + body + end


@pytest.mark.parametrize(
    ("compression", "pack"),
    [(b"zstd", zstandard.ZstdCompressor().compress), (b"lz4", lz4.frame.compress)],
)
@pytest.mark.parametrize("declared", [1000, 300_000_000])
def test_a_chunk_that_is_a_bomb(
    compression: bytes, pack: Callable[[bytes], bytes], declared: int, tmp_path: Path
) -> None:
    """GIVEN many zeros in a chunk, THEN no more is unpacked than it declares and may have."""
    (tmp_path / "a.mcap").write_bytes(chunk(compression, pack(bytes(5_000_000)), declared))
    assert "chunk" in refusal(tmp_path / "a.mcap")


def test_many_columns(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """GIVEN a JointState with other names in every message, THEN the columns are limited."""
    monkeypatch.setattr("sigmahat.recording.limits.MOST_COLUMNS", 20)
    store = get_typestore(Stores.ROS2_HUMBLE)
    types = store.types
    header = types["std_msgs/msg/Header"](types["builtin_interfaces/msg/Time"](1, 0), "")
    state = types["sensor_msgs/msg/JointState"]
    with closing(sqlite3.connect(tmp_path / "a.db3")) as database:
        sqlite_bag(tmp_path / "a.db3", type_name="sensor_msgs/msg/JointState", data=FLOAT)
        database.execute("DELETE FROM messages")
        for k in range(21):
            message = state(header, [f"j{k}"], np.array([1.0]), np.array([]), np.array([]))
            data = bytes(store.serialize_cdr(message, "sensor_msgs/msg/JointState"))
            database.execute("INSERT INTO messages VALUES(NULL, 1, ?, ?)", (k, data))
        database.commit()
    assert "at most 20 columns" in refusal(tmp_path / "a.db3")


TYPES = [
    "sensor_msgs/msg/JointState",
    "sensor_msgs/msg/Imu",
    "sensor_msgs/msg/Joy",
    "sensor_msgs/msg/BatteryState",
    "geometry_msgs/msg/WrenchStamped",
    "geometry_msgs/msg/PolygonStamped",
    "control_msgs/msg/JointJog",
    "std_msgs/msg/Float64MultiArray",
    "diagnostic_msgs/msg/DiagnosticArray",
    "tf2_msgs/msg/TFMessage",
    "rcl_interfaces/msg/ParameterValue",
    "std_msgs/msg/Empty",
]


@pytest.mark.parametrize("little", [True, False])
def test_the_numbers_are_those_that_rosbags_reads(little: bool) -> None:
    """GIVEN messages of many types and lengths, THEN the columns have the values of rosbags."""
    store, random = get_typestore(Stores.LATEST), np.random.default_rng(1)
    for name in TYPES:
        if name not in store.types:
            continue
        messages = [_drawn(store, name, random) for _ in range(12)]
        raw = [bytes(store.serialize_cdr(each, name, little_endian=little)) for each in messages]
        columns: dict[str, np.ndarray] = {}

        def column(key: str, found: dict[str, np.ndarray] = columns) -> np.ndarray:
            return found.setdefault(key, np.full(12, np.nan))

        Decoder(store.fielddefs).read(name, raw, column)
        expected = [dict(_numbers(each)) for each in messages]
        for row, values in enumerate(expected):
            found = {key: column[row] for key, column in columns.items()}
            found = {k: v for k, v in found.items() if not np.isnan(v) and k[:7] != "header."}
            assert found == pytest.approx(values, rel=0, abs=0), name


def _drawn(store: Any, name: str, random: np.random.Generator) -> Any:
    """A message with random values, in which arrays have up to three elements."""

    def value(kind: int, what: Any) -> Any:
        if kind == Nodetype.NAME:
            return _drawn(store, what, random)
        if kind == Nodetype.BASE:
            if what[0] == "string":
                return "x" * int(random.integers(0, 4))
            number = NUMPY.get(what[0], what[0])
            return np.dtype(number).type(random.integers(0, 100)).item()
        (inner, element), size = what
        count = size if kind == Nodetype.ARRAY else int(random.integers(0, 4))
        if inner == Nodetype.BASE and element[0] != "string":
            return random.integers(0, 100, count).astype(NUMPY.get(element[0], element[0]))
        return [value(inner, element) for _ in range(count)]

    fields = store.fielddefs[name][1]
    return store.types[name](*(value(*description) for _, description in fields))


NUMPY = {"bool": "bool_", "byte": "uint8", "char": "uint8", "octet": "uint8"}


def _numbers(message: Any, above: str = "") -> Iterator[tuple[str, float]]:
    """Path and value of each number of a message that rosbags has read."""
    names = getattr(message, "name", None)
    for field, value in vars(message).items():
        if field in ("header", "layout", "structure_needs_at_least_one_member"):
            continue
        if field.isupper():  # a constant of the type
            continue
        if isinstance(value, (bool, int, float, np.number)):
            yield f"{above}{field}", float(value)
        elif isinstance(value, np.ndarray):
            labels = names if isinstance(names, list) and len(names) == len(value) else None
            for i, number in enumerate(value.tolist()):
                yield f"{above}{field}[{labels[i] if labels else i}]", float(number)
        elif hasattr(value, "__dataclass_fields__"):
            yield from _numbers(value, f"{above}{field}.")


def test_long_arrays_and_messages_are_no_signals(tmp_path: Path) -> None:
    data = struct.pack("<4sdI", b"\0\1\0\0", 2.5, 300) + bytes(300)
    mcap_bag(tmp_path / "a.mcap", data, "float64 a\nuint8[] b")
    assert list(open_log(tmp_path / "a.mcap").columns) == ["/a.a", "/a.time"]
    data = struct.pack("<4sdI", b"\0\1\0\0", 2.5, 70_000) + bytes(70_000)
    mcap_bag(tmp_path / "a.mcap", data, "float64 a\nuint8[] b")
    assert "found none" in refusal(tmp_path / "a.mcap")


def test_topics_that_are_not_wanted_are_not_read(tmp_path: Path) -> None:
    sqlite_bag(tmp_path / "a.db3")
    with closing(sqlite3.connect(tmp_path / "a.db3")) as database:
        row = "INSERT INTO topics VALUES(2, '/b', 'unknown/msg/Type', 'cdr')"
        database.execute(row)
        database.execute("INSERT INTO messages VALUES(NULL, 2, 5, x'00010000')")
        database.commit()
    assert list(open_log(tmp_path / "a.db3", ["/a.data"]).columns) == ["/a.data", "/a.time"]
    assert "unknown/msg/Type" in refusal(tmp_path / "a.db3")


@pytest.mark.parametrize("cut", [0, 2, 5, 11, 16])
def test_messages_that_do_not_fit_their_type(cut: int, tmp_path: Path) -> None:
    data = (FLOAT + bytes(8))[:cut]
    sqlite_bag(tmp_path / "a.db3", data=data)
    assert "messages of '/a' cannot be read" in refusal(tmp_path / "a.db3")
