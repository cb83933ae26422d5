"""What FMI 3.0 does not allow, or these FMUs do not have, is refused with a message."""

from __future__ import annotations

import ctypes
import math
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import fmpy
import pytest

from fmi3_instance import C_TYPES, SIZE, Instance3, driver3
from fmi_instance import ERROR, OK, WARNING
from fmi_runs import ESTIMATORS, PLANTS, names

every_fmu = pytest.mark.parametrize("name", ESTIMATORS + PLANTS)
Twin = Callable[[str], Path]
HEADER = (Path(fmpy.__file__).parent / "c-code" / "fmi3Functions.h").read_text()
FUNCTIONS = re.findall(r"^#define \w+\s+fmi3FullName\((\w+)\)", HEADER, re.MULTILINE)

INSTANTIATED, INITIALISATION, STEP, TERMINATED = "instantiated", "initialisation", "step", "end"
EVERYWHERE = {INSTANTIATED, INITIALISATION, STEP, TERMINATED}
SETTABLE = EVERYWHERE - {TERMINATED}
ALLOWED = {
    "fmi3SetDebugLogging": EVERYWHERE,
    "fmi3EnterInitializationMode": {INSTANTIATED},
    "fmi3ExitInitializationMode": {INITIALISATION},
    "fmi3Terminate": {STEP},
    "fmi3Reset": EVERYWHERE,
    "fmi3DoStep": {STEP},
    "fmi3GetFMUState": EVERYWHERE,
    "fmi3SetFMUState": EVERYWHERE,
    "fmi3FreeFMUState": EVERYWHERE,
    "fmi3SerializedFMUStateSize": EVERYWHERE,
    "fmi3SerializeFMUState": EVERYWHERE,
    "fmi3DeserializeFMUState": EVERYWHERE,
}
NOT_CALLED = {  # they have no instance to be called with, or end it
    "fmi3GetVersion",
    "fmi3InstantiateModelExchange",
    "fmi3InstantiateCoSimulation",
    "fmi3InstantiateScheduledExecution",
    "fmi3FreeInstance",
}
ACCESS = re.compile(r"fmi3([GS]et)((?:U?Int|Float)\d+|Boolean|String|Binary|Clock)")


def allowed(function: str) -> set[str]:
    """States in which the standard, section 2.3, allows a function of such an FMU."""
    access = ACCESS.fullmatch(function)
    if access:
        return EVERYWHERE if access[1] == "Get" else SETTABLE
    return ALLOWED.get(function, set())


def bring_to(fmu: Instance3, state: str) -> None:
    if state != INSTANTIATED:
        assert fmu.enter() == OK
    if state in (STEP, TERMINATED):
        assert fmu.exit() == OK
    if state == TERMINATED:
        assert fmu.call("fmi3Terminate") == OK


def test_the_binary_has_every_function_of_the_standard(estimator_twin: Path) -> None:
    assert len(FUNCTIONS) > 70
    with Instance3(estimator_twin) as fmu:
        for function in FUNCTIONS:
            assert fmu.dll[function]
        fmu.dll.fmi3GetVersion.restype = ctypes.c_char_p
        assert fmu.dll.fmi3GetVersion() == b"3.0"


@pytest.mark.parametrize("state", sorted(EVERYWHERE))
def test_a_function_is_refused_where_it_is_not_allowed(state: str, estimator_twin: Path) -> None:
    nothing = [ctypes.c_size_t(0)] * 12  # NULL, 0 or false for any argument
    for function in sorted(set(FUNCTIONS) - NOT_CALLED):
        if state in allowed(function):
            continue
        with Instance3(estimator_twin) as fmu:
            bring_to(fmu, state)
            fmu.messages.clear()
            assert fmu.call(function, *nothing) == ERROR, function
            assert len(fmu.messages) == 1, function
            status, category, message = fmu.messages[-1]
            assert (status, category) == (ERROR, "logStatusError")
            assert message.startswith(f"{function}: "), message
            assert "not allowed" in message or "has no" in message


def test_without_an_instance_every_function_fails_quietly(estimator_twin: Path) -> None:
    with Instance3(estimator_twin) as fmu:
        for function in sorted(set(FUNCTIONS) - NOT_CALLED):
            assert fmu.dll[function](*[None] * 12) == ERROR, function
        fmu.dll.fmi3FreeInstance(None)
        assert fmu.messages == []


