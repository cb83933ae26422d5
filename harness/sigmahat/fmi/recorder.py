"""Values of some variables of a slave, one row per sample."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sigmahat.fmi.instance import Slave, value_references
from sigmahat.fmi.sample_loop import SampleLoop

_KINDS = {"Real": "real", "Integer": "integer", "Enumeration": "integer", "Boolean": "boolean"}
"""Which function gets a variable, by its type."""


class Recorder:
    """Values of some variables of a slave, one row per sample, written there by the FMU itself."""

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
            dtype = np.float64 if kind == "real" else np.int32
            self._tables[kind] = group, np.empty((samples, len(group)), dtype)
        self.units = {v.name: v.unit for v in variables if v.unit is not None}

    def add_to(self, loop: SampleLoop) -> None:
        """From now on the loop writes a row for each of its samples."""
        for kind, get in (
            ("real", loop.get_real),
            ("integer", loop.get_integer),
            ("boolean", loop.get_boolean),
        ):
            group, table = self._tables[kind]
            get(self.slave, value_references(group), table)

    def sample(self, k: int) -> None:
        """Writes row k at once. Raises FmuError if the FMU refuses."""
        loop = SampleLoop()
        self.add_to(loop)
        loop.run(k, k + 1)

    def columns(self) -> dict[str, NDArray[Any]]:
        """Returns the recorded values by name, each of shape (samples,); of an enumeration the
        names of its items.
        """
        fmu = self.slave.fmu
        columns = {}
        for group, table in self._tables.values():
            for i, v in enumerate(group):
                values = np.ascontiguousarray(table[:, i])
                columns[v.name] = (
                    fmu.item_names(v.name, values) if v.type == "Enumeration" else values
                )
        return columns
