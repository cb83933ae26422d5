"""A job of the engine, one run of a plan, and its outcome: rows of numbers."""

import hashlib
import inspect
import json
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import lru_cache, partial
from pathlib import Path
from typing import Any

from sigmahat.fmi.installed import fmu as installed_fmu
from sigmahat.fmi.master import Recording

Numbers = Mapping[str, float]
"""Numbers by name."""


@dataclass(frozen=True)
class Outcome:
    """What one run gives."""

    rows: Mapping[str, Numbers]
    """Numbers, by what they are about: a comparison of a scenario, or a method."""
    failures: Mapping[str, str] = field(default_factory=dict)
    """Reasons why a row is missing, by what it would be about."""
    recording: Recording | None = None
    """Signals of the run, for a plan that draws them."""

    @property
    def is_recorded(self) -> bool:
        """Whether a record replaces the run. A run that failed may succeed another time."""
        return not self.failures and self.recording is None


@dataclass(frozen=True)
class Job:
    """One run of a plan, an entry with a seed, as data for another process or machine."""

    run: partial[Outcome]
    """A function that other processes can import, with its arguments."""
    fmus: tuple[str, ...]
    """Names of the FMUs that determine the result."""
    about: tuple[Any, ...]
    """What is run, as values for JSON: equal values give equal results."""
    effort: float = 1.0
    """Expected duration, in a unit that all jobs of a plan share."""

    @property
    def identity(self) -> str:
        """A digest of what is run, with which FMUs and by which plan: it identifies the result."""
        digests = (_digest_of_fmus(self.fmus), _digest_of_plan(self.run.func))
        text = json.dumps([*digests, *self.about], sort_keys=True)
        return hashlib.sha256(text.encode()).hexdigest()


@lru_cache
def _digest_of_fmus(names: tuple[str, ...]) -> str:
    """Computes a digest of the installed FMUs."""
    text = hashlib.sha256()
    for name in names:
        text.update(installed_fmu(name).read_bytes())
    return text.hexdigest()


@lru_cache
def _digest_of_plan(function: Callable[..., Outcome]) -> str:
    """Computes a digest of the file of a function and of the Python files beside it."""
    text = hashlib.sha256()
    for path in sorted(Path(inspect.getfile(function)).parent.glob("*.py")):
        text.update(path.read_bytes())
    return text.hexdigest()
