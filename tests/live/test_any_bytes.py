"""Messages of any bytes among good ones: every good one is read."""

import os
import random
import socket
from collections.abc import Callable, Iterator, Sequence
from functools import partial
from pathlib import Path
from threading import Thread
from typing import Any

import numpy as np
import pytest

from sender import CONFIGURATION, free_port, messages
from sigmahat.live.endpoints import Endpoints
from sigmahat.live.loop import Inbox, Loop, Source
from sigmahat.live.messages import Columns, Decoder
from sigmahat.live.session import Session
from sigmahat.recording.readers.formats import open_log

JUNK = 10_000 if "SIGMAHAT_COMPLETE" in os.environ else 600
NAMES = ("t", "arm/motor", "arm/link[0]", "arm/torque")
LARGEST = 60_000  # bytes of a datagram


def mutated(noise: random.Random, good: bytes) -> bytes:
    """Bytes that are no message, or nearly one."""
    kind = noise.randrange(6)
    if kind == 0:
        return noise.randbytes(noise.randrange(1, 300))
    if kind == 1:
        return good[: noise.randrange(1, len(good))]
    if kind == 2:
        return noise.choice([b"t,arm/motor\n", b"{" * 1000, b"[" * LARGEST, b"\n", b'{"t": 1e400}'])
    if kind == 3:
        return good * noise.randrange(2, 5)
    changed = bytearray(good)
    for _ in range(noise.randrange(1, 5)):
        changed[noise.randrange(len(changed))] = noise.randrange(256)
    return bytes(changed)


def is_possible(message: bytes) -> bool:
    """Whether a message may be one of the sender, with wrong values: these are not refused."""
    try:
        columns = Decoder(NAMES, NAMES).values(message)
    except ValueError:
        return False
    return abs(columns.get("t", np.nan)) < 1e6


def between(seed: int, good: Sequence[bytes]) -> Iterator[list[bytes]]:
    """Some bytes, and after them a good message."""
    noise, left = random.Random(seed), JUNK
    for i, each in enumerate(good):
        count = left // (len(good) - i)
        left -= count
        drawn = (mutated(noise, each) for _ in range(count))
        yield [*(junk for junk in drawn if not is_possible(junk)), each]


def line(message: dict[str, Any]) -> bytes:
    return (",".join(repr(message[name]) for name in NAMES) + "\n").encode()


def source_of(name: str, session: Session, folder: Path) -> tuple[Source, Callable[[bytes], int]]:
    """A source, and what sends bytes to it and returns the number of messages that these are."""
    port = free_port()
    source = Endpoints(session, "127.0.0.1", folder).source(f"{name}:{port}", NAMES)
    if name == "udp":
        datagrams = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        datagrams.connect(("127.0.0.1", port))
        return source, lambda message: bool(datagrams.send(message))
    stream = socket.create_connection(("127.0.0.1", port))

    def send(message: bytes) -> int:
        text = message.replace(b"\n", b" ").replace(b"t,arm", b"t;arm") + b"\n"
        stream.sendall(text)
        return 1

    return source, send


@pytest.mark.parametrize("name", ["udp", "tcp"])
def test_sockets(name: str, tmp_path: Path) -> None:
    (tmp_path / "arm.toml").write_text(CONFIGURATION)
    session, inbox = Session(tmp_path / "arm.toml", tmp_path), Inbox()
    source, send = source_of(name, session, tmp_path)
    Thread(target=source, args=[inbox], daemon=True).start()
    loop = Loop(session, inbox, [])
    sent = messages(200)
    for group in between(5, [line(each) for each in sent]):
        for each in group:
            for _ in range(send(each)):
                loop.take(inbox.get(timeout=10))
    loop.end()
    (recording,) = session.recordings
    np.testing.assert_array_equal(open_log(recording).read("t"), [each["t"] for each in sent])
    assert inbox.wrong > JUNK / 2 and not inbox.dropped


def test_joint_states() -> None:
    pytest.importorskip("cyclonedds")
    from cyclonedds.pub import DataWriter
    from cyclonedds.topic import Topic

    from sigmahat.live import ros2

    ours, inbox = ros2.Ros2(), Inbox()
    source = ours.joint_states(["/any_bytes.time", "/any_bytes.position[knee]"])
    Thread(target=source, args=[inbox], daemon=True).start()
    topic = Topic(ours._domain, "rt/any_bytes", ros2._JointState)
    writer = DataWriter(ours._domain, topic, qos=ros2._WHOLE)

    def state(i: int) -> Any:
        header = ros2._Header(ros2._Time(1 + i, 0), "")
        return ros2._JointState(header, ["knee"], [0.25 + i], [], [])

    good = [state(i).serialize() for i in range(50)]
    for i, group in enumerate(between(6, good)):
        for data in group:
            message = state(0)
            message.serialize = partial(_same, data)
            ros2._write(writer, message)  # which refuses some itself
        found: Columns | None = {}
        while not found or found.get("/any_bytes.position[knee]") != 0.25 + i:
            try:
                found = inbox.get(timeout=10).read()
            except ValueError:
                found = {}
    assert not inbox.dropped


def _same(data: bytes, **_: object) -> bytes:
    return data


def test_what_waits_is_limited_in_bytes() -> None:
    inbox, message = Inbox(), bytes(60_000)
    for _ in range(2000):
        inbox.add(partial(Decoder(NAMES).values, message), len(message), can_wait=False)
    assert inbox.dropped > 1000
    waiting = 0
    while not inbox.empty():
        inbox.get_nowait()
        waiting += 1
    assert 100 < waiting < 1000
