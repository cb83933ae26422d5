"""Reads the messages in the files of a ROS 2 bag: SQLite or MCAP, each also packed by Zstandard.

A file may come from a stranger. SQLite may read tables, and nothing that would run: no views, no
functions. What is packed is unpacked up to a limit. No file outside of the bag is opened.
"""

import mmap
import sqlite3
import struct
import zlib
from collections.abc import Callable, Generator, Iterator
from contextlib import closing
from dataclasses import dataclass, field
from io import BytesIO
from itertools import count
from pathlib import Path, PurePath
from tempfile import TemporaryDirectory

import lz4.frame
import zstandard
from mcap.data_stream import ReadDataStream
from mcap.opcode import Opcode
from mcap.records import Channel, Chunk, Schema
from ruamel.yaml import YAML

from sigmahat.fmi.quoted import quoted
from sigmahat.recording.limits import check_messages, check_unpacked
from sigmahat.recording.log import LogError

_SQLITE, _MCAP = b"SQLite format 3\0", b"\x89MCAP0\r\n"
_ZSTANDARD = b"\x28\xb5\x2f\xfd"  # a message in CDR begins with a zero
_LONGEST_MESSAGE = 1 << 16  # bytes; a longer one is a picture or a scan, not a signal
_LONGEST_CHUNK = 100_000_000  # bytes; writers make chunks of one megabyte or one message
_LONGEST_METADATA = 500_000  # bytes; a topic takes 500
_MOST_TOPICS = 10_000
_OPERATIONS = 1_000_000  # of SQLite, after which it asks whether to go on
_BYTES_PER_OPERATION = 2  # in a file; a row has twenty bytes or more, and takes ten operations
_HIDDEN = 6  # in the description of a column
_RECORD = struct.Struct("<BQ")  # of MCAP: operation, length
_MESSAGE = struct.Struct("<HIQQ")  # channel, number, time of the recording, time of sending
_LATEST = (1 << 63) - 1  # nanoseconds since 1970
_CDR = "cdr"


@dataclass(frozen=True)
class Topic:
    name: str
    type: str  #: Such as "sensor_msgs/msg/JointState".
    language: str = field(default="", compare=False)
    """"ros2msg" or "ros2idl"; empty if the bag does not define the type."""
    definition: str = field(default="", compare=False)  #: Text that defines the type.


Message = tuple[Topic, int, bytes | None]
"""Topic, time of the recording [ns], data; None for a message that is too long for a signal, not in
CDR, or of a topic that is not wanted."""


