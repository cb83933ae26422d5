"""Reads MAT files of MATLAB (v5 to v7.3) and HDF5 files.

A vector becomes one column. A matrix becomes columns "x[0]", "x[1]" along its longer side. In a
structure or group, the path is part of the name of the column: "joint.theta". Recorders such as
ControlDesk and the scopes of Simulink write an array of structures, one for each signal with its
name in it, which is then the name of the column. Units are in the structure, or in an attribute.

The elements of a MAT file of version 5 to 7 are checked before scipy reads the file. The reason is
that scipy unpacks variables of any size, and uses the kind of an element as an index. After a
header of 128 bytes, each variable has a tag of two integers, kind and number of bytes, and data.
The data of a variable are a sequence of elements, again with tags.
"""

import math
import struct
import zlib
from collections.abc import Collection, Iterator
from contextlib import suppress
from itertools import chain
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sigmahat.fmi.quoted import cause, quoted
from sigmahat.recording.limits import check_bytes, check_columns, check_numbers
from sigmahat.recording.log import LogError, LogInMemory

_MATRIX, _COMPRESSED = 14, 15
_KINDS = {*range(1, 8), 9, 12, 13, _MATRIX, 16, 17, 18}  # numbers, matrices, text
_HEAD = 128  # bytes
_PIECE = 1 << 16  # bytes of the file that are unpacked at a time
_MOST = 300_000_000  # bytes
_MOST_OF_PARTS = 80_000_000  # limit for structures and cells: 8 bytes can need 100
_MOST_ELEMENTS = 1_000_000
_NUMBERS = {"double", "single", "logical"} | {
    f"{u}int{n}" for u in ("", "u") for n in (8, 16, 32, 64)
}
_MOST_PER_BYTE = 8  # bytes without compression per byte of the file

Buffer = bytes | bytearray


def check_packed(path: Path) -> None:
    """Raises LogError for a file that is far larger without compression, or has unknown elements.

    Any other damage of the file is found by scipy.
    """
    size = path.stat().st_size
    most = max(_MOST if _is_plain(path) else _MOST_OF_PARTS, _MOST_PER_BYTE * size)
    unpacked = elements = 0
    with path.open("rb") as file:
        head = file.read(_HEAD)
        tag = struct.Struct(">II" if head[126:128] == b"MI" else "<II")
        while len(begin := file.read(tag.size)) == tag.size:
            kind, length = tag.unpack(begin)
            variable: Buffer = file.read(min(length, size))
            if kind == _COMPRESSED:
                variable = _unpacked(variable, most - unpacked)
                unpacked += len(variable)
            if unpacked > most:
                raise LogError(
                    f"{path}: expected at most {most / 1e6:.0f} MB of data in {size / 1e6:.3g} MB, "
                    "got more; save it without compression (-v6), or in parts"
                )
            for found in _kinds(variable, tag):
                elements += 1
                if found not in _KINDS:
                    raise LogError(
                        f"{path}: damaged MAT file (element of unknown type {found}); save it again"
                    )
                if elements > _MOST_ELEMENTS:
                    raise LogError(
                        f"{path}: expected at most {_MOST_ELEMENTS} cells and fields, got more; "
                        "save the columns as vectors"
                    )


def _unpacked(packed: Buffer, most: int) -> Buffer:
    """Unpacks bytes up to the first damage, or until their number is larger than `most`."""
    unpack, found = zlib.decompressobj(), bytearray()
    with suppress(zlib.error):
        for first in range(0, len(packed), _PIECE):
            found += unpack.decompress(packed[first : first + _PIECE])
            if len(found) > most:
                break
    return found


