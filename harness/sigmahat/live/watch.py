"""The loop: messages from the inbox through the session to the sinks, until it is stopped."""

from __future__ import annotations

import logging
import signal
import time
from collections.abc import Iterator, Sequence, Set
from contextlib import contextmanager
from dataclasses import dataclass
from queue import Empty
from types import FrameType

from sigmahat.live.session import Session
from sigmahat.live.sinks import Sink
from sigmahat.live.sources import Inbox

_log = logging.getLogger("sigmahat")
_IDLE = 0.1  # [s] until a signal is seen
_SILENT = 5.0  # [s] without a message until a warning
_FIRST = 100  # number of messages until warnings about these messages


@dataclass
class Counted:
    """Numbers of received messages."""

    messages: int = 0
    """Messages that were read."""
    wrong: int = 0
    """Messages that could not be read."""


def watch(session: Session, inbox: Inbox, sinks: Sequence[Sink]) -> Counted:
    """Estimates until the messages end, or until Ctrl-C or SIGTERM.

    A warning shows the first message that cannot be read; all such messages are counted.
    """
    counted, seen = Counted(), set[str]()
    silent_at = time.monotonic() + _SILENT
    with _stopped_by_signal() as stopped:
        while not stopped:
            try:
                arrival, read = inbox.get(timeout=_IDLE)
            except Empty:
                if time.monotonic() > silent_at:
                    _log.warning("nothing has arrived in %g s; does the sender run?", _SILENT)
                    silent_at = float("inf")
                continue
            silent_at = float("inf")
            try:
                columns = read()
            except EOFError:
                break
            except ValueError as error:
                counted.wrong += 1
                if counted.wrong == 1:
                    _log.warning("a message that cannot be read: %s; more are counted", error)
                continue
            counted.messages += 1
            if columns is None:
                continue
            if counted.messages <= _FIRST:
                seen.update(columns)
            if counted.messages == _FIRST:
                _look(session, seen)
            if ticks := session.take(columns, arrival):
                for send in sinks:
                    send(ticks)
        last = session.close()
        for send in sinks:
            send(last)
    return counted


def _look(session: Session, seen: Set[str]) -> None:
    """Warns of columns that no message has, and of samples that are too far apart."""
    for name in session.columns:
        if name not in seen:
            _log.warning("none of %d messages has %r, which the configuration names", _FIRST, name)
    for joint in session.joints:
        usual = session.clocks[joint.time_column("")].usual
        if usual > joint.longest_gap:
            _log.warning(
                "samples are %.3g s apart, and at most %.3g s are interpolated: set samplePeriod, "
                "or time.longest_gap", usual, joint.longest_gap,
            )  # fmt: skip
            return


@contextmanager
def _stopped_by_signal() -> Iterator[list[int]]:
    """The signals that were received: a second signal does not interrupt the writing of files."""
    stopped: list[int] = []

    def stop(number: int, _frame: FrameType | None) -> None:
        stopped.append(number)

    before = {each: signal.signal(each, stop) for each in (signal.SIGINT, signal.SIGTERM)}
    try:
        yield stopped
    finally:
        for each, handler in before.items():
            signal.signal(each, handler)
