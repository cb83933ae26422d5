"""An FMU through its C interface: every call returns its status, and all messages are recorded.

FMPy only loads the library; its error handling is not used.
"""

from __future__ import annotations

import atexit
import ctypes
import shutil
from collections.abc import Mapping, Sequence
from functools import cache, partial
from pathlib import Path
from typing import Any

import fmpy
import fmpy.fmi2 as fmi2

OK, WARNING, DISCARD, ERROR = 0, 1, 2, 3


@cache
def unpacked(fmu: Path) -> tuple[Any, str]:
    """Model description of an FMU, and the folder of its files until this process ends."""
    folder = fmpy.extract(str(fmu))
    atexit.register(partial(shutil.rmtree, folder, ignore_errors=True))
    return fmpy.read_model_description(str(fmu)), folder


class Instance:
    """An instance of an FMU, after fmi2Instantiate.

    A lone surrogate in the name or the GUID is passed as a byte that is not UTF-8.
    """

    def __init__(
        self,
        fmu: Path,
        *,
        name: str = "test",
        guid: str | None = None,
        resources: str | None = "file:///",
        logger: bool = True,
        memory: bool = False,
        logging_on: bool = True,
    ) -> None:
        self.description, folder = unpacked(fmu)
        self.variables = {v.name: v for v in self.description.modelVariables}
        self.messages: list[tuple[int, str, str]] = []  # status, category, message
        self.environments: list[int | None] = []  # that the logger received
        self.names: set[str] = set()  # of the instance, that the logger received
        self.blocks: set[int] = set()  # of memory that the instance allocated and has not freed
        slave = fmi2.FMU2Slave(
            guid=self.description.guid,
            unzipDirectory=folder,
            modelIdentifier=self.description.coSimulation.modelIdentifier,
            instanceName="test",
        )
        self.slave: Any = slave
        self.dll: Any = slave.dll
        self.callbacks = fmi2.fmi2CallbackFunctions()
        if logger:
            self.callbacks.logger = fmi2.fmi2CallbackLoggerTYPE(self._log)
        if memory:
            self.callbacks.allocateMemory = fmi2.fmi2CallbackAllocateMemoryTYPE(self.allocate)
            self.callbacks.freeMemory = fmi2.fmi2CallbackFreeMemoryTYPE(self._free)
        self.callbacks.componentEnvironment = 4711 if logger else None
        self.dll.fmi2Instantiate.restype = ctypes.c_void_p
        self.dll.fmi2DoStep.argtypes = [
            ctypes.c_void_p,
            ctypes.c_double,
            ctypes.c_double,
            ctypes.c_int,
        ]
        self.component = self.dll.fmi2Instantiate(
            ctypes.c_char_p(name.encode(errors="surrogateescape")),
            1,
            ctypes.c_char_p((guid or self.description.guid).encode(errors="surrogateescape")),
            None if resources is None else ctypes.c_char_p(resources.encode()),
            ctypes.byref(self.callbacks),
            0,
            int(logging_on),
        )

    def __enter__(self) -> Instance:
        return self

    def __exit__(self, *_: object) -> None:
        if self.component:
            self.dll.fmi2FreeInstance(ctypes.c_void_p(self.component))
        self.slave.freeLibrary()

    def _log(
        self, environment: Any, name: bytes, status: int, category: bytes, text: bytes
    ) -> None:
        self.names.add(name.decode())
        self.environments.append(environment)
        self.messages.append((status, category.decode(), text.decode()))

    def allocate(self, count: int, size: int) -> int:
        block: int = fmpy.calloc(count, size)
        self.blocks.add(block)
        return block

    def _free(self, block: int) -> None:
        self.blocks.remove(block)
        fmpy.free(block)

    def call(self, function: str, *arguments: Any) -> int:
        """Calls a function with this instance as its first argument. Returns the status."""
        return int(getattr(self.dll, function)(ctypes.c_void_p(self.component), *arguments))

    def reference(self, name: str) -> int:
        return int(self.variables[name].valueReference)

    def references(self, names: Sequence[str]) -> Any:
        return (ctypes.c_uint * len(names))(*[self.reference(name) for name in names])

    def _type(self, name: str) -> tuple[str, Any]:
        kind = self.variables[name].type
        if kind == "Real":
            return "Real", ctypes.c_double
        return ("Boolean" if kind == "Boolean" else "Integer"), ctypes.c_int

    def set(self, name: str, value: float) -> int:
        kind, c_type = self._type(name)
        value = value if kind == "Real" else int(value)
        return self.call(
            f"fmi2Set{kind}", self.references([name]), ctypes.c_size_t(1), (c_type * 1)(value)
        )

    def set_all(self, values: Mapping[str, float]) -> None:
        for name, value in values.items():
            assert self.set(name, value) == OK, self.messages

    def set_derivative(self, name: str, value: float, order: int = 1) -> int:
        return self.call(
            "fmi2SetRealInputDerivatives",
            self.references([name]),
            ctypes.c_size_t(1),
            (ctypes.c_int * 1)(order),
            (ctypes.c_double * 1)(value),
        )

    def status_and_value(self, name: str) -> tuple[int, float]:
        kind, c_type = self._type(name)
        value = (c_type * 1)()
        status = self.call(f"fmi2Get{kind}", self.references([name]), ctypes.c_size_t(1), value)
        return status, value[0]

    def get(self, name: str) -> float:
        status, value = self.status_and_value(name)
        assert status == OK, self.messages
        return value

    def get_all(self, names: Sequence[str]) -> list[float]:
        return [self.get(name) for name in names]

    def setup(self, start: float = 0.0, stop: float | None = None) -> int:
        return self.call(
            "fmi2SetupExperiment",
            0,
            ctypes.c_double(0),
            ctypes.c_double(start),
            int(stop is not None),
            ctypes.c_double(stop or 0),
        )

    def enter(self) -> int:
        return self.call("fmi2EnterInitializationMode")

    def exit(self) -> int:
        return self.call("fmi2ExitInitializationMode")

    def initialise(self, values: Mapping[str, float] | None = None, start: float = 0.0) -> None:
        """Sets start values and makes the instance ready for the first step."""
        assert self.setup(start) == OK
        self.set_all(values or {})
        assert self.enter() == OK
        assert self.exit() == OK, self.messages

    def step(self, t: float, h: float) -> int:
        return self.call("fmi2DoStep", ctypes.c_double(t), ctypes.c_double(h), 1)

    def save(self) -> ctypes.c_void_p:
        state = ctypes.c_void_p()
        assert self.call("fmi2GetFMUstate", ctypes.byref(state)) == OK
        return state

    def restore(self, state: ctypes.c_void_p) -> int:
        return self.call("fmi2SetFMUstate", state)

    def free(self, state: ctypes.c_void_p) -> None:
        assert self.call("fmi2FreeFMUstate", ctypes.byref(state)) == OK

    def serialise(self, state: ctypes.c_void_p) -> bytes:
        size = ctypes.c_size_t()
        assert self.call("fmi2SerializedFMUstateSize", state, ctypes.byref(size)) == OK
        buffer = ctypes.create_string_buffer(size.value)
        assert self.call("fmi2SerializeFMUstate", state, buffer, size) == OK
        return buffer.raw

    def deserialise(self, data: bytes) -> tuple[int, ctypes.c_void_p]:
        state = ctypes.c_void_p()
        buffer = ctypes.create_string_buffer(data, len(data))
        status = self.call(
            "fmi2DeSerializeFMUstate", buffer, ctypes.c_size_t(len(data)), ctypes.byref(state)
        )
        return status, state