class BagFiles:
    """The files of a bag, and limits for all of them together."""

    def __init__(self, path: Path, wanted: Callable[[str], bool]) -> None:
        """wanted  whether the messages of a topic are wanted, by its name"""
        self._path, self._wanted = path, wanted
        self._records = self._unpacked = 0

    def messages(self) -> Generator[Message, None, None]:
        """Yields the messages, file by file, in the order in which they are stored.

        Raises LogError for a bag beyond the limits, and for a damaged bag many other errors.
        """
        for file in _files(self._path):
            with file.open("rb") as opened:
                if opened.read(len(_ZSTANDARD)) != _ZSTANDARD:
                    yield from self._of_file(file)
                    continue
                with TemporaryDirectory() as folder:
                    unpacked = Path(folder, "bag")
                    opened.seek(0)
                    with unpacked.open("wb") as written:
                        for piece in zstandard.ZstdDecompressor().read_to_iter(opened):
                            self._count_unpacked(len(piece))
                            written.write(piece)
                    yield from self._of_file(unpacked)

    def _of_file(self, file: Path) -> Iterator[Message]:
        with file.open("rb") as opened:
            head = opened.read(len(_SQLITE))
            if head == _SQLITE:
                yield from self._of_sqlite(file)
            elif head.startswith(_MCAP):
                with mmap.mmap(opened.fileno(), 0, access=mmap.ACCESS_READ) as content:
                    yield from self._of_mcap(content)
            else:
                raise LogError(f"{self._path}: expected SQLite or MCAP in {quoted(file.name)}")

    def _of_sqlite(self, file: Path) -> Iterator[Message]:
        most = 10 + file.stat().st_size // (_BYTES_PER_OPERATION * _OPERATIONS)
        asked = count()
        address = f"{file.absolute().as_uri()}?mode=ro&immutable=1"
        with closing(sqlite3.connect(address, uri=True)) as connection:
            connection.set_progress_handler(lambda: next(asked) > most, _OPERATIONS)
            for table in ("topics", "messages", "message_definitions"):
                columns = connection.execute(f"PRAGMA table_xinfo({table})")
                if any(column[_HIDDEN] for column in columns):  # an expression, for every row
                    raise ValueError(f"the table {table} has columns that are computed")
            connection.set_authorizer(_only_tables)
            topics = _topics_of_sqlite(connection)
            wanted = [str(key) for key, (topic, cdr) in topics.items() if self._of_use(topic, cdr)]
            rows = connection.execute(
                "SELECT topic_id, timestamp, "
                f"CASE WHEN topic_id IN ({','.join(wanted)}) THEN data END FROM messages"
            )
            for key, recorded, data in rows:
                self._count_record()
                if not isinstance(recorded, int) or not isinstance(data, (bytes, type(None))):
                    raise ValueError("the table of messages holds other types")
                yield topics[key][0], recorded, self._data(data)

    def _of_mcap(self, content: mmap.mmap) -> Iterator[Message]:
        schemas: dict[int, Schema] = {}
        topics: dict[int, tuple[Topic, bool]] = {}
        for kind, body in self._records_of(content, len(_MCAP)):
            is_chunk = kind == Opcode.CHUNK
            inner = self._records_of(self._chunk(body), 0) if is_chunk else iter([(kind, body)])
            for each, part in inner:
                if each == Opcode.SCHEMA:
                    schema = Schema.read(ReadDataStream(BytesIO(part)))
                    schemas[schema.id] = schema
                elif each == Opcode.CHANNEL:
                    channel = Channel.read(ReadDataStream(BytesIO(part)))
                    topics[channel.id] = _topic_of_mcap(channel, schemas)
                elif each == Opcode.MESSAGE:
                    key, _, recorded, _ = _MESSAGE.unpack_from(part)
                    if recorded > _LATEST:
                        raise ValueError("a time is too large")
                    topic, is_cdr = topics[key]
                    wanted = self._of_use(topic, is_cdr)
                    yield topic, recorded, self._data(part[_MESSAGE.size :] if wanted else None)

    def _records_of(self, content: mmap.mmap | bytes, at: int) -> Iterator[tuple[int, bytes]]:
        """Yields kinds and contents of the records of an MCAP file, or of a chunk."""
        while isinstance(content, mmap.mmap) or at < len(content):
            kind, length = _RECORD.unpack_from(content, at)
            at += _RECORD.size + length
            if at > len(content):
                raise ValueError("it ends early")
            self._count_record()
            if kind == Opcode.DATA_END:
                return
            if kind in (Opcode.SCHEMA, Opcode.CHANNEL, Opcode.MESSAGE, Opcode.CHUNK):
                yield kind, content[at - length : at]

    def _chunk(self, body: bytes) -> bytes:
        """Unpacks a chunk of an MCAP file."""
        chunk = Chunk.read(ReadDataStream(BytesIO(body)))
        size = chunk.uncompressed_size
        if size > _LONGEST_CHUNK:
            raise LogError(
                f"{self._path}: expected at most {_LONGEST_CHUNK / 1e6:.0f} MB in a chunk of MCAP, "
                f"got {size / 1e6:.0f} MB; record it in smaller chunks"
            )
        data: bytes = chunk.data
        if chunk.compression == "zstd":
            self._count_unpacked(size)
            data = _unpacked(chunk.data, size)
        elif chunk.compression == "lz4":
            self._count_unpacked(size)
            data = lz4.frame.LZ4FrameDecompressor().decompress(chunk.data, max_length=size + 1)
        elif chunk.compression:
            raise ValueError(f"unknown compression {quoted(chunk.compression)}")
        if len(data) != size or chunk.uncompressed_crc not in (0, zlib.crc32(data)):
            raise ValueError("a chunk is damaged")
        return data

    def _data(self, data: bytes | None) -> bytes | None:
        """The data of a message, unpacked; None if they are too long."""
        if data is None or not data.startswith(_ZSTANDARD):
            return None if data is None or len(data) > _LONGEST_MESSAGE else data
        data = _unpacked(data, _LONGEST_MESSAGE)
        self._count_unpacked(len(data))
        return None if len(data) > _LONGEST_MESSAGE else data

    def _of_use(self, topic: Topic, is_cdr: bool) -> bool:
        return is_cdr and self._wanted(topic.name)

    def _count_record(self) -> None:
        self._records += 1
        check_messages(self._path, self._records)

    def _count_unpacked(self, size: int) -> None:
        self._unpacked += size
        check_unpacked(self._path, self._unpacked)


