"""`estimate.json`: what the report of a log needs and no other file of the folder has."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path

from sigmahat.files.output import write_json
from sigmahat.joint.stored import NO_OTHER_KEYS, Format, Text


@dataclass(frozen=True)
class Replayed:
    """The contents of the file."""

    __pydantic_config__ = NO_OTHER_KEYS

    format: Text
    version: int
    log: Text
    """Path of the log, as it was given."""
    ticks: int
    """Of the estimator over the log."""
    skipped: int
    """Ticks without an estimate: a measurement was missing."""
    T: float
    """Time between ticks [s]."""
    notes: list[Text]
    """What had to be done to the samples of the log, in sentences."""


REPLAYED = Format("estimate.json", "sigmahat estimate", 1, Replayed)
"""Of the file."""


def write_replayed(
    log: Path, ticks: int, skipped: int, T: float, notes: Sequence[str], path: Path
) -> None:
    """Writes the file; the values are as in Replayed."""
    contents = Replayed(REPLAYED.name, REPLAYED.version, str(log), ticks, skipped, T, list(notes))
    write_json(asdict(contents), path)
