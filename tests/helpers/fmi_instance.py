"""An FMU through its C interface: every call returns its status, and all messages are recorded.

FMPy only loads the library; its error handling is not used. `Instance` is of FMI 2.0, and
`Instance3`, which has the same methods, of FMI 3.0.
"""

import atexit
import ctypes
import math
import shutil
from collections.abc import Mapping, Sequence
from functools import cache, partial
from pathlib import Path
from typing import Any, TypeVar

import fmpy
from fmpy import fmi2, fmi3

OK, WARNING, DISCARD, ERROR = 0, 1, 2, 3
SIZE, REAL = ctypes.c_size_t, ctypes.c_double
InstanceT = TypeVar("InstanceT", bound="_Instance")
ENVIRONMENT = 4711  # environment pointer that the logger receives


@cache
def unpacked(fmu: Path) -> tuple[Any, str]:
    """Model description of an FMU, and the folder of its files until this process ends."""
    folder = fmpy.extract(str(fmu))
    atexit.register(partial(shutil.rmtree, folder, ignore_errors=True))
    return fmpy.read_model_description(str(fmu)), folder


class _Instance:
    """What both versions have."""

    prefix: str
    slave: Any
    """Class of FMPy."""
    types: Mapping[str, tuple[str, Any]]
    """For each type of variables: name of its functions, and type of a value."""
    state: str
    real: str

    def __init__(self, fmu: Path) -> None:
        self.description, folder = unpacked(fmu)
        self.variables = {v.name: v for v in self.description.modelVariables}
        self.messages: list[tuple[int, str, str]] = []  # status, category, message
        self._loaded = self.slave(
            guid=self.description.guid,
            unzipDirectory=folder,
            modelIdentifier=self.description.coSimulation.modelIdentifier,
            instanceName="test",
        )
        # The library has no declarations of FMPy, so arguments of any kind can be passed.
        self.dll: Any = ctypes.CDLL(self._loaded.dll._name)
        self.component: int | None = None

    def __enter__(self: InstanceT) -> InstanceT:
        return self

    def __exit__(self, *_: object) -> None:
        if self.component:
            self.dll[f"{self.prefix}FreeInstance"](ctypes.c_void_p(self.component))
        self._loaded.freeLibrary()

    @property
    def last_message(self) -> str:
        return self.messages[-1][2]

    def call(self, function: str, *arguments: Any) -> int:
        """Calls a function, named without its prefix, with this instance as its first argument.

        Returns the status.
        """
        return int(self.dll[self.prefix + function](ctypes.c_void_p(self.component), *arguments))

    def reference(self, name: str) -> int:
        return int(self.variables[name].valueReference)

    def references(self, names: Sequence[str]) -> Any:
        return (ctypes.c_uint * len(names))(*map(self.reference, names))

    def access(self, function: str, references: Any, values: Any) -> int:
        """Calls GetX or SetX with two arrays. FMI 3.0 also needs the length of each array."""
        n = SIZE(len(values))
        return self.call(function, references, n, values, *([n] if self.prefix == "fmi3" else []))

    def set(self, name: str, value: float) -> int:
        kind, c_type = self.types[self.variables[name].type]
        array = (c_type * 1)(value if c_type is REAL else int(value))
        return self.access(f"Set{kind}", self.references([name]), array)

    def set_all(self, values: Mapping[str, float]) -> None:
        for name, value in values.items():
            assert self.set(name, value) == OK, self.messages

    def get(self, name: str) -> float:
        kind, c_type = self.types[self.variables[name].type]
        array = (c_type * 1)()
        assert self.access(f"Get{kind}", self.references([name]), array) == OK, self.messages
        value: float = array[0]
        return value

    def get_all(self, names: Sequence[str]) -> list[float]:
        return [self.get(name) for name in names]

    def enter(
        self, start: float = 0.0, stop: float | None = None, tolerance: float | None = None
    ) -> int:
        """Sets the experiment (start and stop time) and enters initialisation mode."""
        experiment = (
            *(int(tolerance is not None), REAL(tolerance or 0.0), REAL(start)),
            *(int(stop is not None), REAL(stop or 0.0)),
        )
        if self.prefix == "fmi3":
            return self.call("EnterInitializationMode", *experiment)
        status = self.call("SetupExperiment", *experiment)
        return status if status != OK else self.call("EnterInitializationMode")

    def exit(self) -> int:
        return self.call("ExitInitializationMode")

    def initialise(
        self: InstanceT,
        values: Mapping[str, float] | None = None,
        start: float = 0.0,
        stop: float | None = None,
    ) -> InstanceT:
        """Sets start values and makes the instance, which is returned, ready for the first step."""
        self.set_all(values or {})
        assert self.enter(start, stop) == OK, self.messages
        assert self.exit() == OK, self.messages
        return self

    def save(self) -> ctypes.c_void_p:
        state = ctypes.c_void_p()
        assert self.call(f"Get{self.state}", ctypes.byref(state)) == OK
        return state

    def restore(self, state: ctypes.c_void_p) -> int:
        return self.call(f"Set{self.state}", state)

    def free(self, state: ctypes.c_void_p) -> None:
        assert self.call(f"Free{self.state}", ctypes.byref(state)) == OK
        assert state.value is None

    def serialise(self, state: ctypes.c_void_p) -> bytes:
        size = SIZE()
        assert self.call(f"Serialized{self.state}Size", state, ctypes.byref(size)) == OK
        buffer = ctypes.create_string_buffer(size.value)
        assert self.call(f"Serialize{self.state}", state, buffer, size) == OK
        return buffer.raw

    def saved(self) -> bytes:
        """The present state, serialised."""
        state = self.save()
        data = self.serialise(state)
        self.free(state)
        return data

    def deserialise(self, data: bytes) -> tuple[int, ctypes.c_void_p]:
        state = ctypes.c_void_p()
        buffer = ctypes.create_string_buffer(data, max(len(data), 1))
        name = "DeSerializeFMUstate" if self.state == "FMUstate" else "DeserializeFMUState"
        return self.call(name, buffer, SIZE(len(data)), ctypes.byref(state)), state


