"""MAT files of MATLAB (v5 to v7.3) and HDF5 files.

A vector is a column. A matrix is as many columns as its shorter side is long: "x[0]", "x[1]". In a
structure or group, the path is part of the name: "joint.theta".
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sigmahat.logs.limits import check_bytes, check_columns, check_numbers
from sigmahat.logs.log import LogError, LogInMemory
from sigmahat.logs.readers.packed_mat import check_packed

_MOST_COLUMNS = 256  # of one matrix; a larger one is an image, not a log
_DEEPEST = 32  # groups of HDF5 in groups

Named = Iterator[tuple[str, NDArray[np.generic]]]


def read_mat(path: Path) -> LogInMemory:
    """A MAT file of version 5 to 7. Raises LogError if it is damaged or holds no numbers."""
    import scipy.io

    check_packed(path)
    try:
        variables = scipy.io.loadmat(path, struct_as_record=False)
    except Exception as error:  # any: for a damaged file scipy raises many kinds
        raise LogError(f"{path}: damaged MAT file ({error}); save it again") from error
    own = {name: value for name, value in variables.items() if not name.startswith("__")}
    return _log(path, (each for name, value in own.items() for each in _fields(path, name, value)))


def _fields(path: Path, name: str, value: Any) -> Named:
    fields = getattr(value, "_fieldnames", None)
    if fields is not None:
        for field in fields:
            yield from _fields(path, f"{name}.{field}", getattr(value, field))
    elif isinstance(value, np.ndarray) and value.dtype == object and value.size == 1:
        yield from _fields(path, name, value.item())
    elif isinstance(value, np.ndarray):
        yield from _columns(path, name, value)


def read_hdf5(path: Path) -> LogInMemory:
    """An HDF5 file, or a MAT file of version 7.3. Raises LogError as read_mat does."""
    import h5py

    def walk(group: h5py.Group, above: str, depth: int = 0) -> Named:
        if depth > _DEEPEST:
            raise LogError(f"{path}: groups in more than {_DEEPEST} groups, or in a circle")
        for name in group:
            if name.startswith("#"):  # the contents of cells, in files of MATLAB
                continue
            link = group.get(name, getlink=True)
            if isinstance(link, h5py.ExternalLink):
                raise _elsewhere(path, f"{above}{name}", link.filename)
            item = group.get(name)
            if isinstance(item, h5py.Group):
                yield from walk(item, f"{above}{name}.", depth + 1)
            elif not isinstance(item, h5py.Dataset) or item.shape is None:
                continue  # a link to nothing, a type, or no values
            elif item.is_virtual or item.external:
                others = item.virtual_sources() if item.is_virtual else item.external
                raise _elsewhere(path, f"{above}{name}", str(others[0][0 if item.external else 1]))
            elif item.dtype.names and item.ndim == 1:
                check_bytes(path, item.size * item.dtype.itemsize)
                for field in item.dtype.names:
                    yield from _columns(path, f"{above}{name}.{field}", item[field])
            else:
                yield from _columns(path, f"{above}{name}", item)

    try:
        with h5py.File(path, "r") as file:
            return _log(path, walk(file, ""))
    except LogError:
        raise
    except (OSError, RuntimeError, KeyError, ValueError, TypeError) as error:
        raise LogError(f"{path}: not a whole HDF5 file ({error}); copy it again") from error


def _elsewhere(path: Path, name: str, file: str) -> LogError:
    return LogError(
        f"{path}: {name!r} lies in another file, {file!r}, and only the log is read; "
        "copy the values into it"
    )


def _columns(path: Path, name: str, array: Any) -> Named:
    """Columns of an array or an HDF5 data set; none if it cannot be a signal."""
    if array.dtype.kind not in "biuf" or not 1 <= array.ndim <= 2 or max(array.shape) < 2:
        return
    if min(array.shape) > _MOST_COLUMNS and array.ndim == 2:
        return
    check_numbers(path, max(array.shape))
    check_bytes(path, array.size * array.dtype.itemsize)
    values = np.asarray(array[...])
    if values.ndim == 2 and values.shape[0] < values.shape[1]:  # as in version 7.3
        values = values.T
    if values.ndim == 1 or values.shape[1] == 1:
        yield name, values.reshape(-1)
    else:
        for j in range(values.shape[1]):
            yield f"{name}[{j}]", values[:, j]


def _log(path: Path, columns: Named) -> LogInMemory:
    arrays, size = {}, 0
    for name, values in columns:
        arrays[name] = values
        size += values.nbytes
        check_columns(path, len(arrays))
        check_bytes(path, size)
    if not arrays:
        raise LogError(f"{path}: no vector or matrix of numbers in it")
    return LogInMemory(path, arrays)
