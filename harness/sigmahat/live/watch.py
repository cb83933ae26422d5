"""The loop: messages from the inbox through the session to the sinks, until it is stopped."""

from __future__ import annotations

import logging
import signal
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from types import FrameType

from sigmahat.live.session import Session
from sigmahat.live.sinks import Sink
from sigmahat.live.sources import Inbox

_log = logging.getLogger("sigmahat")
_IDLE = 0.1  # [s] until a signal is seen


@dataclass
class Counted:
    """What was received."""

    messages: int = 0
    """That were read."""
    wrong: int = 0
    """That could not be read."""


def watch(session: Session, inbox: Inbox, sinks: Sequence[Sink]) -> Counted:
    """Estimates until the messages end, or until Ctrl-C or SIGTERM.

    The first message that cannot be read is named in a warning; all of them are counted.
    """
    counted = Counted()
    with _stopped_by_signal() as stopped:
        while not stopped and not inbox.is_at_end:
            received = inbox.next(_IDLE)
            if received is None:
                continue
            try:
                columns = received.read()
            except ValueError as error:
                counted.wrong += 1
                if counted.wrong == 1:
                    _log.warning("a message that cannot be read: %s; more are counted", error)
                continue
            counted.messages += 1
            if columns is None:
                continue
            ticks = session.take(columns, received.arrival)
            if ticks:
                for send in sinks:
                    send(ticks)
        last = session.close()
        for send in sinks:
            send(last)
    return counted


@contextmanager
def _stopped_by_signal() -> Iterator[list[int]]:
    """The signals that were received: a second one does not spoil what is being written."""
    stopped: list[int] = []
    before = {each: signal.getsignal(each) for each in (signal.SIGINT, signal.SIGTERM)}

    def stop(number: int, _frame: FrameType | None) -> None:
        stopped.append(number)

    for each in before:
        signal.signal(each, stop)
    try:
        yield stopped
    finally:
        for each, handler in before.items():
            signal.signal(each, handler)