@pytest.mark.parametrize(
    ("name", "kind"),
    [
        ("modality", "an Enumeration (Int64)"),
        ("rls.symmetric", "Boolean"),
        ("rls.n", "Int32"),
    ],
)
def test_a_variable_of_another_type_is_named_with_its_type(
    name: str, kind: str, estimator_twin: Path
) -> None:
    with Instance3(estimator_twin) as fmu:
        value = (ctypes.c_double * 1)()
        assert fmu.call("fmi3GetFloat64", fmu.references([name]), SIZE(1), value, SIZE(1)) == ERROR
        assert f"is {name}, which is {kind}." in fmu.last_message


STEP_RESULTS = ["eventHandlingNeeded", "terminateSimulation", "earlyReturn", "lastSuccessfulTime"]


@pytest.mark.parametrize("missing", range(4))
def test_a_step_needs_a_place_for_each_of_its_results(missing: int, estimator_twin: Path) -> None:
    with Instance3(estimator_twin) as fmu:
        fmu.initialise()
        time, step = ctypes.c_double(0.0), ctypes.c_double(1e-3)
        places = [ctypes.byref(ctypes.c_double()) for _ in STEP_RESULTS]
        given = [None if i == missing else place for i, place in enumerate(places)]
        assert fmu.call("fmi3DoStep", time, step, True, *given) == ERROR
        assert f"argument {STEP_RESULTS[missing]} is NULL" in fmu.last_message
        assert fmu.step(0.0, 1e-3) == OK


@pytest.mark.parametrize(
    ("options", "expected"),
    [
        ({"event_mode": True}, "hasEventMode is false"),
        ({"intermediate": [0]}, "providesIntermediateUpdate is false"),
        ({"token": "{not-this-one}"}, "{not-this-one}"),
        ({"token": ""}, "GUID"),
    ],
)
def test_an_instance_that_cannot_be_is_refused(
    options: dict[str, Any], expected: str, estimator_twin: Path
) -> None:
    with Instance3(estimator_twin, **options) as fmu:
        assert fmu.handle is None
        status, category, message = fmu.messages[-1]
        assert (status, category) == (ERROR, "logStatusError")
        assert message.startswith("fmi3InstantiateCoSimulation: ") and expected in message


@pytest.mark.parametrize("options", [{"early_return": True}, {"logger": False}])
def test_importers_with_other_wishes_can_run_it(
    options: dict[str, Any], estimator_twin: Path
) -> None:
    with Instance3(estimator_twin, **options) as fmu:
        fmu.initialise()
        assert fmu.step(0.0, 1e-3) == OK
        assert fmu.step(7.0, 1e-3) == ERROR


def test_other_kinds_of_fmus_are_refused(estimator_twin: Path) -> None:
    with Instance3(estimator_twin) as fmu:
        environment = [ctypes.c_void_p(4711), fmu._logger]
        assert fmu.instantiate("ModelExchange", *environment) is None
        assert "not for model exchange" in fmu.last_message
        assert fmu.instantiate("ScheduledExecution", *environment, None, None, None) is None
        assert "not for scheduled execution" in fmu.last_message


@every_fmu
def test_invalid_references_and_values_are_refused(name: str, twin: Twin) -> None:
    with Instance3(twin(name)) as fmu:
        driver = driver3(fmu)
        fmu.initialise()
        driver.step(0.0, 1e-3)
        before, one = driver.result(), SIZE(1)
        unknown = (ctypes.c_uint32 * 1)(100000)
        for function in (f for f in FUNCTIONS if ACCESS.fullmatch(f)):
            sizes = [(SIZE * 1)()] if function.endswith("Binary") else []
            assert fmu.call(function, unknown, one, *sizes, (ctypes.c_int64 * 1)(), one) == ERROR
            assert "unknown value reference 100000" in fmu.last_message
            theta = fmu.references([driver.inputs[0]])
            if "Float64" not in function:
                assert fmu.call(function, theta, one, *sizes, (ctypes.c_int64 * 1)(), one) == ERROR
                assert f"is {driver.inputs[0]}, which is Float64" in fmu.last_message
            assert fmu.call(function, None, one, *sizes, (ctypes.c_int64 * 1)(), one) == ERROR
            assert "valueReferences is NULL" in fmu.last_message
            assert fmu.call(function, theta, one, *sizes, None, one) == ERROR
            assert fmu.call(function, None, SIZE(0), *sizes, None, SIZE(0)) == OK
        for refused in names(fmu, "output") + names(fmu, "parameter", "fixed"):
            assert fmu.set(refused, 1) == ERROR
            assert f"{refused} cannot be set now" in fmu.last_message
        for tunable in names(fmu, "parameter", "tunable"):
            good = fmu.get(tunable)
            if fmu.variables[tunable].type == "Float64":
                for bad in (math.nan, math.inf):
                    assert fmu.set(tunable, bad) == ERROR
                    assert f"{tunable} = " in fmu.last_message
            assert fmu.get(tunable) == good
        assert fmu.set("time", 1.0) == ERROR
        assert "is time, which can only be read" in fmu.last_message
        assert fmu.get("time") == 1e-3
        assert driver.result() == before
        driver.step(1e-3, 1e-3)


