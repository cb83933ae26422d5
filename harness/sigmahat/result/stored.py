"""Reads the JSON files of `sigmahat estimate`, and defines their formats and common records."""

from __future__ import annotations

import json
import re
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Annotated, Any, Generic, TypeVar

from pydantic import AfterValidator, ConfigDict, Strict, TypeAdapter, ValidationError
from pydantic_core import PydanticCustomError

from sigmahat.files.whole_file import read_whole
from sigmahat.fmi.model import Model
from sigmahat.fmi.quoted import cut, quoted

NO_OTHER_KEYS = ConfigDict(extra="forbid", allow_inf_nan=False)
Text = Annotated[str, Strict()]  # any, such as a path

_LONGEST_WORD = 80  # characters of a text that has a form
_MANY = 1000  # texts, most of which are the same in each result of a table


def form(pattern: str, expected: str) -> AfterValidator:
    """Makes a check of the form of a text; ``expected`` says what was expected."""
    whole = re.compile(pattern, re.ASCII)

    @lru_cache(_MANY)
    def checked(text: str) -> str:
        if len(text) > _LONGEST_WORD or not whole.fullmatch(text):
            raise PydanticCustomError("form", "expected {what}", {"what": expected})
        return text

    return AfterValidator(checked)


Word = Annotated[Text, form(r"[A-Za-z]\w*", "a word")]
Name = Annotated[Text, form(r"[A-Za-z][\w.,\[\]]*", "a name such as motor.B")]
Unit = Annotated[Text, form(r"[\w./^-]+", "a unit")]
Digest = Annotated[Text, form("[0-9a-f]{64}", "a SHA-256: 64 hexadecimal digits")]
Version = Annotated[Text, form(r"[\w.+-]*", "a version")]
_Guid = Annotated[Text, form(r"[\w{}-]+", "a GUID")]
Range = tuple[float, float]  # least and largest value


@dataclass(frozen=True)
class LearnedLog:
    """A log that the estimator has processed."""

    __pydantic_config__ = NO_OTHER_KEYS

    file: Text  # path of the log, as given by the user
    sha256: Digest  # of the file; for a folder see files/output.py
    ticks: int  # number of ticks of the estimator in the log
    skipped: int  # ticks that were skipped
    phi: Range | None
    """Deformation at the samples that the regression used [rad]; None without such samples."""
    set_point: Range | None  # set-point at these samples [1]; None without such samples


@dataclass(frozen=True)
class FmuId:
    """Identity of an FMU."""

    __pydantic_config__ = NO_OTHER_KEYS

    name: Word
    version: Version
    guid: _Guid

    @staticmethod
    def of(model: Model) -> FmuId:
        """Returns the identity of the FMU of a model."""
        return FmuId(model.name, model.description.version or "", model.description.guid)


_Contents = TypeVar("_Contents")
_AGAIN = "run `sigmahat estimate` again"
_LONGEST = 10_000_000  # bytes of a file; a usual file has 100 kB


def wrong_values(path: Path, error: ValidationError, place: Sequence[str] = ()) -> ValueError:
    """Creates the error for a file with values that are missing, of a wrong type or form.

    place  keys above the values that were validated
    """
    first = error.errors()[0]
    where = cut(".".join(map(str, (*place, *first["loc"]))))
    said = first["msg"].removeprefix("Value error, ")
    got = "" if first["type"] == "missing" else f", got {quoted(first['input'])}"
    return ValueError(f"{path}: damaged: {where}: {said}{got}; {_AGAIN}")


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
            document: Any = json.loads(read_whole(path, _LONGEST))
        except OSError as error:
            hint = f"name the folder or the {self.file} that `sigmahat estimate` wrote"
            raise ValueError(f"{path}: {error.strerror}; {hint}") from error
        except (ValueError, RecursionError) as error:  # also for bytes that are no text
            damaged = f"no JSON, or a file that is cut off or damaged ({error})"
            raise self._unexpected(path, damaged) from error
        found = document.get("format") if isinstance(document, dict) else None
        if found != self.name:
            raise self._unexpected(path, f"format {quoted(found)}" if found else "something else")
        if document.get("version") != self.version:
            raise ValueError(
                f"{path}: expected version {self.version} of the format, got "
                f"{quoted(document.get('version'))}; {_AGAIN}"
            )
        try:
            return TypeAdapter(self.contents).validate_python(document)
        except ValidationError as error:
            raise wrong_values(path, error) from error

    def _unexpected(self, path: Path, got: str) -> ValueError:
        expected = f"expected the {self.file} that `sigmahat estimate` wrote"
        return ValueError(f"{path}: {expected}, got {got}")
