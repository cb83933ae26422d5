"""A twin FMU of FMI 3.0 through its C interface: every call returns its status.

As `fmi_instance.Instance`, with the functions of FMI 3.0: FMPy only loads the library.
"""

from __future__ import annotations

import ctypes
import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import fmpy.fmi3 as fmi3

from fmi_instance import OK, unpacked
from fmi_runs import SIGNALS

C_TYPES: dict[str, tuple[str, Any]] = {
    "Float64": ("Float64", ctypes.c_double),
    "Int32": ("Int32", ctypes.c_int32),
    "Enumeration": ("Int64", ctypes.c_int64),
    "Boolean": ("Boolean", ctypes.c_bool),
}
"""Name of the functions for each type of variables, and the type of one value."""
SIZE = ctypes.c_size_t
LOGGER = ctypes.CFUNCTYPE(None, ctypes.c_void_p, ctypes.c_int, ctypes.c_char_p, ctypes.c_char_p)


class Instance3:
    """An instance of an FMU, after fmi3InstantiateCoSimulation."""

    def __init__(
        self,
        fmu: Path,
        *,
        token: str | None = None,
        logger: bool = True,
        logging_on: bool = True,
        event_mode: bool = False,
        early_return: bool = False,
        intermediate: Sequence[int] = (),
    ) -> None:
        self.description, folder = unpacked(fmu)
        self.variables = {v.name: v for v in self.description.modelVariables}
        self.messages: list[tuple[int, str, str]] = []  # status, category, message
        self.slave: Any = fmi3.FMU3Slave(
            guid=self.description.guid,
            unzipDirectory=folder,
            modelIdentifier=self.description.coSimulation.modelIdentifier,
            instanceName="test",
        )
        # Without FMPy's declarations, so that arguments of any kind can be passed.
        self.dll: Any = ctypes.CDLL(self.slave.dll._name)
        self._logger = LOGGER(self._log) if logger else None
        self.handle = self.instantiate(
            "CoSimulation",
            *(event_mode, early_return),
            (ctypes.c_uint32 * len(intermediate))(*intermediate),
            SIZE(len(intermediate)),
            ctypes.c_void_p(4711),
            self._logger,
            None,
            token=token,
            logging_on=logging_on,
        )

    def instantiate(
        self, kind: str, *rest: Any, token: str | None = None, logging_on: bool = True
    ) -> int | None:
        """Calls fmi3Instantiate of a kind. Returns the handle, None after an error."""
        function = self.dll[f"fmi3Instantiate{kind}"]
        function.restype = ctypes.c_void_p
        token = self.description.guid if token is None else token
        handle: int | None = function(b"test", token.encode(), b"", False, logging_on, *rest)
        return handle

    def __enter__(self) -> Instance3:
        return self

    def __exit__(self, *_: object) -> None:
        self.dll.fmi3FreeInstance(ctypes.c_void_p(self.handle))
        self.slave.freeLibrary()

    def _log(self, environment: int, status: int, category: bytes, text: bytes) -> None:
        assert environment == 4711
        self.messages.append((status, category.decode(), text.decode()))

    @property
    def last_message(self) -> str:
        return self.messages[-1][2]

    def call(self, function: str, *arguments: Any) -> int:
        """Calls a function with this instance as its first argument. Returns the status."""
        return int(self.dll[function](ctypes.c_void_p(self.handle), *arguments))

    def references(self, names: Sequence[str]) -> Any:
        return (ctypes.c_uint32 * len(names))(*[self.variables[n].valueReference for n in names])

    def set(self, name: str, value: float) -> int:
        function, c_type = C_TYPES[self.variables[name].type]
        array = (c_type * 1)(value)
        return self.call(f"fmi3Set{function}", self.references([name]), SIZE(1), array, SIZE(1))

    def set_all(self, values: Mapping[str, float]) -> None:
        for name, value in values.items():
            assert self.set(name, value) == OK, self.messages

    def get(self, name: str) -> float:
        function, c_type = C_TYPES[self.variables[name].type]
        array = (c_type * 1)()
        status = self.call(f"fmi3Get{function}", self.references([name]), SIZE(1), array, SIZE(1))
        assert status == OK, self.messages
        value: float = array[0]
        return value

    def enter(
        self, start: float = 0.0, stop: float | None = None, tolerance: float | None = None
    ) -> int:
        return self.call(
            "fmi3EnterInitializationMode",
            *(tolerance is not None, ctypes.c_double(tolerance or 0.0), ctypes.c_double(start)),
            *(stop is not None, ctypes.c_double(stop or 0.0)),
        )

    def exit(self) -> int:
        return self.call("fmi3ExitInitializationMode")

    def initialise(
        self,
        values: Mapping[str, float] | None = None,
        start: float = 0.0,
        stop: float | None = None,
    ) -> None:
        """Sets start values and makes the instance ready for the first step."""
        self.set_all(values or {})
        assert self.enter(start, stop) == OK, self.messages
        assert self.exit() == OK, self.messages

    def step(self, t: float, h: float) -> int:
        """Makes a step, of which nothing may be asked and which may not end early."""
        flags = [ctypes.c_bool(True) for _ in range(3)]
        reached = ctypes.c_double(math.nan)
        pointers = [*(ctypes.byref(flag) for flag in flags), ctypes.byref(reached)]
        status = self.call("fmi3DoStep", ctypes.c_double(t), ctypes.c_double(h), True, *pointers)
        if status == OK:
            assert [flag.value for flag in flags] == [False, False, False]
            assert reached.value == t + h
        return status

    def save(self) -> ctypes.c_void_p:
        state = ctypes.c_void_p()
        assert self.call("fmi3GetFMUState", ctypes.byref(state)) == OK
        return state

    def restore(self, state: ctypes.c_void_p) -> int:
        return self.call("fmi3SetFMUState", state)

    def free(self, state: ctypes.c_void_p) -> None:
        assert self.call("fmi3FreeFMUState", ctypes.byref(state)) == OK
        assert state.value is None

    def serialise(self, state: ctypes.c_void_p) -> bytes:
        size = SIZE()
        assert self.call("fmi3SerializedFMUStateSize", state, ctypes.byref(size)) == OK
        buffer = ctypes.create_string_buffer(size.value)
        assert self.call("fmi3SerializeFMUState", state, buffer, size) == OK
        return buffer.raw

    def deserialise(self, data: bytes) -> tuple[int, ctypes.c_void_p]:
        state = ctypes.c_void_p()
        buffer = ctypes.create_string_buffer(data, max(len(data), 1))
        status = self.call("fmi3DeserializeFMUState", buffer, SIZE(len(data)), ctypes.byref(state))
        return status, state


