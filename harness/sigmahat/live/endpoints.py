"""Creates sources and sinks by their names on the command line, such as UDP, TCP, or a log."""

from __future__ import annotations

import heapq
import json
import socket
import sys
import time
from collections.abc import Callable, Collection, Iterator, Sequence
from contextlib import suppress
from functools import cached_property, partial
from itertools import groupby
from pathlib import Path
from threading import BoundedSemaphore, Thread
from typing import TYPE_CHECKING, BinaryIO

import numpy as np

from sigmahat.live.events import Event
from sigmahat.live.live_joint import Estimated, News
from sigmahat.live.loop import Inbox, Sink, Source
from sigmahat.live.messages import LONGEST, Columns, Decoder
from sigmahat.live.session import Session
from sigmahat.recording.log import Log
from sigmahat.recording.readers.formats import open_log

if TYPE_CHECKING:
    from sigmahat.live.ros2 import Ros2

_LOOPBACK, _FOXGLOVE = "127.0.0.1", "8765"
_BUFFER = 1 << 22  # size of the receive buffer [bytes]
_MOST = 64  # TCP senders at the same time
_Address = tuple[str, int]
_Decoders = Callable[[], Decoder]


class Endpoints:
    """Sources and sinks of a session. Methods raise ValueError, which says what was expected."""

    def __init__(self, session: Session, host: str, out: Path) -> None:
        """host  address of this computer to listen at; out  folder for the layout of Foxglove"""
        self._session, self._host, self._out = session, host, out

    def source(self, name: str, titles: Sequence[str]) -> Source:
        """titles  columns of CSV, if no line names them"""
        wanted = self._session.columns
        lacking = [each for each in wanted if each not in titles] if titles else []
        if lacking:
            raise ValueError(f"--columns lacks {', '.join(lacking)} of the configuration; add it")
        decoders = partial(Decoder, wanted, titles)
        kind, _, port = name.partition(":")
        if name == "ros2":
            return self._ros2.joint_states(wanted)
        if name == "stdin":
            return partial(_read_stdin, decoders)
        if kind not in ("udp", "tcp"):
            raise ValueError(f"--from: expected udp:PORT, tcp:PORT, stdin or ros2, got {name!r}")
        listen = _tcp if kind == "tcp" else _udp
        try:
            return listen((self._host, _address("--from", port)[1]), decoders)
        except OSError as error:
            raise self._cannot_listen(name, error.strerror or error) from error

    def replay(self, log: Path) -> Source:
        """The used columns of a recorded log, in real time. Raises LogError if one is missing."""
        opened = open_log(log, self._session.columns)
        used: dict[str, tuple[float, list[str]]] = {}
        for joint in self._session.joints:
            for name, port in joint.ports.items():
                time_column = joint.time_column(name)
                # Rows without a time are a period of the estimator apart.
                step = self._session.clocks[time_column].seconds if time_column else joint.T
                columns = [port.port.column] if port.port.column else []
                used.setdefault(time_column, (step, []))[1].extend(columns)
        groups = [_rows(opened, name, *each) for name, each in used.items()]

        def read(inbox: Inbox) -> None:
            begin, first = time.monotonic(), None
            for t, columns in heapq.merge(*groups, key=lambda each: each[0]):
                first = t if first is None else first
                time.sleep(max(begin + t - first - time.monotonic(), 0.0))
                inbox.add(partial(dict, columns), arrival=round(1e9 * t))

        return read

    def sink(self, name: str) -> Sink:
        """Creates the sink of the given name; for Foxglove, the layout is also written."""
        kind, _, rest = name.partition(":")
        if name == "ros2":
            return self._ros2.publish()
        if kind == "udp":
            return _send_udp(_address("--to", rest))
        if kind != "foxglove":
            raise ValueError(
                f"--to: expected udp:PORT, udp:HOST:PORT, foxglove[:PORT] or ros2, got {name!r}"
            )
        from sigmahat.live import foxglove_server

        address = self._host, _address("--to", rest or _FOXGLOVE)[1]
        foxglove_server.write_layout(self._session.joints, self._out)
        try:
            return foxglove_server.serve(address, self._session.joints)
        except RuntimeError as error:
            raise self._cannot_listen(name, error) from error

    @cached_property
    def _ros2(self) -> Ros2:
        from sigmahat.live.ros2 import Ros2

        return Ros2()

    def _cannot_listen(self, name: str, error: object) -> ValueError:
        return ValueError(
            f"cannot listen at {self._host}, {name}: {error}; name another port, or an address of "
            "this computer with --host"
        )


