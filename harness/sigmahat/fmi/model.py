"""The variables of an FMU by their names: types, units, items, start values."""

from __future__ import annotations

from collections.abc import Mapping
from functools import lru_cache
from importlib import import_module
from pathlib import Path
from typing import Any

import fmpy
import numpy as np
from numpy.typing import NDArray

from sigmahat.fmi.installed import fmu as installed_fmu
from sigmahat.fmi.interrupts import interrupts_wait
from sigmahat.fmi.quoted import quoted
from sigmahat.fmi.unknown_name import unknown

with interrupts_wait():  # FMPy needs lxml; a Ctrl-C during this import would be lost
    _etree = import_module("lxml.etree")

# With the first schema, libxml2 initialises its types without a lock. Two threads that read the
# first two FMUs at the same time could fail, or end the process.
_etree.XMLSchema(_etree.XML('<xs:schema xmlns:xs="http://www.w3.org/2001/XMLSchema"/>'))

Value = float | int | bool | str  # of a variable. An enumeration takes the name of its item.

_TOO_LARGE = 2**31  # smallest positive integer that does not fit an Integer of FMI


class FmuError(RuntimeError):
    """An FMU refused a call. The message comes from the FMU."""


class Model:
    """The model of an FMU, as its model description defines it. Nothing is unpacked or loaded."""

    def __init__(self, path: Path) -> None:
        """Reads modelDescription.xml from the FMU.

        Raises FileNotFoundError, or FmuError if the FMU is not for FMI 2.0 Co-Simulation.
        """
        try:  # FMPy raises plain Exception for a description that is not valid
            self.description = fmpy.read_model_description(path)
        except OSError:
            raise
        except Exception as error:
            raise FmuError(f"{path}: not a readable FMU ({error}); build it again") from error
        self.name: str = self.description.modelName
        if self.description.fmiVersion != "2.0" or self.description.coSimulation is None:
            kind = "Co-Simulation" if self.description.coSimulation else "another use"
            raise FmuError(
                f"{path}: expected an FMU for FMI 2.0 Co-Simulation, got FMI "
                f"{self.description.fmiVersion} for {kind}"
            )
        self.variables = {v.name: v for v in self.description.modelVariables}

    def variable(self, name: str, causality: str | None = None) -> Any:
        """Returns FMPy's description of a variable. Raises ValueError for an unknown variable."""
        variable = self.variables.get(name)
        if variable is None or causality not in (None, variable.causality):
            known = [n for n, v in self.variables.items() if causality in (None, v.causality)]
            kind = f"{causality or 'variable'} of {self.name}"
            raise ValueError(unknown(kind, name, known))
        return variable

    def number(self, name: str, value: Value) -> float | int:
        """Returns the value as a number for FMI. Raises ValueError if the value does not fit."""
        variable = self.variable(name)
        if variable.type == "Enumeration" and isinstance(value, str):
            numbers = {item: number for number, item in self.items(name).items()}
            if value not in numbers:
                raise ValueError(unknown(f"value of {self.name}.{name}", value, numbers))
            return numbers[value]
        is_flag = isinstance(value, bool) and variable.type != "Boolean"
        if isinstance(value, str) or is_flag:
            raise ValueError(f"{self.name}.{name}: expected {variable.type}, got {quoted(value)}")
        try:
            if variable.type == "Real":
                return float(value)
            whole = int(value)
        except (TypeError, ValueError, OverflowError):  # a list or a date, nan, too many digits
            whole = None
        expected = variable.type
        if variable.type == "Enumeration":
            items = self.items(name)
            if whole is not None and whole == value and whole in items:
                return whole
            expected = f"one of {', '.join(items.values())}"
        elif whole is not None and whole == value:
            if -_TOO_LARGE <= whole < _TOO_LARGE:
                return whole
            expected += " of 32 bits"
        raise ValueError(f"{self.name}.{name}: expected {expected}, got {quoted(value)}")

    def items(self, name: str) -> dict[int, str]:
        """Returns the items of an enumeration: their names by their numbers."""
        return {int(item.value): item.name for item in self.variable(name).declaredType.items}

    def item_names(self, name: str, numbers: NDArray[np.int32]) -> NDArray[np.str_]:
        """Returns the names of the items of an enumeration, which FMI gives as numbers.

        numbers  of items, shape (N,)
        """
        items = dict(sorted(self.items(name).items()))
        places = np.searchsorted(list(items), numbers)
        names: NDArray[np.str_] = np.array(list(items.values()))[places]
        return names

    def parameters(self, start: Mapping[str, Value]) -> dict[str, Value]:
        """Returns all parameters: given start values, else start values of the FMU."""
        values: dict[str, Value] = {}
        for name, variable in self.variables.items():
            if variable.causality != "parameter" or variable.type == "String":
                continue
            boolean = variable.type == "Boolean"
            default = variable.start == "true" if boolean else float(variable.start)
            value: Value = self.number(name, start.get(name, default))
            if variable.type == "Enumeration":
                value = self.items(name)[int(value)]
            values[name] = value
        return values


def installed_model(name: str) -> Model:
    """The model of an FMU of this installation. Raises FileNotFoundError if no FMU has this name.

    The model is read again if the file has changed since the last call.
    """
    path = installed_fmu(name)
    status = path.stat()
    return _model(path.resolve(), status.st_mtime_ns, status.st_size)


@lru_cache(maxsize=32)
def _model(path: Path, _changed: int, _size: int) -> Model:
    return Model(path)