class Instance(_Instance):
    """An instance after fmi2Instantiate.

    A lone surrogate in the token is passed as a byte that is not UTF-8.
    """

    prefix, slave, state, real = "fmi2", fmi2.FMU2Slave, "FMUstate", "Real"
    types = {  # noqa: RUF012
        "Real": ("Real", REAL),
        "Integer": ("Integer", ctypes.c_int),
        "Enumeration": ("Integer", ctypes.c_int),
        "Boolean": ("Boolean", ctypes.c_int),
    }

    def __init__(
        self,
        fmu: Path,
        *,
        name: str | None = "test",
        token: str | None = None,
        resources: str | None = "file:///",
        logger: bool = True,
        memory: bool = False,
        logging_on: bool = True,
    ) -> None:
        super().__init__(fmu)
        self.names: set[str] = set()  # instance names that the logger received
        self.blocks: set[int] = set()  # addresses of memory that is not freed yet
        self.callbacks = fmi2.fmi2CallbackFunctions()
        if logger:
            self.callbacks.logger = fmi2.fmi2CallbackLoggerTYPE(self._log)
        if memory:
            self.callbacks.allocateMemory = fmi2.fmi2CallbackAllocateMemoryTYPE(self.allocate)
            self.callbacks.freeMemory = fmi2.fmi2CallbackFreeMemoryTYPE(self._free)
        self.callbacks.componentEnvironment = ENVIRONMENT
        self.dll.fmi2Instantiate.restype = ctypes.c_void_p
        self.component = self.dll.fmi2Instantiate(
            None if name is None else name.encode(errors="surrogateescape"),
            1,
            (self.description.guid if token is None else token).encode(errors="surrogateescape"),
            None if resources is None else resources.encode(),
            ctypes.byref(self.callbacks),
            0,
            int(logging_on),
        )

    def _log(
        self, environment: int, name: bytes, status: int, category: bytes, text: bytes
    ) -> None:
        assert environment == ENVIRONMENT
        self.names.add(name.decode())
        self.messages.append((status, category.decode(), text.decode()))

    def allocate(self, count: int, size: int) -> int:
        block: int = fmpy.calloc(count, size)
        self.blocks.add(block)
        return block

    def _free(self, block: int) -> None:
        self.blocks.remove(block)
        fmpy.free(block)

    def set_derivative(self, name: str, value: float) -> int:
        reference, orders = self.references([name]), (ctypes.c_int * 1)(1)
        return self.call("SetRealInputDerivatives", reference, SIZE(1), orders, (REAL * 1)(value))

    def step(self, t: float, h: float) -> int:
        return self.call("DoStep", REAL(t), REAL(h), 1)


class Instance3(_Instance):
    """An instance after fmi3InstantiateCoSimulation."""

    prefix, slave, state, real = "fmi3", fmi3.FMU3Slave, "FMUState", "Float64"
    types = {  # noqa: RUF012
        "Float64": ("Float64", REAL),
        "Int32": ("Int32", ctypes.c_int32),
        "Enumeration": ("Int64", ctypes.c_int64),
        "Boolean": ("Boolean", ctypes.c_bool),
    }

    def __init__(
        self,
        fmu: Path,
        *,
        name: str | None = "test",
        token: str | None = None,
        logger: bool = True,
        logging_on: bool = True,
        event_mode: bool = False,
        early_return: bool = False,
        intermediate: Sequence[int] = (),
    ) -> None:
        super().__init__(fmu)
        taken = ctypes.CFUNCTYPE(
            None, ctypes.c_void_p, ctypes.c_int, ctypes.c_char_p, ctypes.c_char_p
        )
        self.logger = taken(self._log) if logger else None
        self.component = self.instantiate(
            "CoSimulation",
            *(event_mode, early_return, (ctypes.c_uint32 * len(intermediate))(*intermediate)),
            *(SIZE(len(intermediate)), ctypes.c_void_p(ENVIRONMENT), self.logger, None),
            name=name,
            token=token,
            logging_on=logging_on,
        )

    def instantiate(
        self,
        kind: str,
        *rest: Any,
        name: str | None = "test",
        token: str | None = None,
        logging_on: bool = True,
    ) -> int | None:
        """Calls fmi3Instantiate of a kind. Returns the instance, None after an error."""
        function = self.dll[f"fmi3Instantiate{kind}"]
        function.restype = ctypes.c_void_p
        token = self.description.guid if token is None else token
        text = None if name is None else name.encode()
        made: int | None = function(text, token.encode(), b"", False, logging_on, *rest)
        return made

    def _log(self, environment: int, status: int, category: bytes, text: bytes) -> None:
        assert environment == ENVIRONMENT
        self.messages.append((status, category.decode(), text.decode()))

    def step(self, t: float, h: float) -> int:
        """Makes a step, which must not return early or request an event."""
        flags, reached = [ctypes.c_bool(True) for _ in range(3)], REAL(math.nan)
        places = [*map(ctypes.byref, flags), ctypes.byref(reached)]
        status = self.call("DoStep", REAL(t), REAL(h), True, *places)
        if status == OK:
            assert [flag.value for flag in flags] == [False, False, False]
            assert reached.value == t + h
        return status
