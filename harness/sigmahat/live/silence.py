"""Notices that data stop: all of them, those of one joint, or single fields of the messages.

The times are those of a clock of this computer that never jumps, at which the messages arrived. So
a message that had to wait for the estimator is not late.
"""

import math
from collections.abc import Sequence

from sigmahat.live.events import (
    DataAgain,
    Event,
    FieldsAgain,
    FieldsMissing,
    NoData,
    SenderRestarted,
)
from sigmahat.live.live_joint import Estimated, LiveJoint, News
from sigmahat.live.messages import Columns

_PERIODS, _SHORTEST = 3.0, 0.5  # periods, and seconds, of silence until it is said
_AT_START = 5.0  # [s] until the first message
_AGAIN = 0.5  # [s] between two messages about a silent joint
_FIRST, _FEW = 100, 3  # messages without a field that never came, or came before
_FORGETS = 0.99  # per sample, the longest interval between two samples
_CHECK = 0.1  # [s] between two looks at the clock


class _Field:
    """When one column of the messages had values."""

    def __init__(self, name: str, longest_gap: float) -> None:
        self.name = name
        self.seen: float | None = None  # time of the last value [s]
        self.absent = 0  # number of messages since then
        self.is_missing = False
        self._longest_gap = longest_gap
        self._interval = 0.0  # longest time between two values of late [s]

    @property
    def patience(self) -> float:
        """Time without a value that is no silence [s]."""
        return max(_SHORTEST, _PERIODS * self._interval, self._longest_gap)

    def has_value(self, now: float) -> None:
        if self.seen is not None:
            step = now - self.seen
            if step > _SHORTEST:
                # A pause counts little: the next one has to be noticed nearly as soon.
                step = min(step, self.patience)
            self._interval = max(step, _FORGETS * self._interval)
        self.wait_again(now)

    def wait_again(self, now: float) -> None:
        """Waits for the next value as if there had been one now."""
        self.seen, self.absent = now, 0

    def is_overdue(self, now: float) -> bool:
        """Whether a message at this time shows that the values have stopped."""
        if self.seen is None:
            return self.absent >= _FIRST
        return self.absent >= _FEW and now - self.seen > self.patience


class _Joint:
    """When one joint had a tick with data."""

    def __init__(self, fields: Sequence[_Field]) -> None:
        self._fields = fields
        self.last: Estimated | None = None
        self.heard = 0.0  # time of the last tick with data [s]
        self.said = -math.inf  # time of the last message that there are no data [s]

    def is_silent(self, now: float) -> bool:
        return now - self.heard > max(each.patience for each in self._fields)


class Silence:
    """The silence of a session, and of its joints and columns."""

    def __init__(self, joints: Sequence[LiveJoint], columns: Sequence[str], now: float) -> None:
        """columns  those of the messages that are used; now  time of the begin [s]"""
        gaps = {name: [j.longest_gap for j in joints if name in j.columns] for name in columns}
        self._fields = {name: _Field(name, max(of, default=0.0)) for name, of in gaps.items()}
        self._joints = {
            j.name: _Joint([self._fields[name] for name in j.columns if name]) for j in joints
        }
        self._begin = now
        self._message: float | None = None  # time of the last message [s]
        self._stopped: float | None = None  # time of the last message before a silence [s]
        self._newest = 0.0, now  # time of a tick with data, for the sender and here [s]
        self._check = now

    def message(self, columns: Columns, now: float) -> list[Event]:
        """Looks at the fields of a message. Returns those that are missing or back, at once."""
        gap = 0.0 if self._message is None else now - self._message
        was_silent = gap > _SHORTEST and gap > self._patience
        self._message = now
        stopped: list[_Field] = []
        never: list[_Field] = []
        again: list[_Field] = []
        for name, field in self._fields.items():
            if math.isfinite(columns.get(name, math.nan)):
                if field.is_missing:
                    again.append(field)
                field.is_missing = False
                field.has_value(now)
                continue
            field.absent += 1
            if was_silent and field.seen is not None:
                field.wait_again(now)
            if not field.is_missing and field.is_overdue(now):
                field.is_missing = True
                (never if field.seen is None else stopped).append(field)
        events: list[Event] = [self._missing(of, now) for of in (never, stopped) if of]
        if again:
            events.append(FieldsAgain(t=self.time(now), fields=[each.name for each in again]))
        return events

    def _missing(self, fields: Sequence[_Field], now: float) -> Event:
        """fields  those that never came, or those that have stopped"""
        seen = [each.seen for each in fields if each.seen is not None]
        return FieldsMissing(
            t=self.time(now),
            fields=[each.name for each in fields],
            messages=min(each.absent for each in fields),
            duration=now - max(seen) if seen else None,
        )

    def news(self, found: Sequence[News], now: float) -> list[News]:
        """Returns the news of a message, of which no tick of a silent joint is confident."""
        told: list[News] = []
        for each in found:
            if isinstance(each, SenderRestarted):
                self._start_again(now)
            if not isinstance(each, Estimated):
                told.append(each)
                continue
            joint = self._joints[each.joint]
            if each.outputs["valid"]:
                self._newest = each.t, now
                if self._stopped is not None:
                    told.append(DataAgain(t=each.t, duration=now - self._stopped))
                    self._stopped = None
            if each.outputs["valid"] or joint.last is None:
                joint.heard = now
            joint.last = each
            if joint.is_silent(now):
                joint.said = now
                each = each.without_data(each.t, now - joint.heard)
            told.append(each)
        return told

    def rest(self, found: Sequence[News], now: float) -> list[News]:
        """Returns the last news of a session, of which no tick of a silent joint is confident."""
        told: list[News] = []
        for each in found:
            if isinstance(each, Estimated) and self._joints[each.joint].is_silent(now):
                each = each.without_data(each.t, now - self._joints[each.joint].heard)
            told.append(each)
        return told

    def passed(self, now: float) -> list[News]:
        """Returns what is to be said because time has passed: silence, and its duration."""
        if now < self._check:
            return []
        self._check = now + _CHECK
        told: list[News] = []
        since = self._begin if self._message is None else self._message
        patience = _AT_START if self._message is None else self._patience
        if self._stopped is None and now - since > patience:
            self._stopped = since
            told.append(NoData(t=self.time(now), duration=now - since))
        for joint in self._joints.values():
            if joint.last is None or not joint.is_silent(now) or now - joint.said < _AGAIN:
                continue
            joint.said = now
            told.append(joint.last.without_data(self.time(now), now - joint.heard))
        return told

    @property
    def _patience(self) -> float:
        """Time without any message that is no silence [s]."""
        return max(each.patience for each in self._fields.values())

    def _start_again(self, now: float) -> None:
        """The restart of a sender ends its silence: there is no need to say this, too."""
        self._stopped = None
        for field in self._fields.values():
            if field.seen is not None:
                field.wait_again(now)

    def time(self, now: float) -> float:
        """Returns the time as the sender would count it now [s]."""
        t, here = self._newest
        return t + now - here
