"""Pointers that are NULL although the standard requires an argument, and lack of memory."""

from __future__ import annotations

import ctypes
from pathlib import Path
from typing import Any

import pytest
from fmpy import fmi2

from fmi_instance import ERROR, OK, Instance

SIZE = ctypes.c_size_t(1)
BYTES = ctypes.create_string_buffer(1)
STATE = ctypes.byref(ctypes.c_void_p())
MISSING: list[tuple[str, str, tuple[Any, ...]]] = [
    ("fmi2GetFMUstate", "FMUstate", (None,)),
    ("fmi2SetFMUstate", "FMUstate", (None,)),
    ("fmi2SerializedFMUstateSize", "FMUstate", (None, ctypes.byref(SIZE))),
    ("fmi2SerializedFMUstateSize", "size", (BYTES, None)),
    ("fmi2SerializeFMUstate", "FMUstate", (None, BYTES, SIZE)),
    ("fmi2SerializeFMUstate", "serializedState", (BYTES, None, SIZE)),
    ("fmi2DeSerializeFMUstate", "serializedState", (None, SIZE, STATE)),
    ("fmi2DeSerializeFMUstate", "FMUstate", (BYTES, SIZE, None)),
    ("fmi2SetDebugLogging", "categories", (1, SIZE, None)),
]


@pytest.mark.parametrize(
    ("function", "argument", "arguments"), MISSING, ids=[f"{row[0]}-{row[1]}" for row in MISSING]
)
def test_an_argument_that_is_missing_is_named(
    function: str, argument: str, arguments: tuple[Any, ...], estimator_fmu: Path
) -> None:
    with Instance(estimator_fmu) as fmu:
        assert fmu.call(function, *arguments) == ERROR
        assert function in fmu.messages[-1][2] and argument in fmu.messages[-1][2]


@pytest.mark.parametrize("function", sorted({function for function, _, _ in MISSING}))
def test_a_call_without_an_instance_is_an_error(function: str, estimator_fmu: Path) -> None:
    with Instance(estimator_fmu) as fmu:
        arguments = next(a for name, _, a in MISSING if name == function)
        assert getattr(fmu.dll, function)(None, *arguments) == ERROR


@pytest.mark.parametrize(
    ("function", "name", "kind"),
    [
        ("fmi2SetReal", "modality", "Integer or Enumeration"),
        ("fmi2SetReal", "rls.symmetric", "Boolean"),
        ("fmi2GetInteger", "theta", "Real"),
        ("fmi2GetBoolean", "rls.n", "Integer or Enumeration"),
    ],
)
def test_a_variable_of_another_type_is_named_with_its_type(
    function: str, name: str, kind: str, estimator_fmu: Path
) -> None:
    with Instance(estimator_fmu) as fmu:
        fmu.initialise()
        value = ((ctypes.c_double if function == "fmi2SetReal" else ctypes.c_int) * 1)()
        assert fmu.call(function, fmu.references([name]), SIZE, value) == ERROR
        assert f"is {name}, which is {kind}." in fmu.messages[-1][2]


def test_derivatives_of_inputs_need_their_order(estimator_fmu: Path) -> None:
    with Instance(estimator_fmu) as fmu:
        fmu.initialise()
        value = (ctypes.c_double * 1)(1.0)
        theta = fmu.references(["theta"])
        assert fmu.call("fmi2SetRealInputDerivatives", theta, SIZE, None, value) == ERROR
        assert "argument order is NULL" in fmu.messages[-1][2]
        none = ctypes.c_size_t(0)
        assert fmu.call("fmi2SetRealInputDerivatives", None, none, None, None) == OK
        assert fmu.call("fmi2GetRealOutputDerivatives", None, none, None, None) == OK


def test_freeing_a_null_pointer_is_no_error(estimator_fmu: Path) -> None:
    with Instance(estimator_fmu) as fmu:
        assert fmu.call("fmi2FreeFMUstate", None) == OK


def test_lack_of_memory_for_a_state_is_an_error(estimator_fmu: Path) -> None:
    with Instance(estimator_fmu, memory=True) as fmu:
        fmu.initialise()
        data = fmu.serialise(fmu.save())
        full = False

        def allocate(count: int, size: int) -> int | None:
            return None if full else fmu.allocate(count, size)

        fmu.callbacks.allocateMemory = fmi2.fmi2CallbackAllocateMemoryTYPE(allocate)
        component = fmu.component
        fmu.component = fmu.dll.fmi2Instantiate(
            b"full", 1, fmu.description.guid.encode(), None, ctypes.byref(fmu.callbacks), 0, 1
        )
        try:
            assert fmu.component
            full = True
            state = ctypes.c_void_p()
            assert fmu.call("fmi2GetFMUstate", ctypes.byref(state)) == ERROR
            assert "out of memory" in fmu.messages[-1][2]
            assert fmu.deserialise(data)[0] == ERROR
            assert "out of memory" in fmu.messages[-1][2]
        finally:
            fmu.dll.fmi2FreeInstance(ctypes.c_void_p(fmu.component))
            fmu.component = component
