"""Runs the on-line loop: passes messages to the session, and what it finds to the sinks."""

import time
from collections.abc import Callable, Sequence
from functools import partial
from queue import Empty, Full, Queue
from typing import NamedTuple

from sigmahat.fmi.interrupts import ENDS, handling
from sigmahat.live.events import Event, SamplesApart, StampsRepeated, Unreadable
from sigmahat.live.live_joint import News
from sigmahat.live.messages import Columns
from sigmahat.live.session import Session
from sigmahat.live.silence import Silence

_IDLE = 0.1  # [s] until a signal is seen
_FIRST = 100  # number of messages until their times are looked at
_REPEATED = 0.1  # fraction of messages with the time of the one before that is said
_MOST = 1 << 25  # bytes of all messages that wait
_OVERHEAD = 1000  # bytes that a message needs besides its contents

Reader = Callable[[], Columns | None]
"""Gives the columns of a message; None for a message without columns. Raises ValueError if the
message is not readable, and EOFError after the last message."""
Sink = Callable[[Sequence[News]], None]  # sends on what is new: estimates and events


class Message(NamedTuple):
    arrival: int  # [ns] since 1970; of a replayed log, the time in the log
    received: float  # by the clock that never jumps [s]
    read: Reader
    size: int = 0  # memory [bytes]


class Inbox(Queue[Message]):
    """Queue of received messages, whose size is the memory of all of them."""

    def __init__(self, clock: Callable[[], float] = time.monotonic) -> None:
        """clock  gives the time of this computer [s], which never jumps"""
        super().__init__(_MOST)
        self.now = clock
        self.read = self.wrong = self.dropped = 0
        """Numbers of messages: read, not readable, and lost because the inbox was full."""
        self.failure: Exception | None = None  # why the source has ended before its data did

    def add(
        self, read: Reader, size: int = 0, can_wait: bool = True, arrival: int | None = None
    ) -> None:
        """size  of the contents [bytes]; can_wait  whether the sender waits for a place; else the
        message may be lost
        """
        arrival = time.time_ns() if arrival is None else arrival
        try:
            self.put(Message(arrival, self.now(), read, size + _OVERHEAD), can_wait)
        except Full:
            self.dropped += 1

    def end(self, failure: Exception | None = None) -> None:
        """Ends the loop, after the messages that wait."""
        self.add(partial(self._ended, failure))

    def _ended(self, failure: Exception | None) -> None:
        self.failure = failure
        raise EOFError

    # As subclasses of Queue may, these methods define how much is in it.
    def _init(self, maxsize: int) -> None:
        self._bytes = 0
        super()._init(maxsize)

    def _qsize(self) -> int:
        return self._bytes

    def _put(self, item: Message) -> None:
        self._bytes += item.size
        super()._put(item)

    def _get(self) -> Message:
        item = super()._get()
        self._bytes -= item.size
        return item


Source = Callable[[Inbox], None]
"""Puts messages into the inbox until the data end; UDP, TCP and ROS 2 do not end."""


def receive(source: Source, inbox: Inbox) -> None:
    """Runs a source, in a thread of its own. The loop ends when the source ends, or fails."""
    try:
        source(inbox)
    except Exception as error:  # of a library; a thread that dies in silence helps nobody
        inbox.end(error)
    else:
        inbox.end()


class Loop:
    """Takes messages one after the other, and tells all sinks what is new."""

    def __init__(self, session: Session, inbox: Inbox, sinks: Sequence[Sink]) -> None:
        self._session, self._inbox, self._sinks = session, inbox, sinks
        self._silence = Silence(session.joints, session.columns, inbox.now())
        self._double = dict.fromkeys(session.clocks, 0)  # times that repeat, when last looked at
        self._repeated_told: set[str] = set()

    def take(self, message: Message) -> None:
        """Takes the next message. Raises EOFError after the last one."""
        try:
            columns = message.read()
        except ValueError as error:
            self._inbox.wrong += 1
            if self._inbox.wrong == 1:
                t = self._silence.time(message.received)
                self._tell([Unreadable(t=t, reason=str(error))])
            return
        self._inbox.read += 1
        if columns is None:
            return
        now = message.received
        passed = self._silence.passed(now)
        of_fields = self._silence.message(columns, now)
        found = self._session.take(columns, message.arrival)
        told = [*passed, *of_fields, *self._silence.news(found, now)]
        if self._inbox.read == _FIRST:
            told += self._samples_apart(now)
        if self._inbox.read % _FIRST == 0:
            told += self._stamps_repeated(now)
        self._tell(told)

    def wait(self) -> None:
        """Says what is to be said, and saves what is to be saved, if no message waits."""
        self._tell([*self._silence.passed(self._inbox.now()), *self._session.save()])

    def end(self) -> None:
        self._tell(self._silence.rest(self._session.close(), self._inbox.now()))

    def _tell(self, news: Sequence[News]) -> None:
        if news:
            for send in self._sinks:
                send(news)

    def _samples_apart(self, now: float) -> list[Event]:
        """Returns the first joint whose samples are too far apart."""
        for joint in self._session.joints:
            usual = self._session.clocks[joint.time_column("")].usual
            if usual > joint.longest_gap:
                t, gap = self._silence.time(now), joint.longest_gap
                return [SamplesApart(t=t, joint=joint.name, interval=usual, longest_gap=gap)]
        return []

    def _stamps_repeated(self, now: float) -> list[Event]:
        """Returns the time columns that repeat in the last messages, each of them once."""
        events: list[Event] = []
        for column, clock in self._session.clocks.items():
            left_out = clock.double - self._double[column]
            self._double[column] = clock.double
            if left_out > _REPEATED * _FIRST and column not in self._repeated_told:
                self._repeated_told.add(column)
                t = self._silence.time(now)
                events.append(StampsRepeated(t=t, column=column, left_out=left_out, samples=_FIRST))
        return events


def watch(session: Session, inbox: Inbox, sinks: Sequence[Sink]) -> None:
    """Runs the estimators until the last message, or until a signal that ends a program.

    An event shows the first message that cannot be read; all such messages are counted.
    """
    loop = Loop(session, inbox, sinks)
    # A second signal does not interrupt the writing of files.
    stopped: list[int] = []
    with handling(lambda number, _: stopped.append(number), *ENDS):
        while not stopped:
            try:
                message = inbox.get(timeout=_IDLE)
            except Empty:
                loop.wait()
                continue
            try:
                loop.take(message)
            except EOFError:
                break
        loop.end()
