"""Notes on the processing of a log for the user, as data; the sentence is made where it is shown.

Each kind of note is a class. Its fields have the numbers, and in_words makes the sentence. In
JSON, a note is an object with these fields, and `kind` says which it is.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import asdict, dataclass
from typing import Annotated, Any, ClassVar, Literal

from pydantic import ConfigDict, Field

UNITS = {
    "delay": "s",
    "duration": "s",
    "longest": "s",
    "sample_interval": "s",
    "sample_period": "s",
    "step": "s",
    "t": "s",
}
"""Units of the fields of notes."""


@dataclass(frozen=True)
class Note(ABC):
    """Something that the user should know about a log."""

    __pydantic_config__: ClassVar[ConfigDict] = ConfigDict(extra="forbid")

    @property
    @abstractmethod
    def in_words(self) -> str:
        """The sentence for the user."""

    def as_dict(self) -> dict[str, Any]:
        """Returns kind and numbers of the note for JSON."""
        return asdict(self)


@dataclass(frozen=True, kw_only=True)
class Encoding(Note):
    """The text of the file is not UTF-8."""

    kind: Literal["encoding"] = "encoding"
    encoding: str

    @property
    def in_words(self) -> str:
        return f"read as {self.encoding}: the file is not UTF-8"


@dataclass(frozen=True, kw_only=True)
class RowOfUnits(Note):
    """A line below the names of the columns has their units."""

    kind: Literal["row_of_units"] = "row_of_units"
    line: int

    @property
    def in_words(self) -> str:
        return f"line {self.line} has the units of the columns"


@dataclass(frozen=True, kw_only=True)
class LinesAboveTable(Note):
    """Lines of text above the rows, other than the names of the columns, were left out."""

    kind: Literal["lines_above_table"] = "lines_above_table"
    lines: int

    @property
    def in_words(self) -> str:
        return f"{_lines(self.lines)} of text above the rows left out"


@dataclass(frozen=True, kw_only=True)
class CommentsLeftOut(Note):
    """Comments between the rows were left out."""

    kind: Literal["comments_left_out"] = "comments_left_out"
    lines: int

    @property
    def in_words(self) -> str:
        return f"{_lines(self.lines)} of comments between the rows left out"


@dataclass(frozen=True, kw_only=True)
class RepeatedName(Note):
    """A column has the name of an earlier column, and got a name of its own."""

    kind: Literal["repeated_name"] = "repeated_name"
    column: str  # name in the file
    renamed: str  # name that it has here

    @property
    def in_words(self) -> str:
        return f"column {self.column!r} is there again: it is called {self.renamed!r} here"


@dataclass(frozen=True, kw_only=True)
class LinesBelowTable(Note):
    """Lines of text below the rows, such as statistics of a test rig, were left out."""

    kind: Literal["lines_below_table"] = "lines_below_table"
    line: int  # the first of these lines in the file, from 1 on
    lines: int

    @property
    def in_words(self) -> str:
        return f"{_lines(self.lines)} below the rows, from line {self.line} on, left out: no rows"


@dataclass(frozen=True, kw_only=True)
class NamesAgain(Note):
    """The names of the columns stand between the rows: several recordings are in one file."""

    kind: Literal["names_again"] = "names_again"
    line: int  # the first of these lines in the file, from 1 on
    lines: int

    @property
    def in_words(self) -> str:
        again = "" if self.lines == 1 else f", the first of {self.lines} such lines"
        return (
            f"line {self.line} has the names of the columns again{again}: several recordings are "
            "in this file, and are read as one log"
        )


@dataclass(frozen=True, kw_only=True)
class PrefixLeftOut(Note):
    """Each line begins with the time at which a terminal received it."""

    kind: Literal["prefix_left_out"] = "prefix_left_out"
    prefix: str  # of the first line

    @property
    def in_words(self) -> str:
        return (
            f"the beginning of each line, such as {self.prefix!r}, left out: the clock of the "
            "terminal"
        )


@dataclass(frozen=True, kw_only=True)
class ThousandsSeparated(Note):
    """Numbers have a separator between thousands, such as 1.234,56."""

    kind: Literal["thousands_separated"] = "thousands_separated"
    example: str

    @property
    def in_words(self) -> str:
        return f"numbers such as {self.example} have separators of thousands, which were left out"


def _lines(count: int) -> str:
    return "1 line" if count == 1 else f"{count} lines"


@dataclass(frozen=True, kw_only=True)
class ShortRow(Note):
    """A row with too few values was left out."""

    kind: Literal["short_row"] = "short_row"
    values: int
    columns: int

    @property
    def in_words(self) -> str:
        return (
            f"a row with {self.values} of {self.columns} values was left out: the file may have "
            "been cut off"
        )


@dataclass(frozen=True, kw_only=True)
class Rows(Note):
    """How many rows became how many ticks."""

    kind: Literal["rows"] = "rows"
    rows: int
    duration: float  # from the first row to the last [s]
    ticks: int
    sample_period: float  # time between two ticks [s]

    @property
    def in_words(self) -> str:
        return (
            f"{self.rows} rows over {self.duration:.6g} s; "
            f"{self.ticks} ticks of {self.sample_period:g} s"
        )


@dataclass(frozen=True, kw_only=True)
class NoTimeColumn(Note):
    """The times of the rows were not recorded."""

    kind: Literal["no_time_column"] = "no_time_column"
    sample_period: float  # assumed time between two rows [s]

    @property
    def in_words(self) -> str:
        return f"no time column: rows taken as {self.sample_period:g} s apart"


@dataclass(frozen=True, kw_only=True)
class RepeatedTimes(Note):
    """Rows with the time of the row before were left out."""

    kind: Literal["repeated_times"] = "repeated_times"
    column: str  # with the times
    rows: int

    @property
    def in_words(self) -> str:
        return f"{self.column}: {self.rows} rows with the time of the row before left out"


@dataclass(frozen=True, kw_only=True)
class MissingTimes(Note):
    """Rows without a time were left out."""

    kind: Literal["missing_times"] = "missing_times"
    column: str  # with the times
    rows: int

    @property
    def in_words(self) -> str:
        return f"{self.column}: {self.rows} rows without a time left out"


@dataclass(frozen=True, kw_only=True)
class ClockStartedAgain(Note):
    """The clock of the times is a counter, which started again after its period."""

    kind: Literal["clock_started_again"] = "clock_started_again"
    column: str  # with the times
    times: int  # number of times that it started again
    period: float  # in the unit of the column
    unit: str  # of the column

    @property
    def in_words(self) -> str:
        return (
            f"{self.column}: the clock started again {self.times} times after "
            f"{self.period:.10g} {self.unit}; the times were continued"
        )


@dataclass(frozen=True, kw_only=True)
class ClockSetBack(Note):
    """The clock of the times stepped back, and ran on."""

    kind: Literal["clock_set_back"] = "clock_set_back"
    column: str  # with the times
    row: int  # from 1 on, the first after the step
    step: float  # [s]

    @property
    def in_words(self) -> str:
        return (
            f"{self.column}: the clock steps back by {self.step:.6g} s in row {self.row}; "
            "the rows from there on are taken as the time after a gap"
        )


@dataclass(frozen=True, kw_only=True)
class NoSignal(Note):
    """The column of a torque has one value in all rows."""

    kind: Literal["no_signal"] = "no_signal"
    port: str
    column: str
    value: float  # in the unit of the column

    @property
    def in_words(self) -> str:
        return f"{self.port}: {self.column} is {self.value:g} throughout"


@dataclass(frozen=True, kw_only=True)
class PlaceholderLeftOut(Note):
    """Rows with a placeholder instead of a sample were left out."""

    kind: Literal["placeholder_left_out"] = "placeholder_left_out"
    port: str
    column: str
    value: float  # in the unit of the column
    samples: int
    share: float  # of all values of the column [1]
    row: int  # the first, from 1 on

    @property
    def in_words(self) -> str:
        return (
            f"{self.port}: {self.samples} samples ({100 * self.share:.3g} %) of {self.column} are "
            f"{self.value:g} between values far from it, first in row {self.row}; left out"
        )


@dataclass(frozen=True, kw_only=True)
class HeldLeftOut(Note):
    """Rows that repeat an earlier sample while the joint moves were left out."""

    kind: Literal["held_left_out"] = "held_left_out"
    port: str
    column: str
    samples: int
    share: float  # of all values of the column [1]
    row: int  # the first, from 1 on

    @property
    def in_words(self) -> str:
        return (
            f"{self.port}: {self.samples} samples ({100 * self.share:.3g} %) of {self.column} "
            f"repeat the value before while the joint moves, first in row {self.row}; left out"
        )


@dataclass(frozen=True, kw_only=True)
class CounterReturned(Note):
    """A counter without a configured period jumped, and its values were joined."""

    kind: Literal["counter_returned"] = "counter_returned"
    port: str
    column: str
    jumps: int
    largest: float  # jump, in the unit of the column
    unit: str  # of the column, "" if it is the unit of the port
    period: float | None  # size of all jumps, in the unit of the column; None if they differ
    row: int  # the first after a jump, from 1 on

    @property
    def in_words(self) -> str:
        return (
            f"{self.port}: {self.column} jumps {self.jumps} times by up to "
            f"{self.largest:.6g} {self.unit}".rstrip()
            + f", first in row {self.row}, as a counter that starts again; the jumps were removed"
        )


@dataclass(frozen=True, kw_only=True)
class Unwrapped(Note):
    """The counter of a port started again."""

    kind: Literal["unwrapped"] = "unwrapped"
    port: str
    jumps: int  # number of times that it started again
    period: float  # in the unit of the column
    unit: str  # of the column, "" if it is the unit of the port

    @property
    def in_words(self) -> str:
        return f"{self.port}: unwrapped {self.jumps} times at {self.period:g} {self.unit}".rstrip()


@dataclass(frozen=True, kw_only=True)
class Delayed(Note):
    """The samples of a port were moved back by its delay."""

    kind: Literal["delayed"] = "delayed"
    port: str
    delay: float  # [s]

    @property
    def in_words(self) -> str:
        return f"{self.port}: moved back by {self.delay:g} s"


@dataclass(frozen=True, kw_only=True)
class Interpolated(Note):
    """Ticks of a port have values between two samples."""

    kind: Literal["interpolated"] = "interpolated"
    port: str
    ticks: int
    sample_interval: float | None
    """Usual time between two samples [s]; None if nearly every tick has a sample."""

    @property
    def in_words(self) -> str:
        apart = ""
        if self.sample_interval is not None:
            apart = f", its samples are {self.sample_interval:.3g} s apart"
        return f"{self.port}: {self.ticks} ticks interpolated{apart}"


@dataclass(frozen=True, kw_only=True)
class FasterThanTicks(Note):
    """A port has more samples than ticks."""

    kind: Literal["faster_than_ticks"] = "faster_than_ticks"
    port: str
    sample_interval: float  # usual time between two samples [s]

    @property
    def in_words(self) -> str:
        return f"{self.port}: faster than the ticks, samples between them left out, no filter"


@dataclass(frozen=True, kw_only=True)
class BetweenTicks(Note):
    """A port with a sample for nearly every tick has some samples between two ticks."""

    kind: Literal["between_ticks"] = "between_ticks"
    port: str
    samples: int

    @property
    def in_words(self) -> str:
        return f"{self.port}: {self.samples} samples between ticks"


@dataclass(frozen=True, kw_only=True)
class MissingSamples(Note):
    """Samples of a port are no numbers."""

    kind: Literal["missing_samples"] = "missing_samples"
    port: str
    samples: int

    @property
    def in_words(self) -> str:
        return f"{self.port}: {self.samples} samples missing or not finite"


@dataclass(frozen=True, kw_only=True)
class CounterInGap(Note):
    """A counter missed whole periods in gaps, which the other position shows."""

    kind: Literal["counter_in_gap"] = "counter_in_gap"
    port: str
    periods: int  # in the first of these gaps
    t: float  # begin of the first gap, since the start of the log [s]
    gaps: int  # number of such gaps

    @property
    def in_words(self) -> str:
        also = f" and during {self.gaps - 1} more" if self.gaps > 1 else ""
        return (
            f"{self.port}: {self.periods:+d} periods of its counter during the gap after "
            f"{self.t:.6g} s{also}, by the motion of the other encoder"
        )


@dataclass(frozen=True, kw_only=True)
class CounterAtStart(Note):
    """A counter was switched on in another turn."""

    kind: Literal["counter_at_start"] = "counter_at_start"
    port: str
    periods: int

    @property
    def in_words(self) -> str:
        return (
            f"{self.port}: {self.periods:+d} periods of its counter, "
            "so that the deformation is in range.phi"
        )


@dataclass(frozen=True, kw_only=True)
class SkippedTicks(Note):
    """The estimator skips ticks at which a value is missing or refused."""

    kind: Literal["skipped_ticks"] = "skipped_ticks"
    ticks: int
    gaps: int  # number of gaps that these ticks form
    longest: float  # duration of the longest gap [s]
    t: float  # begin of the longest gap, since the start of the log [s]

    @property
    def in_words(self) -> str:
        return (
            f"{self.ticks} ticks skipped in {self.gaps} gaps, the longest of {self.longest:.3g} s "
            f"at {self.t:.6g} s after the start; the estimator keeps its estimate over them"
        )


@dataclass(frozen=True, kw_only=True)
class FirstPart(Note):
    """Only the first part of a long log was used."""

    kind: Literal["first_part"] = "first_part"
    duration: float  # of this part [s]

    @property
    def in_words(self) -> str:
        return f"used the first {self.duration:g} s"


RecordingNote = Annotated[
    Encoding | RowOfUnits | LinesAboveTable | LinesBelowTable | CommentsLeftOut | NamesAgain
    | PrefixLeftOut | ThousandsSeparated | RepeatedName | ShortRow
    | Rows | NoTimeColumn | RepeatedTimes | MissingTimes | ClockStartedAgain | ClockSetBack
    | NoSignal | PlaceholderLeftOut | HeldLeftOut | CounterReturned
    | Unwrapped | Delayed | Interpolated | FasterThanTicks | BetweenTicks | MissingSamples
    | CounterInGap | CounterAtStart | SkippedTicks | FirstPart,
    Field(discriminator="kind"),
]  # fmt: skip
"""Any note on reading a log and on its samples at the ticks."""
