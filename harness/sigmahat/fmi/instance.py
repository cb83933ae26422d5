"""Unpacked FMUs and their instances in a co-simulation, on top of FMPy's FMI 2.0 calls."""

from __future__ import annotations

import logging
import os
import sys
from collections.abc import Callable, Iterable, Mapping
from copy import copy
from ctypes import byref
from functools import lru_cache
from multiprocessing.util import Finalize, is_exiting
from pathlib import Path
from shutil import rmtree
from tempfile import mkdtemp
from typing import Any
from weakref import WeakValueDictionary

import fmpy
from fmpy import fmi2

from sigmahat.fmi.installed import fmu as installed_fmu
from sigmahat.fmi.model import FmuError, Model, Value

try:  # some platforms only; without the proxy, messages are not formatted
    from fmpy.logging import addLoggerProxy
except (ImportError, OSError):
    addLoggerProxy = None

_log = logging.getLogger("sigmahat")


class Fmu(Model):
    """An unpacked FMU, for any number of slaves.

    The unpacked files are removed at the end of the process, or of the block if the object is used
    as a context manager.
    """

    def __init__(self, path: Path) -> None:
        """Unpacks the FMU. Raises what Model does."""
        super().__init__(path)
        self.folder = mkdtemp(prefix="sigmahat-")
        self._library: list[fmi2.FMU2Slave] = []
        # Also called at the end of a process of multiprocessing, but not in a fork of this process.
        self._close = Finalize(self, _close, (self._library, self.folder), exitpriority=1)
        fmpy.extract(path, self.folder)

    def __enter__(self) -> Fmu:
        return self

    def __exit__(self, *_: object) -> None:
        self._close()

    def interface(self, instance: str) -> Any:
        """FMPy's object for a new instance. FMPy loads the library once, which takes long."""
        if not self._library:
            library = fmi2.FMU2Slave(
                guid=self.description.guid,
                modelIdentifier=self.description.coSimulation.modelIdentifier,
                unzipDirectory=self.folder,
            )
            self._library.append(library)
        another = copy(self._library[0])
        another.instanceName = instance
        return another

    def references(self, names: Iterable[str], causality: str | None = None) -> Any:
        """Returns the value references of Real variables as an array for FMI calls."""
        variables = [self.variable(name, causality) for name in names]
        for v in variables:
            if v.type != "Real":
                raise ValueError(f"{self.name}.{v.name}: expected a Real variable, it is {v.type}")
        return value_references(variables)


def installed(name: str) -> Fmu:
    """An FMU of this installation. Raises FileNotFoundError if no FMU has this name."""
    return opened(installed_fmu(name))


def named(fmu: str) -> Fmu:
    """An FMU of this installation by its name, or the FMU at a path that ends in .fmu.

    Raises what `installed` and `opened` do.
    """
    path = Path(fmu)
    return opened(path) if path.suffix.lower() == ".fmu" else installed(fmu)


def opened(path: Path) -> Fmu:
    """An FMU, unpacked until the process ends. Raises what Fmu does.

    The FMU is unpacked again if the file has changed since the last call, or if the FMU allows one
    instance per process only. Such an FMU may need its library loaded again.
    """
    status = path.stat()
    fmu = _opened(path.resolve(), status.st_mtime_ns, status.st_size)
    once = fmu.description.coSimulation.canBeInstantiatedOnlyOncePerProcess
    return Fmu(path) if once else fmu


@lru_cache(maxsize=32)
def _opened(path: Path, _changed: int, _size: int) -> Fmu:
    return Fmu(path)


if hasattr(os, "register_at_fork"):  # the folders belong to the parent process
    os.register_at_fork(after_in_child=_opened.cache_clear)


