"""Small bags in SQLite and MCAP, whose every byte a test can choose."""

import sqlite3
import struct
from contextlib import closing
from pathlib import Path

from mcap.writer import Writer

SECOND = 10**9
FLOAT = b"\0\1\0\0" + struct.pack("<d", 2.5)
"""A std_msgs/msg/Float64."""
MESSAGES = "CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id, timestamp, data)"


def sqlite_bag(
    path: Path,
    data: bytes = FLOAT,
    type_name: str = "std_msgs/msg/Float64",
    messages: str = MESSAGES,
    definition: str = "",
) -> None:
    """Writes a bag with two messages of one topic.

    messages  what creates the table or view of this name
    """
    path.parent.mkdir(exist_ok=True)
    with closing(sqlite3.connect(path)) as database:
        database.execute(
            "CREATE TABLE topics(id INTEGER PRIMARY KEY, name, type, serialization_format)"
        )
        database.execute("INSERT INTO topics VALUES(1, '/a', ?, 'cdr')", (type_name,))
        database.execute(messages)
        if "TABLE" in messages:
            rows = [(k * SECOND, data) for k in range(2)]
            database.executemany(
                "INSERT INTO messages(topic_id, timestamp, data) VALUES(1, ?, ?)", rows
            )
        if definition:
            columns = "topic_type, encoding, encoded_message_definition"
            database.execute(f"CREATE TABLE message_definitions({columns})")
            row = (type_name, "ros2msg", definition)
            database.execute("INSERT INTO message_definitions VALUES(?, ?, ?)", row)
        database.commit()


def mcap_bag(path: Path, data: bytes, definition: str, **options: object) -> None:
    """Writes a bag with two messages of a type that it defines."""
    with path.open("wb") as file:
        writer = Writer(file, **options)  # type: ignore[arg-type]
        writer.start("ros2")
        schema = writer.register_schema("a/msg/B", "ros2msg", definition.encode())
        channel = writer.register_channel("/a", "cdr", schema)
        for k in range(2):
            writer.add_message(channel, k * SECOND, data, k * SECOND)
        writer.finish()  # type: ignore[no-untyped-call]
