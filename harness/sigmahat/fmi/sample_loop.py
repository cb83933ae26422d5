"""The calls that a co-simulation makes for every sample, and recorders."""

from __future__ import annotations

import ctypes
from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np
from fmpy import fmi2
from numpy.typing import NDArray

from sigmahat.fmi import native
from sigmahat.fmi.instance import Slave, value_references
from sigmahat.fmi.interrupts import interrupts_wait

# As in harness/native/sample_loop.h.
_SET_REAL, _SET_SLOPES, _DO_STEP, _GET_REAL, _GET_INTEGER = range(1, 6)


class _Call(ctypes.Structure):
    """sh_call of harness/native/sample_loop.h, which keeps the objects that it points to."""

    _fields_ = (
        ("kind", ctypes.c_int),
        ("component", ctypes.c_void_p),
        ("function", ctypes.c_void_p),
        ("references", ctypes.c_void_p),
        ("count", ctypes.c_size_t),
        ("orders", ctypes.c_void_p),
        ("rows", ctypes.c_void_p),
        ("stride", ctypes.c_size_t),
    )

    def __init__(
        self, kind: int, slave: Slave, callee: Any, given: Sequence[Any], table: NDArray[Any]
    ) -> None:
        """given  value references, and orders of derivatives"""
        count = len(given[0]) if given else 2
        dtype = np.dtype(np.int32 if kind == _GET_INTEGER else np.float64)
        if not table.flags.c_contiguous or table.dtype != dtype or table.shape[-1] != count:
            raise ValueError(
                f"expected a C-contiguous table of {dtype} with {count} columns, got one of "
                f"{table.dtype} and shape {table.shape}"
            )
        arrays = [ctypes.addressof(each) for each in given] + [0, 0]
        stride = table.strides[0] if table.ndim == 2 else 0
        address = ctypes.cast(callee, ctypes.c_void_p)
        super().__init__(
            kind, slave.component, address, arrays[0], count, arrays[1], table.ctypes.data, stride
        )
        self.slave, self.callee, self.given, self.table = slave, callee, given, table


class SampleLoop:
    """A list of calls of FMI functions; for each sample all calls are made, in this order.

    A table has a row for each sample, [size: samples x values]. An array [size: values] is the same
    row for every sample. Such an array passes values from the get of one FMU to the set of another.
    Tables are C-contiguous, and are read and written in place.
    """

    def __init__(self, *parts: SampleLoop) -> None:
        """Begins with the calls of other loops."""
        self._calls: list[_Call] = [call for part in parts for call in part._calls]
        self._native: ctypes.Array[_Call] | None = None

    def set_real(self, slave: Slave, references: Any, table: NDArray[np.float64]) -> None:
        if len(references):
            self._add(_SET_REAL, slave, slave.functions.fmi2SetReal, [references], table)

    def set_slopes(self, slave: Slave, references: Any, table: NDArray[np.float64]) -> None:
        """Sets the first derivatives of Real inputs."""
        function = slave.functions.fmi2SetRealInputDerivatives
        if len(references):
            orders = (fmi2.fmi2Integer * len(references))(*[1] * len(references))
            self._add(_SET_SLOPES, slave, function, [references, orders], table)

    def step(self, slave: Slave, times: NDArray[np.float64]) -> None:
        """Makes a step; step_times() gives the table."""
        self._add(_DO_STEP, slave, slave.functions.fmi2DoStep, [], times)

    def get(self, slave: Slave, kind: str, references: Any, table: NDArray[Any]) -> None:
        """Gets variables of a kind: "Real"; "Integer", also for enumerations; or "Boolean"."""
        if len(references):
            number = _GET_REAL if kind == "Real" else _GET_INTEGER
            get = getattr(slave.functions, f"fmi2Get{kind}")
            self._add(number, slave, get, [references], table)

    def run(self, first: int, end: int) -> None:
        """Makes all calls for the samples first to end - 1.

        Ctrl-C has its effect at the end; so a long loop is run in pieces. Raises FmuError if an
        FMU refuses, with its own message; later calls are not made then.
        """
        rows = [len(call.table) for call in self._calls if call.table.ndim == 2]
        if not 0 <= first <= end <= min(rows, default=end):
            raise ValueError(f"expected samples within {min(rows)} rows, got {first} to {end}")
        with interrupts_wait():  # else Ctrl-C is lost if the FMU calls back
            if self._native is None:
                self._native = (_Call * len(self._calls))(*self._calls)
            count = len(self._calls)
            refused = native.library().sh_sample_loop(self._native, count, first, end)
        if refused < count:
            call = self._calls[refused]
            raise call.slave.failure(f"{call.callee.__name__} failed")

    def _add(self, *fields: Any) -> None:
        self._calls.append(_Call(*fields))
        self._native = None


def step_times(t: NDArray[np.float64], h: float | NDArray[np.float64]) -> NDArray[np.float64]:
    """The table for SampleLoop.step(): communication points t and step or steps h [s]."""
    return np.column_stack(np.broadcast_arrays(t, h))


_KINDS = {"Real": "Real", "Integer": "Integer", "Enumeration": "Integer", "Boolean": "Boolean"}
"""Which function gets a variable, by its type."""


class Recorder:
    """Values of some variables of a slave, one row per sample; the FMU itself writes the rows."""

    def __init__(self, slave: Slave, names: Iterable[str], samples: int) -> None:
        """Raises ValueError for an unknown name, and for a String."""
        self.slave = slave
        self._tables: dict[str, tuple[list[Any], NDArray[Any]]] = {}
        variables = [slave.fmu.variable(name) for name in names]
        for v in variables:
            if v.type not in _KINDS:
                raise ValueError(f"{slave.fmu.name}.{v.name}: a {v.type} cannot be recorded")
        for kind in dict.fromkeys(_KINDS.values()):
            group = [v for v in variables if _KINDS[v.type] == kind]
            dtype = np.float64 if kind == "Real" else np.int32
            self._tables[kind] = group, np.empty((samples, len(group)), dtype)

    def add_to(self, loop: SampleLoop) -> None:
        """From now on the loop writes a row for each of its samples."""
        for kind, (group, table) in self._tables.items():
            loop.get(self.slave, kind, value_references(group), table)

    def columns(self) -> dict[str, NDArray[Any]]:
        """Returns the recorded values by name, each of shape (samples,); an enumeration has the
        names of its items.
        """
        fmu = self.slave.fmu
        columns: dict[str, NDArray[Any]] = {}
        for group, table in self._tables.values():
            for i, v in enumerate(group):
                values = np.ascontiguousarray(table[:, i])
                is_item = v.type == "Enumeration"
                columns[v.name] = fmu.item_names(v.name, values) if is_item else values
        return columns
