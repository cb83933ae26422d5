"""What the user and other programs should know of a stream, as data; the sentence is made where it
is shown.

Each kind of event is a class. Its fields have the numbers, and in_words makes the sentence.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from typing import Any, ClassVar

from sigmahat.files.output import finite


@dataclass(frozen=True, kw_only=True)
class Event(ABC):
    """Something that happened in a stream at one time."""

    kind: ClassVar[str]
    is_warning: ClassVar[bool] = True  # whether the user may have to do something
    t: float  # time as the sender counts it [s]

    @property
    @abstractmethod
    def in_words(self) -> str:
        """The sentence for the user."""

    def shown(self) -> dict[str, Any]:
        """Returns kind, fields and sentence for JSON, which has no nan and no infinity."""
        found: dict[str, Any] = finite({"kind": self.kind, **asdict(self), "text": self.in_words})
        return found


@dataclass(frozen=True, kw_only=True)
class NoData(Event):
    """No message has arrived for a while."""

    kind: ClassVar[str] = "no_data"
    duration: float  # until now [s]

    @property
    def in_words(self) -> str:
        return f"no data for {in_seconds(self.duration)}; does the sender run?"


@dataclass(frozen=True, kw_only=True)
class DataAgain(Event):
    """The estimators have data again, after NoData."""

    kind: ClassVar[str] = "data_again"
    is_warning: ClassVar[bool] = False
    duration: float  # of the silence [s]

    @property
    def in_words(self) -> str:
        return f"data again, after {in_seconds(self.duration)} without"


@dataclass(frozen=True, kw_only=True)
class FieldsMissing(Event):
    """Messages arrive without fields that the configuration names."""

    kind: ClassVar[str] = "fields_missing"
    fields: Sequence[str]  # columns of the configuration
    messages: int  # number of the last messages without these fields
    duration: float | None  # since these fields came last [s]; None: they never came

    @property
    def in_words(self) -> str:
        names = _named(self.fields)
        if self.duration is None:
            return f"none of {self.messages} messages has {names}, which the configuration names"
        return f"no {names} for {in_seconds(self.duration)}, while messages arrive"


@dataclass(frozen=True, kw_only=True)
class FieldsAgain(Event):
    """Fields that were missing are in the messages again."""

    kind: ClassVar[str] = "fields_again"
    is_warning: ClassVar[bool] = False
    fields: Sequence[str]

    @property
    def in_words(self) -> str:
        return f"{_named(self.fields)} again"


@dataclass(frozen=True, kw_only=True)
class SenderRestarted(Event):
    """The times of the sender have jumped, and another recording has begun."""

    kind: ClassVar[str] = "sender_restarted"
    jump: float  # of the times [s]; below 0 if they started again, above 0 after a pause

    @property
    def in_words(self) -> str:
        what = "has started again" if self.jump <= 0 else "has paused, or started again"
        return (
            f"the sender {what}: its time jumped by {self.jump:+.1f} s to {self.t:.1f} s; what was "
            "learned stays, and another recording begins"
        )


@dataclass(frozen=True, kw_only=True)
class StiffnessChanged(Event):
    """The estimator has detected a change; a second event has the size, as soon as it is known."""

    kind: ClassVar[str] = "stiffness_changed"
    joint: str
    changed_at: float  # time of the change, as the sender counts it [s]
    relative: float | None
    """Relative difference of the confident estimates before and after the change [1], if known."""

    @property
    def in_words(self) -> str:
        size = "" if self.relative is None else f" by {100 * self.relative:+.0f} %"
        return f"{self.joint}: the stiffness changed{size} at {self.changed_at:.1f} s"


@dataclass(frozen=True, kw_only=True)
class LimitPassed(Event):
    """The stiffness has changed by more than the user allows, since the logs of `health`."""

    kind: ClassVar[str] = "limit_passed"
    joint: str
    limit: float  # relative change that is allowed [1]
    relative: float  # change since the first logs [1]
    half_width: float  # half of its 95 % interval [1]
    probability: float  # that the limit is passed [1]

    @property
    def in_words(self) -> str:
        change = f"{100 * self.relative:+.2g} +- {100 * self.half_width:.2g} %"
        return (
            f"{self.joint}: the limit of the stiffness, {100 * self.limit:+g} %, is passed: "
            f"{change} since the first logs"
        )


@dataclass(frozen=True, kw_only=True)
class Unreadable(Event):
    """The first message that cannot be read; more are only counted."""

    kind: ClassVar[str] = "unreadable"
    reason: str  # what was expected and what came

    @property
    def in_words(self) -> str:
        return f"a message that cannot be read: {self.reason}; more are counted"


@dataclass(frozen=True, kw_only=True)
class NotWritten(Event):
    """A file cannot be written, such as the recording on a full disk."""

    kind: ClassVar[str] = "not_written"
    what: str  # the file
    reason: str

    @property
    def in_words(self) -> str:
        return f"not written: {self.what} ({self.reason}); the estimates go on"


@dataclass(frozen=True, kw_only=True)
class SamplesApart(Event):
    """The samples of a joint are too far apart for its ticks."""

    kind: ClassVar[str] = "samples_apart"
    joint: str
    interval: float  # usual time between two samples [s]
    longest_gap: float  # that is interpolated [s]

    @property
    def in_words(self) -> str:
        return (
            f"{self.joint}: samples are {self.interval:.3g} s apart, and at most "
            f"{self.longest_gap:.3g} s are interpolated: set samplePeriod, or time.longest_gap"
        )


@dataclass(frozen=True, kw_only=True)
class StampsRepeated(Event):
    """Many samples have the stamp of the sample before, and are left out."""

    kind: ClassVar[str] = "stamps_repeated"
    column: str  # with the stamps
    left_out: int  # number of samples
    samples: int  # number of the last samples, with those left out

    @property
    def in_words(self) -> str:
        return (
            f"{self.column}: {self.left_out} of {self.samples} messages have the time of the one "
            "before and are left out: send finer times, or leave time.column out of the "
            "configuration (then the time of arrival counts)"
        )


@dataclass(frozen=True, kw_only=True)
class PositionJumped(Event):
    """A position has jumped as no joint can."""

    kind: ClassVar[str] = "position_jumped"
    joint: str
    port: str  # theta or q
    jump: float  # from one tick to the next [rad]
    usual: float  # largest step between two ticks before [rad]

    @property
    def in_words(self) -> str:
        return (
            f"{self.joint}: {self.port} jumps by {self.jump:.3g} rad in one tick, before by at "
            f"most {self.usual:.3g} rad: another unit, a counter that starts again, or a failed "
            "reading? Not confident until it is back; if the new values are right, start live "
            "again"
        )


def in_seconds(duration: float) -> str:
    """Returns a duration [s] in words: whole seconds, and tenths of the first second."""
    return f"{duration:.0f} s" if duration >= 1 else f"{duration:.1f} s"


def _named(fields: Sequence[str]) -> str:
    return ", ".join(map(repr, fields))
