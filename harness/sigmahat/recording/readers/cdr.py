"""Finds the numbers in serialized ROS 2 messages, for which DDS has the format CDR.

A message is four bytes, the second of which tells the order of bytes, and then its fields without
their names. Strings and sequences begin with their length, and a number is aligned to its size. So
in messages with the same lengths inside, the numbers are at the same places: these messages have
one form. One message of a form is walked through, and the numbers of all others are read at once.

rosbags, which reads the definitions of the types, would generate a program for each type. Its size
grows with the sizes in the definition, which in a stranger's file can be any.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sigmahat.fmi.quoted import quoted

Types = Mapping[str, tuple[Any, Sequence[tuple[str, Any]]]]
"""Constants and fields of each type of message, as rosbags gives them."""
STAMP = ("header.stamp.sec", "header.stamp.nanosec")
"""Numbers of the header, of which no others are read."""

_LONGEST_ARRAY = 256  # elements; a longer array is a picture or a scan, not a signal
_DEEPEST = 32  # largest number of messages in messages
_FORMS = 16  # of messages of the same length that are read together; each takes a pass
_STEPS = 3_000_000  # fields and elements that are walked through, which takes some seconds
_NUMBERS = {
    **{"bool": "u1", "byte": "u1", "octet": "u1", "char": "u1", "float32": "f4", "float64": "f8"},
    **{f"int{8 * size}": f"i{size}" for size in (1, 2, 4, 8)},
    **{f"uint{8 * size}": f"u{size}" for size in (1, 2, 4, 8)},
}
_HEAD = 4  # bytes before the fields
_BASE, _NAME, _ARRAY = 1, 2, 3  # what a field is, in the definitions of rosbags; or a sequence
_EMPTY = "structure_needs_at_least_one_member"  # of ROS 2, for a type without fields
_NO_FIELDS: list[tuple[str, Any]] = [(_EMPTY, (_BASE, ("uint8", 0)))]
_HIDDEN = ("layout", _EMPTY)
_SHORT = "it ends early"
_SLOW = "its messages have too many forms or parts"

_Place = tuple[int, str]  # of a number: byte in the message, type


class CdrError(ValueError):
    """A message that does not fit its type, or takes too long to read."""


class Decoder:
    """Reads the messages of a bag; the work of all its methods together is limited."""

    def __init__(self, types: Types) -> None:
        self.types = types
        self._left = _STEPS

    def read(
        self,
        type_name: str,
        messages: Sequence[bytes],
        column: Callable[[str], NDArray[np.float64]],
    ) -> None:
        """Writes the numbers of messages of one type into columns.

        column  returns the column of a number, with a row for each message. Names are as
                "angle.data" or "position[knee]"; elements have an index, or the name of the joint
                if the message has as many names

        Raises CdrError.
        """
        for rows, matrix in _of_equal_length(messages):
            left = np.arange(len(rows))
            for _ in range(_FORMS):
                if not len(left):
                    break
                walk = self._walk(type_name, matrix[left[0]].tobytes())
                decide = matrix[left[:, np.newaxis], np.array(walk.decide)]
                same = (decide == decide[0]).all(axis=1)
                _place(walk, matrix, left[same], rows, column)
                left = left[~same]
            for each in left:
                walk = self._walk(type_name, matrix[each].tobytes())
                _place(walk, matrix, np.array([each]), rows, column)

    def _walk(self, type_name: str, message: bytes) -> "_Walk":
        walk = _Walk(self.types, message, self._left)
        walk.message(type_name)
        self._left = walk.steps
        return walk


def _of_equal_length(
    messages: Sequence[bytes],
) -> Iterator[tuple[NDArray[np.intp], NDArray[np.uint8]]]:
    """Yields rows and bytes of the messages of each length."""
    lengths = np.array([len(each) for each in messages])
    order = np.argsort(lengths, kind="stable")
    for rows in np.split(order, np.flatnonzero(np.diff(lengths[order])) + 1):
        joined = b"".join(messages[row] for row in rows)
        yield rows, np.frombuffer(joined, np.uint8).reshape(len(rows), -1)


def _place(
    walk: "_Walk",
    matrix: NDArray[np.uint8],
    these: NDArray[np.intp],
    rows: NDArray[np.intp],
    column: Callable[[str], NDArray[np.float64]],
) -> None:
    """Writes the numbers of these lines of the matrix, which have the same form."""
    for name, (at, kind) in walk.numbers.items():
        dtype = np.dtype(walk.order + kind)
        values = np.ascontiguousarray(matrix[these, at : at + dtype.itemsize])
        column(name)[rows[these]] = values.view(dtype)[:, 0]


class _Walk:
    """Walks through one message, from field to field."""

    def __init__(self, types: Types, data: bytes, steps: int) -> None:
        if len(data) < 4 or data[:2] not in (b"\0\0", b"\0\1"):
            raise CdrError("expected CDR")
        self.order = "<" if data[1] else ">"
        self.numbers: dict[str, _Place] = {}
        self.decide = [1]  # bytes that the messages of a form have in common
        self.steps = steps  # that are left
        self._types, self._data, self._at = types, data, _HEAD

    def message(self, type_name: str) -> None:
        self._fields(type_name, "", 0)
        if self._at + 3 < len(self._data):  # a message may be filled up to a multiple of 4
            raise CdrError(f"its type has {self._at} bytes, the message has {len(self._data)}")

    def _fields(self, type_name: str, above: str | None, depth: int) -> None:
        """above  what the names of the numbers begin with; None if they are not asked for"""
        if depth > _DEEPEST:
            raise CdrError(f"expected at most {_DEEPEST} messages in messages")
        if type_name not in self._types:
            raise CdrError(f"the type {quoted(type_name)} is not defined")
        labels: list[str] = []
        arrays: list[tuple[str, int, _Place]] = []
        for field, (kind, what) in self._types[type_name][1] or _NO_FIELDS:
            hidden = above is None or field in _HIDDEN or (field == "header" and depth > 0)
            name = None if hidden else f"{above}{field}"
            if kind == _BASE:
                self._scalar(what[0], name)
            elif kind == _NAME:
                self._fields(what, None if name is None else f"{name}.", depth + 1)
            else:
                (inner, element), size = what
                count = size if kind == _ARRAY else self._length()
                if inner == _NAME:
                    for _ in self._each(count):
                        self._fields(element, None, depth + 1)
                elif element[0] in _NUMBERS:
                    place = self._numbers_of(element[0], count)
                    if name is not None and count <= _LONGEST_ARRAY:
                        arrays.append((name, count, place))
                else:
                    texts = [self._text(element[0], field == "name") for _ in self._each(count)]
                    labels = texts if field == "name" else labels
            self._step()
        for name, count, (at, number) in arrays:
            size = np.dtype(number).itemsize
            for i, label in enumerate(labels if len(labels) == count else range(count)):
                self._found(f"{name}[{label}]", at + i * size, number)

    def _found(self, name: str, at: int, kind: str) -> None:
        self._step()
        of_stamp = name in STAMP and kind in ("i4", "u4")
        if of_stamp or not name.startswith("header."):
            self.numbers[name] = (at, kind)

    def _scalar(self, kind: str, name: str | None) -> None:
        if kind not in _NUMBERS:
            self._text(kind, False)
            return
        at, number = self._numbers_of(kind, 1)
        if name is not None:
            self._found(name, at, number)

    def _numbers_of(self, kind: str, count: int) -> _Place:
        """The place of numbers, which are passed."""
        number = _NUMBERS[kind]
        size = np.dtype(number).itemsize
        if count:
            self._align(size)
        at = self._at
        self._pass(count * size)
        return at, number

    def _length(self) -> int:
        """Reads a length, which decides on the form."""
        self._align(4)
        at = self._at
        self._pass(4)
        self.decide += range(at, at + 4)
        return int.from_bytes(self._data[at : at + 4], "little" if self.order == "<" else "big")

    def _text(self, kind: str, decides: bool) -> str:
        """decides  whether the text is the name of a joint, which decides on the form"""
        if kind != "string":
            raise CdrError(f"the type {quoted(kind)} is not supported")
        length = self._length()
        at = self._at
        self._pass(length)
        if not decides:
            return ""
        self.decide += range(at, at + length)
        return self._data[at : at + length].rstrip(b"\0").decode(errors="backslashreplace")

    def _each(self, count: int) -> range:
        """The elements of an array, each of which has at least one byte."""
        if count > len(self._data) - self._at:
            raise CdrError(_SHORT)
        return range(count)

    def _align(self, size: int) -> None:
        self._at += (_HEAD - self._at) % size

    def _pass(self, size: int) -> None:
        self._at += size
        if self._at > len(self._data):
            raise CdrError(_SHORT)

    def _step(self) -> None:
        self.steps -= 1
        if self.steps < 0:
            raise CdrError(_SLOW)