def _files(path: Path) -> Iterator[Path]:
    """The files of a bag. Raises LogError if one of them lies outside of the folder."""
    if not path.is_dir():
        yield path
        return
    with (path / "metadata.yaml").open("rb") as file:
        text = file.read(_LONGEST_METADATA + 1)
    if len(text) > _LONGEST_METADATA:
        raise LogError(
            f"{path}: expected at most {_LONGEST_METADATA} bytes in metadata.yaml, got more; "
            "record fewer topics"
        )
    metadata = YAML(typ="safe").load(text)["rosbag2_bagfile_information"]
    for name in metadata["relative_file_paths"]:
        file_path = path / PurePath(name).name  # old bags begin names with their folder
        if file_path.resolve().parent != path.resolve():
            raise LogError(
                f"{path}: {quoted(name)} lies in another folder, and only the log is read; "
                "copy the file into it"
            )
        if not file_path.is_file():
            raise LogError(f"{path}: the file {quoted(name)} is missing; copy the bag again")
        yield file_path


def _unpacked(data: bytes, most: int) -> bytes:
    """Unpacks at most this number of bytes, and a piece more if there are more."""
    found = bytearray()
    for piece in zstandard.ZstdDecompressor().read_to_iter(data):
        found += piece
        if len(found) > most:
            break
    return bytes(found)


def _only_tables(
    action: int, _1: str | None, _2: str | None, _3: str | None, view: str | None
) -> int:
    """Lets SQLite read tables, and denies views, functions and everything else."""
    reads = action in (sqlite3.SQLITE_SELECT, sqlite3.SQLITE_READ)
    return sqlite3.SQLITE_OK if reads and view is None else sqlite3.SQLITE_DENY


def _topics_of_sqlite(connection: sqlite3.Connection) -> dict[int, tuple[Topic, bool]]:
    """Topics by number, and whether their messages are in CDR."""
    try:
        types = connection.execute(
            "SELECT topic_type, encoding, encoded_message_definition FROM message_definitions "
            f"LIMIT {_MOST_TOPICS}"
        )
        definitions = {name: definition for name, *definition in types}
    except sqlite3.OperationalError:  # a bag of ROS 2 Humble or older
        definitions = {}
    rows = connection.execute(
        f"SELECT id, name, type, serialization_format FROM topics LIMIT {_MOST_TOPICS}"
    )
    topics = {}
    for key, name, kind, form in rows:
        if not isinstance(key, int) or not isinstance(name, str) or not isinstance(kind, str):
            raise ValueError("the table of topics holds other types")
        topics[key] = Topic(name, kind, *map(str, definitions.get(kind, ()))), form == _CDR
    return topics


def _topic_of_mcap(channel: Channel, schemas: dict[int, Schema]) -> tuple[Topic, bool]:
    """The topic of a channel, and whether its messages are in CDR."""
    schema = schemas[channel.schema_id]
    definition = schema.data.decode() if schema.data else ""
    topic = Topic(channel.topic, schema.name, schema.encoding, definition)
    return topic, channel.message_encoding == _CDR
