"""What a learned state and a data sheet both say: which FMU, and which logs."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

from pydantic import ConfigDict, Strict

from sigmahat.fmi.instance import Fmu

NO_OTHER_KEYS = ConfigDict(extra="forbid")
Text = Annotated[str, Strict()]
Range = tuple[float, float]
"""Least and largest value."""


@dataclass(frozen=True)
class LearnedLog:
    """A log that was learned from."""

    __pydantic_config__ = NO_OTHER_KEYS

    file: Text
    """Its path, as it was given."""
    sha256: Text
    """Of the file; of a folder see files/digest.py."""
    ticks: int
    """Of the estimator over the log."""
    skipped: int
    """Ticks that were skipped."""
    phi: Range | None
    """Deformation at the samples that the regression used [rad]; None if it used none."""
    set_point: Range | None
    """The same of the set-point [1]."""


@dataclass(frozen=True)
class FmuId:
    """Which FMU something belongs to."""

    __pydantic_config__ = NO_OTHER_KEYS

    name: Text
    version: Text
    guid: Text

    @staticmethod
    def of(fmu: Fmu) -> FmuId:
        """That of an FMU."""
        return FmuId(fmu.name, fmu.description.version or "", fmu.description.guid)
