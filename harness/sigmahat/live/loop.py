"""Runs the on-line loop: passes messages to the session, and estimates to the sinks."""

import logging
import shutil
import signal
import sys
import time
from collections.abc import Callable, Sequence, Set
from queue import Empty, Full, Queue

import click

from sigmahat.files.tables import aligned
from sigmahat.fmi.interrupts import handling
from sigmahat.live.live_joint import Estimated
from sigmahat.live.messages import Columns
from sigmahat.live.session import Session
from sigmahat.result.curve import NORMAL_95

_log = logging.getLogger("sigmahat")
_IDLE = 0.1  # [s] until a signal is seen
_SILENT = 5.0  # [s] without a message until a warning
_FIRST = 100  # number of messages until warnings about these messages
_MOST = 20_000  # messages that wait
_EVERY, _RARELY = 0.5, 10.0  # [s] between two updates in a terminal, and in other outputs

Reader = Callable[[], Columns | None]
"""Gives the columns of a message; None for a message without columns. Raises ValueError if the
message is not readable, and EOFError after the last message."""
Sink = Callable[[Sequence[Estimated]], None]  # sends the ticks of one message on


class Inbox(Queue[tuple[int, Reader]]):
    """Queue of received messages, each with its time of arrival [ns] since 1970."""

    def __init__(self) -> None:
        super().__init__(_MOST)
        self.read = self.wrong = self.dropped = 0
        """Numbers of messages: read, not readable, and lost because the inbox was full."""

    def add(self, read: Reader, can_wait: bool = True, arrival: int | None = None) -> None:
        """can_wait  whether the sender waits for a place; else the message may be lost"""
        try:
            self.put((time.time_ns() if arrival is None else arrival, read), can_wait)
        except Full:
            self.dropped += 1


Source = Callable[[Inbox], None]
"""Puts messages into the inbox until the data end; UDP, TCP and ROS 2 do not end."""


def watch(session: Session, inbox: Inbox, sinks: Sequence[Sink]) -> None:
    """Runs the estimators until the last message, or until Ctrl-C or SIGTERM.

    A warning shows the first message that cannot be read; all such messages are counted.
    """
    seen = set[str]()
    silent_at = time.monotonic() + _SILENT
    # A second signal does not interrupt the writing of files.
    stopped: list[int] = []
    with handling(lambda number, _: stopped.append(number), signal.SIGINT, signal.SIGTERM):
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
                inbox.wrong += 1
                if inbox.wrong == 1:
                    _log.warning("a message that cannot be read: %s; more are counted", error)
                continue
            inbox.read += 1
            if columns is None:
                continue
            if inbox.read <= _FIRST:
                seen.update(columns)
            if inbox.read == _FIRST:
                _look(session, seen)
            if ticks := session.take(columns, arrival):
                for send in sinks:
                    send(ticks)
        last = session.close()
        for send in sinks:
            send(last)


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


def terminal() -> Sink:
    """Creates a sink that prints the last estimate of each joint in a line on stderr."""
    last: dict[str, Estimated] = {}
    is_terminal = sys.stderr.isatty()
    shown_at, shown = time.monotonic(), 0

    def show(ticks: Sequence[Estimated]) -> None:
        nonlocal shown_at, shown
        last.update({each.joint: each for each in ticks})
        now = time.monotonic()
        if not last or now - shown_at <= (_EVERY if is_terminal else _RARELY):
            return
        shown_at = now
        lines = [line.rstrip() for line in aligned([_row(each) for each in last.values()])]
        if is_terminal:
            width = shutil.get_terminal_size().columns - 1
            lines = [f"{line[:width]}\033[K" for line in lines]
            lines[0] = (f"\033[{shown}F" if shown else "") + lines[0]
        click.echo("\n".join(lines), err=True)
        shown = len(lines)

    return show


def _row(last: Estimated) -> tuple[str, ...]:
    outputs = last.outputs
    doubt = outputs["doubt"]
    return (
        last.joint,
        f"{last.t:.1f} s",
        f"{outputs['sigma']:.4g} +- {NORMAL_95 * outputs['sigma_std']:.2g} N.m/rad",
        f"{outputs['tau_e']:.3g} N.m at {outputs['phi']:.3g} rad",
        "confident" if doubt == "None" else f"not confident ({doubt})",
    )