def _kinds(variable: Buffer, tag: struct.Struct) -> Iterator[int]:
    """Yields the kinds of the elements of a variable in a MAT file."""
    at = 0
    while at + tag.size <= len(variable):
        kind, length = tag.unpack_from(variable, at)
        at += tag.size
        if kind >> 16:  # up to four bytes in the tag itself
            kind &= 0xFFFF
        elif kind != _MATRIX:  # after the tag of a matrix, the tags of its elements follow
            at += -(-length // 8) * 8
        yield kind


def _is_plain(path: Path) -> bool:
    """Returns whether all variables are arrays of numbers, which need little memory per byte."""
    import scipy.io

    try:
        return all(kind in _NUMBERS for _, _, kind in scipy.io.whosmat(path))
    except Exception:  # any: as for loadmat
        return False


_MOST_COLUMNS = 256  # limit of one matrix; a larger matrix is an image, not a log
_DEEPEST = 32  # largest number of nested groups of HDF5, and of links to links
_SMALL = 380_000  # bytes of a chunk of HDF5 that unpacks to at most 400 MB
_MOST_STEPS = 100_000  # from object to object; a group can contain itself many times

Named = Iterator[tuple[str, NDArray[np.generic]]]


def read_mat(path: Path) -> LogInMemory:
    """Reads a MAT file of version 5 to 7. Raises LogError for damage, or without any numbers."""
    import scipy.io

    check_packed(path)
    try:
        variables = scipy.io.loadmat(path, struct_as_record=False)
    except Exception as error:  # any: for a damaged file scipy raises many kinds
        raise LogError(f"{path}: damaged MAT file ({cause(error)}); save it again") from error
    units: dict[str, str] = {}
    own = (
        _fields(path, name, value, units)
        for name, value in variables.items()
        if not name.startswith("__")
    )
    return _log(path, chain.from_iterable(own), units)


_NAMES, _UNITS = ("Name", "name", "label", "blockName"), ("Unit", "unit", "Units", "units")
_VALUES = ("Data", "data", "values", "Values")


def _fields(path: Path, name: str, value: Any, units: dict[str, str]) -> Named:
    """Yields the columns of a variable; units gets those that the variable has."""
    fields = getattr(value, "_fieldnames", None)
    if fields is not None:
        for field in fields:
            yield from _fields(path, f"{name}.{field}", getattr(value, field), units)
    elif isinstance(value, np.ndarray) and value.dtype == object and value.size == 1:
        yield from _fields(path, name, value.item(), units)
    elif isinstance(value, np.ndarray) and value.dtype == object:
        for k, signal in enumerate(value.ravel(), 1):
            yield from _signal(path, _text(signal, _NAMES) or f"{name}({k})", signal, units)
    elif isinstance(value, np.ndarray):
        yield from _columns(path, name, value)


def _signal(path: Path, name: str, signal: Any, units: dict[str, str]) -> Named:
    """Yields the columns of one structure of an array, which has the name of the signal."""
    unit = _text(signal, _UNITS)
    for field in getattr(signal, "_fieldnames", ()):
        column = name if field in _VALUES else f"{name}.{field}"
        if unit and field in _VALUES:
            units[column] = unit
        yield from _fields(path, column, getattr(signal, field), units)


def _text(structure: Any, fields: tuple[str, ...]) -> str:
    """Returns the first of these fields of a structure that has a text; empty without one."""
    for field in fields:
        value = getattr(structure, field, None)
        if isinstance(value, np.ndarray) and value.dtype.kind == "U" and value.size == 1:
            return str(value.item()).strip()
    return ""


def read_hdf5(path: Path) -> LogInMemory:
    """Reads an HDF5 file, or a MAT file of version 7.3. Raises LogError as read_mat does."""
    import h5py

    reader = _Hdf5(path)
    try:
        with h5py.File(path, "r") as file:
            return _log(path, reader.columns(file, ""), reader.units)
    except LogError:
        raise
    except (OSError, RuntimeError, KeyError, ValueError, TypeError) as error:
        raise LogError(f"{path}: incomplete HDF5 file ({cause(error)}); copy it again") from error


class _Hdf5:
    """Goes through an HDF5 file, without other files to which it refers."""

    def __init__(self, path: Path) -> None:
        self.units: dict[str, str] = {}  #: From the attributes, by name of the data set.
        self._path = path
        self._steps = 0

    def columns(self, group: Any, above: str, depth: int = 0) -> Named:
        import h5py

        if depth > _DEEPEST:
            raise LogError(f"{self._path}: expected at most {_DEEPEST} levels of groups, got more")
        for part in group:
            name = f"{above}{part}"
            item = None if part.startswith("#") else self._item(group, part, name)
            if isinstance(item, h5py.Group):
                yield from self.columns(item, f"{name}.", depth + 1)
            elif isinstance(item, h5py.Dataset) and item.shape is not None:
                yield from self._of_data_set(item, name)

    def _item(self, group: Any, path_inside: str, name: str, links: int = 0) -> Any:
        """The object at a path; None for a link to nothing.

        h5py itself would follow a soft link that leads through an external one.
        """
        import h5py

        item = group.file if path_inside.startswith("/") else group
        for part in path_inside.split("/"):
            self._count_step(links)
            if part in ("", ".") or item is None:
                continue
            link = item.get(part, getlink=True) if isinstance(item, h5py.Group) else None
            if isinstance(link, h5py.ExternalLink):
                raise _elsewhere(self._path, name, link.filename)
            if isinstance(link, h5py.SoftLink):
                item = self._item(item, link.path, name, links + 1)
            else:
                item = None if link is None else item[part]
        return item

    def _count_step(self, links: int) -> None:
        self._steps += 1
        if self._steps > _MOST_STEPS or links > _DEEPEST:
            raise LogError(
                f"{self._path}: expected at most {_MOST_STEPS} groups and data sets, and "
                f"{_DEEPEST} links to links, got more; save only the columns of one joint"
            )

    def _of_data_set(self, item: Any, name: str) -> Named:
        if item.is_virtual:
            raise _elsewhere(self._path, name, item.virtual_sources()[0].file_name)
        if item.external:
            raise _elsewhere(self._path, name, item.external[0][0])
        if item.chunks is not None:
            self._check_chunks(item, name)
        if item.dtype.names and item.ndim == 1:
            check_bytes(self._path, item.size * item.dtype.itemsize)
            for field in item.dtype.names:
                yield from _columns(self._path, f"{name}.{field}", item[field])
        else:
            self.units[name] = _attribute(item, _UNITS)
            yield from _columns(self._path, name, item)

    def _check_chunks(self, item: Any, name: str) -> None:
        """Raises LogError for a data set with chunks that take too much memory: HDF5 reads a chunk
        as a whole, and unpacks it to any size."""
        size = math.prod(item.chunks) * item.dtype.itemsize
        check_bytes(self._path, size)
        packed = []
        item.id.chunk_iter(lambda chunk: packed.append(chunk) if chunk.size > _SMALL else None)
        for chunk in packed:
            _, content = item.id.read_direct_chunk(chunk.chunk_offset)
            if len(_unpacked(content, size)) > size:
                raise LogError(
                    f"{self._path}: {quoted(name)} is larger than its chunks; copy it again"
                )


def _attribute(item: Any, names: tuple[str, ...]) -> str:
    """Returns the first of these attributes of a data set that is a text; empty without one."""
    for name in names:
        value = item.attrs.get(name, "")
        text = value.decode("utf-8", "replace") if isinstance(value, bytes) else value
        if isinstance(text, str) and text:
            return text
    return ""


def _elsewhere(path: Path, name: str, file: str) -> LogError:
    return LogError(
        f"{path}: {quoted(name)} lies in another file, {quoted(file)}, and only the log is read; "
        "copy the values into it"
    )


def _columns(path: Path, name: str, array: Any) -> Named:
    """Yields the columns of an array or an HDF5 data set; none for an array that is no signal."""
    if array.dtype.kind not in "biuf" or not 1 <= array.ndim <= 2 or max(array.shape) < 2:
        return
    if min(array.shape) > _MOST_COLUMNS and array.ndim == 2:
        return
    check_numbers(path, max(array.shape))
    check_bytes(path, array.size * array.dtype.itemsize)
    values = np.asarray(array[...])
    if values.ndim == 1 or min(values.shape) == 1:
        yield name, values.reshape(-1)
        return
    for j, column in enumerate(values if values.shape[0] < values.shape[1] else values.T):
        yield f"{name}[{j}]", column


def _distinct(name: str, others: Collection[str]) -> str:
    """Returns a name, with a number if other columns have it: signals may have one name."""
    new, count = name, 2
    while new in others:
        new, count = f"{name} ({count})", count + 1
    return new


def _log(path: Path, columns: Named, units: dict[str, str]) -> LogInMemory:
    arrays: dict[str, NDArray[np.generic]] = {}
    size = 0
    for name, values in columns:
        arrays[_distinct(name, arrays)] = values
        size += values.nbytes
        check_columns(path, len(arrays))
        check_bytes(path, size)
    if not arrays:
        raise LogError(f"{path}: expected a vector or matrix of numbers, found none")
    log = LogInMemory(path, arrays)
    log.units |= {name: unit for name, unit in units.items() if unit and name in arrays}
    return log
