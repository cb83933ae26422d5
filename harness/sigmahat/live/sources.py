"""Where messages come from: UDP, TCP, standard input, or a log at its own pace.

A source reads in threads of its own, and puts what it reads into an inbox.
"""

from __future__ import annotations

import heapq
import socket
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from queue import Empty, Full, Queue
from threading import Thread
from typing import BinaryIO

import numpy as np

from sigmahat.live.messages import LONGEST, Columns, Decoder
from sigmahat.live.session import Session
from sigmahat.logs.log import Log

_MOST = 20_000
"""Messages that wait."""
_BUFFER = 1 << 22
"""Bytes that the system is asked to keep of what has not been read."""


@dataclass(frozen=True)
class Received:
    """What a sender sent."""

    arrival: int
    """[ns] since 1970."""
    read: Callable[[], Columns | None]
    """Its columns; None if it has none. Raises ValueError for what is no message."""


class Inbox:
    """Messages that wait, and how the sources are."""

    def __init__(self) -> None:
        self._queue: Queue[Received | None] = Queue(_MOST)
        self.dropped = 0
        """Messages that found it full."""
        self.is_at_end = False
        """Whether no more will come."""

    def put(
        self, read: Callable[[], Columns | None], can_wait: bool = True, arrival: int | None = None
    ) -> None:
        """can_wait  whether the sender waits for a place, or the message is lost"""
        try:
            self._queue.put(
                Received(time.time_ns() if arrival is None else arrival, read), can_wait
            )
        except Full:
            self.dropped += 1

    def end(self) -> None:
        """No more messages will come."""
        self._queue.put(None)

    def next(self, seconds: float) -> Received | None:
        """The next message; None if none comes in this time, or at the end."""
        try:
            found = self._queue.get(timeout=seconds)
        except Empty:
            return None
        self.is_at_end |= found is None
        return found


Source = Callable[[Inbox], None]
"""Reads until the process ends, or to the end of what there is."""


def start(source: Source, inbox: Inbox) -> None:
    """Reads in a thread."""
    Thread(target=source, args=[inbox], daemon=True).start()


def udp(address: tuple[str, int], decoder: Decoder) -> Source:
    """A datagram is a message. Raises OSError if the address cannot be had."""
    bound = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    bound.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, _BUFFER)
    bound.bind(address)

    def read(inbox: Inbox) -> None:
        while True:
            inbox.put(_reads(decoder, bound.recv(LONGEST + 1)), can_wait=False)

    return read


def tcp(address: tuple[str, int], wanted: Sequence[str], columns: Sequence[str]) -> Source:
    """A line is a message; any number of senders connect. Raises as udp."""
    server = socket.create_server(address)

    def read(inbox: Inbox) -> None:
        while True:
            connection, _ = server.accept()
            Thread(target=one, args=[inbox, connection], daemon=True).start()

    def one(inbox: Inbox, connection: socket.socket) -> None:
        with connection, connection.makefile("rb") as file:
            lines(file, inbox, Decoder(wanted, columns))

    return read


def stdin(decoder: Decoder) -> Source:
    """A line is a message."""

    def read(inbox: Inbox) -> None:
        lines(sys.stdin.buffer, inbox, decoder)
        inbox.end()

    return read


def lines(file: BinaryIO, inbox: Inbox, decoder: Decoder) -> None:
    """Puts each line of a file into the inbox; of one that is too long, the begin."""
    try:
        while line := file.readline(LONGEST + 1):
            inbox.put(_reads(decoder, line))
            while len(line) > LONGEST and not line.endswith(b"\n"):
                line = file.readline(LONGEST + 1)
    except OSError:  # the sender has died
        return


def _reads(decoder: Decoder, message: bytes) -> Callable[[], Columns | None]:
    return lambda: decoder.columns(message)


def replay(log: Log, session: Session) -> Source:
    """The columns of a log that are used, at its own pace. Raises LogError if it lacks one."""
    groups = [
        _rows(log, name, seconds, columns)
        for name, (seconds, columns) in session.columns_of_times().items()
    ]

    def read(inbox: Inbox) -> None:
        begin, first = time.monotonic(), None
        for t, columns in heapq.merge(*groups, key=lambda each: each[0]):
            first = t if first is None else first
            time.sleep(max(begin + t - first - time.monotonic(), 0.0))
            inbox.put(partial(dict, columns), arrival=round(1e9 * t))
        inbox.end()

    return read


def _rows(
    log: Log, time_column: str, period: float, columns: Sequence[str]
) -> Iterator[tuple[float, Columns]]:
    """Times [s] and columns of the rows of a log that have a time.

    period  of the rows, if they have no time column; else seconds in its unit
    """
    values = {name: log.read(name) for name in columns}
    if time_column:
        values[time_column] = log.read(time_column)
        times = values[time_column] * period
    else:
        times = period * np.arange(min(map(len, values.values())), dtype=np.float64)
    for t, row in zip(times.tolist(), zip(*values.values(), strict=False), strict=False):
        if t == t:
            yield t, dict(zip(values, map(float, row), strict=True))
