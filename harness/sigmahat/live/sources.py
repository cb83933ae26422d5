"""Sources of messages: UDP, TCP, standard input, or a log in real time.

A source reads in threads of its own, and puts the messages into an inbox.
"""

from __future__ import annotations

import heapq
import socket
import sys
import time
from collections.abc import Callable, Collection, Iterator
from functools import partial
from queue import Full, Queue
from threading import Thread
from typing import BinaryIO

import numpy as np

from sigmahat.live.messages import LONGEST, Columns, Decoder
from sigmahat.live.session import Session
from sigmahat.logs.log import Log

_MOST = 20_000
"""Largest number of messages that wait."""
_BUFFER = 1 << 22
"""Size of the receive buffer [bytes]."""

Reader = Callable[[], Columns | None]
"""Gives the columns of a message; None for a message without columns. Raises ValueError if the
message is not readable, and EOFError after the last message."""


class Inbox(Queue[tuple[int, Reader]]):
    """Messages that wait, each with its time of arrival [ns] since 1970."""

    def __init__(self) -> None:
        super().__init__(_MOST)
        self.dropped = 0
        """Number of messages that were lost because the inbox was full."""

    def add(self, read: Reader, can_wait: bool = True, arrival: int | None = None) -> None:
        """can_wait  whether the sender waits for a place; else the message may be lost"""
        try:
            self.put((time.time_ns() if arrival is None else arrival, read), can_wait)
        except Full:
            self.dropped += 1

    def end(self) -> None:
        """Marks the end of the messages."""
        self.add(_no_more)


def _no_more() -> None:
    raise EOFError


Source = Callable[[Inbox], None]
"""Puts messages into the inbox until the data end; UDP, TCP and ROS 2 do not end."""


def start(source: Source, inbox: Inbox) -> None:
    """Reads in a thread."""
    Thread(target=source, args=[inbox], daemon=True).start()


def udp(address: tuple[str, int], decoder: Callable[[], Decoder]) -> Source:
    """A datagram is a message. Raises OSError if the address is not available."""
    bound = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    bound.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, _BUFFER)
    bound.bind(address)
    columns = decoder().columns

    def read(inbox: Inbox) -> None:
        while True:
            inbox.add(partial(columns, bound.recv(LONGEST + 1)), can_wait=False)

    return read


def tcp(address: tuple[str, int], decoder: Callable[[], Decoder]) -> Source:
    """A line is a message; any number of senders connect. Raises as udp."""
    server = socket.create_server(address)

    def read(inbox: Inbox) -> None:
        while True:
            connection, _ = server.accept()
            Thread(target=one, args=[inbox, connection], daemon=True).start()

    def one(inbox: Inbox, connection: socket.socket) -> None:
        with connection, connection.makefile("rb") as file:
            _lines(file, inbox, decoder())

    return read


def stdin(decoder: Callable[[], Decoder]) -> Source:
    """A line is a message."""

    def read(inbox: Inbox) -> None:
        _lines(sys.stdin.buffer, inbox, decoder())
        inbox.end()

    return read


def _lines(file: BinaryIO, inbox: Inbox, decoder: Decoder) -> None:
    """Puts each line of a file into the inbox; a line that is too long is cut off."""
    try:
        while line := file.readline(LONGEST + 1):
            inbox.add(partial(decoder.columns, line))
            while len(line) > LONGEST and not line.endswith(b"\n"):
                line = file.readline(LONGEST + 1)
    except OSError:  # the connection is broken
        return


def replay(log: Log, session: Session) -> Source:
    """The used columns of a log, in real time. Raises LogError if the log lacks a column."""
    used: dict[str, tuple[float, list[str]]] = {}
    for joint in session.joints:
        for name, port in joint.ports.items():
            time_column = joint.time_column(name)
            # Rows without a time are a period of the estimator apart.
            step = session.clocks[time_column].seconds if time_column else joint.T
            columns = [port.port.column] if port.port.column else []
            used.setdefault(time_column, (step, []))[1].extend(columns)
    groups = [_rows(log, name, *each) for name, each in used.items()]

    def read(inbox: Inbox) -> None:
        begin, first = time.monotonic(), None
        for t, columns in heapq.merge(*groups, key=lambda each: each[0]):
            first = t if first is None else first
            time.sleep(max(begin + t - first - time.monotonic(), 0.0))
            inbox.add(partial(dict, columns), arrival=round(1e9 * t))
        inbox.end()

    return read


def _rows(
    log: Log, time_column: str, period: float, columns: Collection[str]
) -> Iterator[tuple[float, Columns]]:
    """Times [s] and columns of the rows of a log that have a time.

    period  time between rows without a time column; else unit of the time column [s]
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