@pytest.mark.parametrize("wrong", [0, 1, 3])
def test_each_reference_needs_one_value(wrong: int, estimator_twin: Path) -> None:
    with Instance3(estimator_twin) as fmu:
        references, values = fmu.references(["rls.c", "rls.a"]), (ctypes.c_double * 3)(0.5, 0.5)
        for function in ("fmi3SetFloat64", "fmi3GetFloat64"):
            assert fmu.call(function, references, SIZE(2), values, SIZE(wrong)) == ERROR
            assert f"nValues = {wrong}; expected 2" in fmu.last_message
        assert fmu.get("rls.a") == 0.1


@pytest.mark.parametrize("bad", [0, 4, -1, 2**31, 2**40, -(2**63), 2**63 - 1])
def test_an_enumeration_outside_its_items_is_refused(bad: int, estimator_twin: Path) -> None:
    with Instance3(estimator_twin) as fmu:
        assert fmu.set("modality", bad) == ERROR
        assert "modality = " in fmu.last_message and "[1, 3]" in fmu.last_message
        fmu.initialise()
        assert fmu.get("modality") == 1


@pytest.mark.parametrize("initialised", [False, True])
def test_every_parameter_has_its_start_value(initialised: bool, estimator_twin: Path) -> None:
    with Instance3(estimator_twin) as fmu:
        if initialised:
            fmu.initialise()
        for name in names(fmu, "parameter"):
            start = fmu.variables[name].start
            assert fmu.get(name) == float({"true": 1, "false": 0}.get(start, start)), name
        assert set(C_TYPES) == {v.type for v in fmu.variables.values()}


def test_an_impossible_experiment_is_refused(estimator_twin: Path) -> None:
    with Instance3(estimator_twin) as fmu:
        assert fmu.enter(stop=-1.0, tolerance=1e-6) == ERROR
        assert "stopTime = -1 is before startTime = 0" in fmu.last_message
        fmu.initialise(stop=0.01)
        assert fmu.step(0.0, 0.01) == OK
        assert fmu.step(0.01, 0.01) == ERROR
        assert "stopTime = 0.01" in fmu.last_message


def choose(fmu: Instance3, on: bool, *names: bytes) -> int:
    categories = (ctypes.c_char_p * len(names))(*names)
    return fmu.call("fmi3SetDebugLogging", on, SIZE(len(names)), categories)


def test_named_log_categories_are_turned_on_and_off(estimator_twin: Path) -> None:
    def logged(fmu: Instance3) -> list[str]:
        """Categories of the messages of an error, a warning and an event."""
        fmu.messages.clear()
        assert fmu.step(7.0, 1e-3) == ERROR
        assert choose(fmu, True, b"logStatusDiscard", b"no such category") == WARNING
        assert fmu.call("fmi3Reset") == OK
        fmu.initialise()
        return [category for _, category, _ in fmu.messages]

    error, warning, event = "logStatusError", "logStatusWarning", "logEvents"
    with Instance3(estimator_twin) as fmu:
        fmu.initialise()
        assert logged(fmu) == [error, warning, event]
        assert choose(fmu, True, b"logEvents") == OK  # the others stay
        assert logged(fmu) == [error, warning, event]
        assert choose(fmu, False, b"logStatusWarning") == OK
        assert logged(fmu) == [error, event]
        assert choose(fmu, False) == OK
        assert logged(fmu) == []
        assert choose(fmu, True, b"logStatusError") == OK
        assert logged(fmu) == [error]
        assert choose(fmu, True) == OK
        assert logged(fmu) == [error, warning, event]
    with Instance3(estimator_twin, logging_on=False) as fmu:
        fmu.initialise()
        assert logged(fmu) == [error]