class HeldInputs:
    """Steps an instance of either version with the inputs of `fmi_runs.SIGNALS`, held."""

    def __init__(self, fmu: Any, inputs: Sequence[str], outputs: Sequence[str]) -> None:
        self.fmu, self.inputs, self.outputs = fmu, inputs, outputs
        self._to, self._from = fmu.references(inputs), fmu.references(outputs)
        self._3 = isinstance(fmu, Instance3)

    def step(self, t: float, h: float) -> bytes:
        """Makes one step. Returns all Real outputs after it, as bytes."""
        count = SIZE(len(self.inputs))
        values = (ctypes.c_double * len(self.inputs))(*[SIGNALS[name](t) for name in self.inputs])
        name, more = ("fmi3SetFloat64", [count]) if self._3 else ("fmi2SetReal", [])
        assert self.fmu.call(name, self._to, count, values, *more) == OK
        assert self.fmu.step(t, h) == OK, self.fmu.messages
        return self.result()

    def result(self) -> bytes:
        values = (ctypes.c_double * len(self.outputs))()
        count = SIZE(len(self.outputs))
        name, more = ("fmi3GetFloat64", [count]) if self._3 else ("fmi2GetReal", [])
        assert self.fmu.call(name, self._from, count, values, *more) == OK
        return bytes(values)

    def run(self, steps: Sequence[tuple[float, float]]) -> list[bytes]:
        return [self.step(t, h) for t, h in steps]


def driver3(fmu: Instance3) -> HeldInputs:
    """Held inputs, and all Real outputs."""
    of_type = {n: v for n, v in fmu.variables.items() if v.type == "Float64"}
    inputs = [n for n, v in of_type.items() if v.causality == "input"]
    return HeldInputs(fmu, inputs, [n for n, v in of_type.items() if v.causality == "output"])
