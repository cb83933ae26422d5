"""Sources and sinks by their names on the command line."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property, partial
from pathlib import Path
from typing import TYPE_CHECKING

from sigmahat.live import sinks, sources
from sigmahat.live.messages import Decoder
from sigmahat.live.session import Session
from sigmahat.live.sinks import Sink
from sigmahat.live.sources import Source
from sigmahat.logs.readers.formats import open_log

if TYPE_CHECKING:
    from sigmahat.live.ros2 import Ros2

_LOOPBACK, _FOXGLOVE = "127.0.0.1", "8765"


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
            raise ValueError(f"--columns lacks {', '.join(lacking)}, which the configuration names")
        decoder = partial(Decoder, wanted, titles)
        kind, _, port = name.partition(":")
        if name == "ros2":
            return self._ros2.joint_states(wanted)
        if name == "stdin":
            return sources.stdin(decoder)
        if kind not in ("udp", "tcp"):
            raise ValueError(f"--from: expected udp:PORT, tcp:PORT, stdin or ros2, got {name!r}")
        listen = sources.tcp if kind == "tcp" else sources.udp
        try:
            return listen((self._host, _address("--from", port)[1]), decoder)
        except OSError as error:
            raise self._cannot_listen(name, error.strerror or error) from error

    def replay(self, log: Path) -> Source:
        """The source for a recorded log."""
        return sources.replay(open_log(log), self._session)

    def sink(self, name: str) -> Sink:
        """The sink of this name; for Foxglove, the layout is also written."""
        kind, _, rest = name.partition(":")
        if name == "ros2":
            return self._ros2.publish()
        if kind == "udp":
            return sinks.udp(_address("--to", rest))
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


def _address(option: str, text: str) -> tuple[str, int]:
    host, _, port = text.rpartition(":")
    if not port.isdecimal() or not 0 < int(port[:9]) < 1 << 16:
        raise ValueError(f"{option}: expected a port from 1 to 65535, got {text!r}")
    return host or _LOOPBACK, int(port)
