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

from sigmahat.logs.errors import LogError
from sigmahat.logs.log import LogInMemory

_MOST_COLUMNS = 256  # of one matrix; a larger one is an image, not a log

Named = Iterator[tuple[str, NDArray[np.generic]]]


def read_mat(path: Path) -> LogInMemory:
    """A MAT file of version 5 to 7. Raises LogError if it is damaged or holds no numbers."""
    import scipy.io

    try:
        variables = scipy.io.loadmat(path, struct_as_record=False)
    except Exception as error:  # any: for a damaged file scipy raises many kinds
        raise LogError(f"{path}: damaged MAT file ({error}); save it again") from error
    own = {name: value for name, value in variables.items() if not name.startswith("__")}
    return _log(path, (each for name, value in own.items() for each in _fields(name, value)))


def _fields(name: str, value: Any) -> Named:
    fields = getattr(value, "_fieldnames", None)
    if fields is not None:
        for field in fields:
            yield from _fields(f"{name}.{field}", getattr(value, field))
    elif isinstance(value, np.ndarray) and value.dtype == object and value.size == 1:
        yield from _fields(name, value.item())
    elif isinstance(value, np.ndarray):
        yield from _columns(name, value)


def read_hdf5(path: Path) -> LogInMemory:
    """An HDF5 file, or a MAT file of version 7.3. Raises LogError as read_mat does."""
    import h5py

    def walk(group: h5py.Group, above: str) -> Named:
        for name, item in group.items():
            if name.startswith("#"):  # the contents of cells, in files of MATLAB
                continue
            if isinstance(item, h5py.Group):
                yield from walk(item, f"{above}{name}.")
            elif item.dtype.names and item.ndim == 1:
                for field in item.dtype.names:
                    yield from _columns(f"{above}{name}.{field}", item[field])
            else:
                yield from _columns(f"{above}{name}", item)

    try:
        with h5py.File(path, "r") as file:
            return _log(path, walk(file, ""))
    except LogError:
        raise
    except (OSError, RuntimeError, KeyError) as error:
        raise LogError(f"{path}: not a whole HDF5 file ({error}); copy it again") from error


def _columns(name: str, array: Any) -> Named:
    """Columns of an array or an HDF5 data set; none if it cannot be a signal."""
    if array.dtype.kind not in "biuf" or not 1 <= array.ndim <= 2 or max(array.shape) < 2:
        return
    if min(array.shape) > _MOST_COLUMNS and array.ndim == 2:
        return
    values = np.asarray(array[...])
    if values.ndim == 2 and values.shape[0] < values.shape[1]:  # as in version 7.3
        values = values.T
    if values.ndim == 1 or values.shape[1] == 1:
        yield name, values.reshape(-1)
    else:
        for j in range(values.shape[1]):
            yield f"{name}[{j}]", values[:, j]


def _log(path: Path, columns: Named) -> LogInMemory:
    arrays = dict(columns)
    if not arrays:
        raise LogError(f"{path}: no vector or matrix of numbers in it")
    return LogInMemory(path, arrays)