class Slave:
    """One instance of an FMU, in the state "instantiated" at first.

    Use it as a context manager: the instance is freed at the end.
    """

    def __init__(self, fmu: Fmu, name: str) -> None:
        """Instantiates the FMU. Raises FmuError with the FMU's own message if it refuses."""
        self.fmu = fmu
        self.name = name
        self.errors: list[str] = []  # their texts, for the exception
        self._callbacks = fmi2.fmi2CallbackFunctions()
        self._callbacks.logger = _LOGGER
        self._callbacks.componentEnvironment = id(self)
        _slaves[id(self)] = self
        self._callbacks.allocateMemory = fmi2.fmi2CallbackAllocateMemoryTYPE(fmpy.calloc)
        self._callbacks.freeMemory = fmi2.fmi2CallbackFreeMemoryTYPE(fmpy.free)
        if addLoggerProxy is not None:
            addLoggerProxy(byref(self._callbacks))
        try:  # FMPy raises plain Exception here
            self.fmi = fmu.interface(name)
            self.fmi.instantiate(callbacks=self._callbacks, loggingOn=True)
        except Exception as error:
            raise self.failure(str(error)) from error
        self.component = self.fmi.component
        self.functions: Any = self.fmi.dll
        """The FMI functions themselves, with the types that FMPy gave them, for call()."""

    def __enter__(self) -> Slave:
        return self

    def __exit__(self, *_: object) -> None:
        self.functions.fmi2FreeInstance(self.component)

    def call(self, function: Callable[..., int], *arguments: Any) -> None:
        """Calls one of the functions for this instance. Raises FmuError if it fails."""
        if function(self.component, *arguments) > fmi2.fmi2Warning:
            raise self.failure(f"{function.__name__} failed")

    def failure(self, what: str) -> FmuError:
        """The error to raise: the message of the FMU, else a description of the event."""
        return FmuError(f"{self.name}: {'; '.join(self.errors) or what}")

    def initialize(self, start: Mapping[str, Value]) -> None:
        """Sets start values by name and initialises at time 0.

        Raises ValueError for an unknown name or a value that does not fit its variable, FmuError
        if the FMU refuses a value.
        """
        numbers = {name: self.fmu.number(name, value) for name, value in start.items()}
        self.call(self.functions.fmi2SetupExperiment, 0, 0.0, 0.0, 0, 0.0)
        for name, number in numbers.items():
            variable = self.fmu.variables[name]
            kind = "Integer" if variable.type == "Enumeration" else variable.type
            value = (getattr(fmi2, f"fmi2{kind}") * 1)(number)
            setter = getattr(self.functions, f"fmi2Set{kind}")
            self.call(setter, value_references([variable]), 1, value)
        self.call(self.functions.fmi2EnterInitializationMode)
        self.call(self.functions.fmi2ExitInitializationMode)


def _close(library: list[fmi2.FMU2Slave], folder: str) -> None:
    # At the end of the process, a thread may still use the library, so the library stays loaded.
    # But Windows cannot remove the file of a loaded library.
    for each in library if sys.platform == "win32" or not is_exiting() else ():
        each.freeLibrary()
    rmtree(folder, ignore_errors=True)


_slaves: WeakValueDictionary[int, Slave] = WeakValueDictionary()
"""Existing slaves, by the environment pointer that the FMU gives with a message."""


def _on_message(
    environment: int | None, instance: bytes | None, status: int, _category: bytes, message: bytes
) -> None:
    name = (instance or b"").decode("utf-8", "replace")
    slave = _slaves.get(environment or 0)
    if slave is None:  # an FMU that does not know its environment
        slave = next((each for each in _slaves.values() if each.name == name), None)
    text = message.decode("utf-8", "replace")
    if slave is not None and status == fmi2.fmi2Warning:
        _log.warning("%s: %s", slave.name, text)
    elif slave is not None and status > fmi2.fmi2Warning:
        slave.errors.append(text)


# One logger serves all slaves of the process: FMPy's proxy stores only the last logger, and
# calls this logger for every FMU.
_LOGGER = fmi2.fmi2CallbackLoggerTYPE(_on_message)


def value_references(variables: Iterable[Any]) -> Any:
    """Returns the value references of FMPy's descriptions as an array for FMI calls."""
    references = [v.valueReference for v in variables]
    return (fmi2.fmi2ValueReference * len(references))(*references)
