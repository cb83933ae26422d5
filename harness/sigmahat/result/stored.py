"""Reads the JSON files of `sigmahat estimate`, and defines their formats and common records."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, Generic, TypeVar

from pydantic import ConfigDict, Strict, TypeAdapter, ValidationError

from sigmahat.fmi.model import Model

NO_OTHER_KEYS = ConfigDict(extra="forbid")
Text = Annotated[str, Strict()]
Range = tuple[float, float]  # least and largest value


@dataclass(frozen=True)
class LearnedLog:
    """A log that the estimator has processed."""

    __pydantic_config__ = NO_OTHER_KEYS

    file: Text  # path of the log, as given by the user
    sha256: Text  # SHA-256 of the file; for a folder see files/output.py
    ticks: int  # number of ticks of the estimator in the log
    skipped: int  # ticks that were skipped
    phi: Range | None
    """Deformation at the samples that the regression used [rad]; None without such samples."""
    set_point: Range | None  # set-point at these samples [1]; None without such samples


@dataclass(frozen=True)
class FmuId:
    """Identity of an FMU."""

    __pydantic_config__ = NO_OTHER_KEYS

    name: Text
    version: Text
    guid: Text

    @staticmethod
    def of(model: Model) -> FmuId:
        """Returns the identity of the FMU of a model."""
        return FmuId(model.name, model.description.version or "", model.description.guid)


_Contents = TypeVar("_Contents")
_AGAIN = "run `sigmahat estimate` again"


def wrong_values(path: Path, error: ValidationError, place: Sequence[str] = ()) -> ValueError:
    """Creates the error for a file with values that are missing or of a wrong type.

    place  keys above the values that were validated
    """
    first = error.errors()[0]
    where = ".".join(map(str, (*place, *first["loc"])))
    return ValueError(f"{path}: damaged: {where}: {first['msg']}; {_AGAIN}")


@dataclass(frozen=True)
class Format(Generic[_Contents]):
    """A kind of file that `sigmahat estimate` writes into its folder."""

    file: str  # name of the file in the folder
    name: str  # value of the key "format" in the file
    version: int  # version of the format
    contents: type[_Contents]  # dataclass with format, version and all other fields of the file

    def path(self, given: Path) -> Path:
        """Returns the path of the file; `given` is the file, or the folder that contains it."""
        return given / self.file if given.is_dir() else given

    def read(self, given: Path) -> _Contents:
        """Reads a file. Raises ValueError, which says what was expected and what was received."""
        path = self.path(given)
        try:
            document: Any = json.loads(path.read_text(encoding="utf-8"))
        except OSError as error:
            hint = f"name the folder or the {self.file} that `sigmahat estimate` wrote"
            raise ValueError(f"{path}: {error.strerror}; {hint}") from error
        except ValueError as error:  # also for bytes that are no text
            damaged = f"no JSON, or a file that is cut off or damaged ({error})"
            raise self._unexpected(path, damaged) from error
        found = document.get("format") if isinstance(document, dict) else None
        if found != self.name:
            raise self._unexpected(path, f"format {found!r}" if found else "something else")
        if document.get("version") != self.version:
            raise ValueError(
                f"{path}: expected version {self.version} of the format, got "
                f"{document.get('version')!r}; {_AGAIN}"
            )
        try:
            return TypeAdapter(self.contents).validate_python(document)
        except ValidationError as error:
            raise wrong_values(path, error) from error

    def _unexpected(self, path: Path, got: str) -> ValueError:
        expected = f"expected the {self.file} that `sigmahat estimate` wrote"
        return ValueError(f"{path}: {expected}, got {got}")