def _address(option: str, text: str) -> _Address:
    host, _, port = text.rpartition(":")
    if not port.isdecimal() or not 0 < int(port[:9]) < 1 << 16:
        raise ValueError(f"{option}: expected a port from 1 to 65535, got {text!r}")
    return host or _LOOPBACK, int(port)


def _udp(address: _Address, decoders: _Decoders) -> Source:
    """Creates a source of UDP datagrams. Raises OSError if the address is not available."""
    bound = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    bound.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, _BUFFER)
    bound.bind(address)
    decoder = decoders()

    def read(inbox: Inbox) -> None:
        while True:
            message = bound.recv(LONGEST + 1)
            inbox.add(partial(decoder.values, message), len(message), can_wait=False)

    return read


def _tcp(address: _Address, decoders: _Decoders) -> Source:
    """Creates a source of lines from any number of TCP senders. Raises OSError as _udp does."""
    server = socket.create_server(address)
    places = BoundedSemaphore(_MOST)

    def read(inbox: Inbox) -> None:
        while True:
            try:
                connection, _ = server.accept()
            except ConnectionError:  # the sender has gone meanwhile
                continue
            if places.acquire(blocking=False):
                Thread(target=one, args=[inbox, connection], daemon=True).start()
            else:
                connection.close()
                inbox.add(_no_place)

    def one(inbox: Inbox, connection: socket.socket) -> None:
        try:
            with connection, connection.makefile("rb") as file:
                _lines(file, inbox, decoders())
        finally:
            places.release()

    return read


def _no_place() -> Columns:
    raise ValueError(f"expected at most {_MOST} senders at the same time, got one more")


def _read_stdin(decoders: _Decoders, inbox: Inbox) -> None:
    _lines(sys.stdin.buffer, inbox, decoders())


def _lines(file: BinaryIO, inbox: Inbox, decoder: Decoder) -> None:
    """Puts each line of a file into the inbox; a line that is too long is cut off."""
    with suppress(OSError):  # the connection is broken
        while line := file.readline(LONGEST + 1):
            inbox.add(partial(decoder.columns, line), len(line))
            while len(line) > LONGEST and not line.endswith(b"\n"):
                line = file.readline(LONGEST + 1)


def _rows(
    log: Log, time_column: str, period: float, columns: Collection[str]
) -> Iterator[tuple[float, Columns]]:
    """Yields time [s] and columns of each row of a log that has a time.

    period  time between rows without a time column; else unit of the time column [s]
    """
    values = {name: log.read(name) for name in columns}
    if time_column:
        values[time_column] = log.read(time_column)
        times = values[time_column] * period
    else:
        times = period * np.arange(min(map(len, values.values())), dtype=np.float64)
    rows = zip(times.tolist(), zip(*values.values(), strict=False), strict=False)
    return ((t, dict(zip(values, map(float, row), strict=True))) for t, row in rows if t == t)


def _send_udp(address: _Address) -> Sink:
    """Creates a sink of UDP datagrams for PlotJuggler: {"timestamp": t, "elbow": {...}}.

    An event is a datagram of its own: {"timestamp": t, "event": {...}}. A missing receiver is no
    error.
    """
    sender = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    sender.setblocking(False)

    def send(news: Sequence[News]) -> None:
        events = [each for each in news if isinstance(each, Event)]
        ticks = [each for each in news if isinstance(each, Estimated)]
        messages = [{"timestamp": each.t, "event": each.shown()} for each in events]
        for t, at_once in groupby(ticks, key=lambda each: each.t):
            messages.append({"timestamp": t} | {each.joint: each.shown() for each in at_once})
        for message in messages:
            with suppress(OSError):
                sender.sendto(json.dumps(message).encode(), address)

    return send
