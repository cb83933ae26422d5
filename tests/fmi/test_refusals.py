"""Forbidden calls are refused with a message, and change nothing: FMI 2.0 and
3.0."""

import ctypes
import math
import re
from collections.abc import Callable
from functools import partial
from typing import Any

import pytest
from fmpy import fmi2

from fmi_functions import VARIABLES, of_an_instance
from fmi_instance import DISCARD, ERROR, OK, REAL, SIZE, WARNING, Instance, Instance3
from fmi_runs import ESTIMATORS, FMI2, PLANTS, Driver, Fmi, limits, names

every_fmu = pytest.mark.parametrize("name", ESTIMATORS + PLANTS)
each_kind = pytest.mark.parametrize("name", [*ESTIMATORS, "AwasPlant"])
ONE, NONE = SIZE(1), SIZE(0)


def error_of(fmu: Any) -> str:
    """The last message, which is of an error."""
    status, category, message = fmu.messages[-1]
    assert (status, category) == (ERROR, "logStatusError")
    return str(message)


def refused(fmu: Any, said: str, function: Callable[..., int], *arguments: Any) -> None:
    """Checks that a call is an error with this message, and that the state stays as it was."""
    before = fmu.saved()
    fmu.messages.clear()
    assert function(*arguments) == ERROR, said
    assert said in error_of(fmu)
    assert fmu.saved() == before


# Parameters and measurements


# Only at this limit, a relation to another parameter is violated: filter.V_min is not above V_max.
REFUSED_BY_A_RELATION = {("filter.V_max", "min")}


def far_beyond(fmu: Any, variable: Any, limit: float) -> list[float]:
    if variable.type == fmu.real:
        return [math.inf, -math.inf, math.nan]
    # In FMI 3.0 an enumeration has 64 bits.
    wide = fmu.types[variable.type][1] is ctypes.c_int64
    return [limit + 2**40, limit - 2**40] if wide else []


@every_fmu
def test_a_parameter_may_be_at_its_limits_and_not_beyond_them(name: str, fmi: Fmi) -> None:
    with fmi(name) as fmu:
        checked = 0
        for parameter in names(fmu, "parameter"):
            variable = fmu.variables[parameter]
            for which, limit, beyond in limits(variable):
                lowest, highest = (bound for _, bound, _ in limits(variable))
                said = f"out of its range {'(['[lowest > -math.inf]}{lowest:.9g}, {highest:.9g}"
                assert fmu.call("Reset") == fmu.enter() == OK
                start = fmu.get(parameter)
                for bad in (beyond, *far_beyond(fmu, variable, limit)):
                    assert fmu.set(parameter, bad) == ERROR
                    assert f"{parameter} = {bad:.9g} is {said}" in error_of(fmu)
                assert fmu.get(parameter) == start
                if math.isfinite(limit):
                    fmu.set_all({parameter: limit})
                related = (parameter, which) in REFUSED_BY_A_RELATION
                assert fmu.exit() == (ERROR if related else OK), parameter
                checked += 1
        assert checked > 20


@pytest.mark.parametrize(
    ("values", "named", "allowed"),
    [
        ({"motor.gamma": 0.0}, "motor.gamma = 0", "not 0"),
        ({"filter.V_min": 20.0}, "filter.V_min = 20", "<= filter.V_max"),
        ({"residual.K_I": 400.0, "samplePeriod": 0.005}, "residual.K_I = 400", "2 / samplePeriod"),
        ({"setPoint.offset": 1e308, "rls.eta_0[0,2]": 1.0}, "output sigma", "not finite"),
    ],
)
def test_parameters_that_contradict_each_other_are_named_at_the_end_of_the_initialisation(
    values: dict[str, float], named: str, allowed: str, fmi: Fmi
) -> None:
    with fmi(logging_on=False) as fmu:
        fmu.set_all(values)
        assert fmu.enter() == OK
        assert fmu.exit() == ERROR
        message = error_of(fmu)
        assert named in message and allowed in message
        assert fmu.step(0.0, 1e-3) == ERROR  # not initialised
        fmu.set_all({name: float(fmu.variables[name].start) for name in values})
        assert fmu.exit() == OK  # the instance is still in initialisation mode
        assert fmu.step(0.0, 1e-3) == OK


@pytest.mark.parametrize("name", ["theta", "q", "theta_c", "tau", "tau_e_sensor"])
def test_a_bad_measurement_skips_the_tick_and_warns_once(name: str, fmi: Fmi) -> None:
    good = {"theta": 0.1, "q": 0.11, "theta_c": 5.0, "tau": 0.2, "tau_e_sensor": 1.0}
    statuses = []
    with fmi().initialise({"modality": 2, "rls.P_0": 1.0, "rls.kind": 2}) as fmu:
        for k, bad in enumerate([None, None, math.nan, math.inf, 1e300, None, -math.inf]):
            before = fmu.get_all(["sigma", "tau_e", "theta_dot", "phi", "rho", "eta[0,0]"])
            fmu.set_all(good | ({name: bad} if bad is not None else {}))
            statuses.append(fmu.step(k * 1e-3, 1e-3))
            after = fmu.get_all(["sigma", "tau_e", "theta_dot", "phi", "rho", "eta[0,0]"])
            assert (before == after) == (bad is not None) and all(map(math.isfinite, after))
            assert fmu.get("valid") == (bad is None)
        warnings = [message for status, _, message in fmu.messages if status == WARNING]
    assert statuses == [OK, OK, WARNING, WARNING, WARNING, OK, WARNING]
    assert len(warnings) == 2  # one for each sequence of bad measurements
    assert name in warnings[0] and "skipped" in warnings[0]


def test_the_warning_says_if_the_regression_overflows(fmi: Fmi) -> None:
    with fmi().initialise() as fmu:
        fmu.set_all({"q": 1e12, "theta": -1e12})
        assert fmu.step(0.0, 1e-3) == WARNING
        assert "regression overflows at theta = -1e+12" in fmu.last_message


def test_a_bad_input_derivative_skips_the_ticks_that_use_it() -> None:
    with FMI2().initialise() as fmu:
        assert fmu.set_derivative("theta", math.nan) == OK
        assert fmu.step(0.0, 2e-3) == WARNING
        assert "expected theta finite" in fmu.last_message and "nan" in fmu.last_message
        assert fmu.step(2e-3, 1e-3) == OK
        assert fmu.get("valid") == 1


@pytest.mark.parametrize("method", [1, 2])
def test_a_deformation_far_beyond_its_range_is_reported_once(method: int, fmi: Fmi) -> None:
    with fmi() as fmu:
        for _ in range(2):  # after a reset it is reported again
            fmu.messages.clear()
            fmu.initialise({"method": method, "range.phi": 0.1})
            statuses = []
            for k, phi in enumerate((0.0, -0.07, -0.14, -0.21, -0.28, -0.35)):
                fmu.set_all({"q": phi})
                statuses.append(fmu.step(k * 1e-3, 1e-3))
            assert statuses == [OK, OK, OK, WARNING if method == 2 else OK, OK, OK]
            warnings = [message for status, _, message in fmu.messages if status == WARNING]
            assert len(warnings) == (method == 2)
            assert all("range.phi = 0.1" in text and "-0.21" in text for text in warnings)
            assert fmu.call("Reset") == OK


# Order of the calls

INSTANTIATED, INITIALISATION, STEP, TERMINATED = "instantiated", "initialisation", "step", "end"
EVERYWHERE = {INSTANTIATED, INITIALISATION, STEP, TERMINATED}
ALLOWED = {
    r"fmi.(SetDebugLogging|Reset|\w*FMU[Ss]tate\w*)": EVERYWHERE,
    r"fmi.(SetupExperiment|EnterInitializationMode)": {INSTANTIATED},
    r"fmi.ExitInitializationMode": {INITIALISATION},
    r"fmi.(DoStep|Terminate)": {STEP},
    r"fmi3[GS]etClock": set(),  # only in event mode
    rf"fmi3Get{VARIABLES}": EVERYWHERE,
    rf"fmi2Get{VARIABLES}": EVERYWHERE - {INSTANTIATED},
    rf"fmi.Set({VARIABLES}|RealInputDerivatives)": EVERYWHERE - {TERMINATED},
    r"fmi2Get\w*Status": {STEP, TERMINATED},
}
"""By functions, the states in which the standard allows them; others are not for these FMUs.

FMI 2.0, section 4.2.4; FMI 3.0, section 2.3.
"""


def allowed(function: str) -> set[str]:
    return next((ALLOWED[each] for each in ALLOWED if re.fullmatch(each, function)), set())


@pytest.mark.parametrize("state", sorted(EVERYWHERE))
def test_a_function_is_refused_where_the_standard_does_not_allow_it(state: str, fmi: Fmi) -> None:
    nothing = [NONE] * 12  # NULL, 0 or false for any argument
    with fmi() as fmu:
        every = of_an_instance(fmu.prefix)
    for function in every:
        with fmi() as fmu:
            if state != INSTANTIATED:
                assert fmu.enter() == OK
            if state in (STEP, TERMINATED):
                assert fmu.exit() == OK
            if state == TERMINATED:
                assert fmu.call("Terminate") == OK
            fmu.messages.clear()
            status = fmu.call(function, *nothing)
            refused = any("not allowed" in text for _, _, text in fmu.messages)
            if state in allowed(fmu.prefix + function):
                assert not refused, function
                if re.fullmatch(rf"[GS]et{VARIABLES}", function):
                    assert status == OK, function  # no references
                continue
            assert status == ERROR, function
            assert len(fmu.messages) == 1
            message = error_of(fmu)
            assert message.startswith(f"{fmu.prefix}{function}: "), message
            assert re.search("not allowed|has no", message)


def test_without_an_instance_every_function_fails_quietly(fmi: Fmi) -> None:
    with fmi() as fmu:
        for function in of_an_instance(fmu.prefix):
            assert fmu.dll[fmu.prefix + function](*[None] * 12) == ERROR, function
        fmu.dll[f"{fmu.prefix}FreeInstance"](None)
        version = fmu.dll[f"{fmu.prefix}GetVersion"]
        version.restype = ctypes.c_char_p
        assert version() == fmu.description.fmiVersion.encode()
        assert fmu.messages == []


# Arguments


@each_kind
def test_variables_are_accessed_as_the_standard_allows(name: str, fmi: Fmi) -> None:
    with fmi(name) as fmu:
        driver, unknown = Driver(fmu), (ctypes.c_uint * 2)(0, 100000)
        fmu.initialise()
        driver.step(0.0, 1e-3)
        first = driver.inputs[0]
        one, place = fmu.references([first]), (ctypes.c_int64 * 2)()
        n = [ONE] * (2 if fmi.kind is Instance3 else 1)
        for kind in {kind for kind, _ in fmu.types.values()}:
            for function in (f"Get{kind}", f"Set{kind}"):
                access, call = partial(fmu.access, function), partial(fmu.call, function)
                refused(fmu, "valueReferences is NULL", access, None, place)
                refused(fmu, "values is NULL", call, one, n[0], None, *n[1:])
                if kind == fmu.real:  # the first reference is good
                    refused(fmu, "unknown value reference 100000", access, unknown, place)
                else:
                    refused(fmu, f"is {first}, which is {fmu.real}", access, unknown, place)
                assert access(None, (ctypes.c_int64 * 0)()) == OK
        assert list(place) == [0, 0]  # nothing was read
        for constant in names(fmu, "output") + names(fmu, "parameter", "fixed"):
            refused(fmu, f"{constant} cannot be set now", fmu.set, constant, 1)
        for tunable in names(fmu, "parameter", "tunable"):
            if fmu.variables[tunable].type == fmu.real:
                refused(fmu, f"{tunable} = nan is out of", fmu.set, tunable, math.nan)
        if fmi.kind is Instance3:
            refused(fmu, "is time, which can only be read", fmu.set, "time", 1.0)
            assert fmu.get("time") == 1e-3
        driver.step(1e-3, 1e-3)


BYTES, STATE = ctypes.create_string_buffer(1), ctypes.byref(ctypes.c_void_p())
TWO, INPUTS, VALUES = SIZE(2), (ctypes.c_uint * 2)(0, 1), (REAL * 2)(7.0, 7.0)
RESULTS = ["eventHandlingNeeded", "terminateSimulation", "earlyReturn", "lastSuccessfulTime"]
ONE_NULL = [[None if i == k else ctypes.byref(REAL()) for i in range(4)] for k in range(4)]

WRONG: dict[str, list[tuple[str, str, tuple[Any, ...]]]] = {
    "fmi2": [
        ("GetFMUstate", "argument FMUState is NULL", (None,)),
        ("SetFMUstate", "argument FMUState is NULL", (None,)),
        ("SerializedFMUstateSize", "argument FMUState is NULL", (None, ctypes.byref(ONE))),
        ("SerializedFMUstateSize", "argument size is NULL", (BYTES, None)),
        ("SerializeFMUstate", "argument FMUState is NULL", (None, BYTES, ONE)),
        ("SerializeFMUstate", "argument serializedState is NULL", (BYTES, None, ONE)),
        ("DeSerializeFMUstate", "argument serializedState is NULL", (None, ONE, STATE)),
        ("DeSerializeFMUstate", "argument FMUState is NULL", (BYTES, ONE, None)),
        ("SetDebugLogging", "argument categories is NULL", (1, ONE, None)),
        ("SetRealInputDerivatives", "argument order is NULL", (INPUTS, TWO, None, VALUES)),
        ("SetRealInputDerivatives", "expected 1", (INPUTS, TWO, (ctypes.c_int * 2)(1, 2), VALUES)),
        ("GetRealStatus", "argument value is NULL", (2, None)),
        ("CancelStep", "has no steps that run asynchronously", ()),
    ],
    "fmi3": [
        *(
            ("DoStep", f"argument {name} is NULL", (REAL(1.002), REAL(1e-3), True, *given))
            for name, given in zip(RESULTS, ONE_NULL, strict=True)
        ),
        *(
            (f, f"nValues = {wrong}; expected 2", (INPUTS, TWO, VALUES, SIZE(wrong)))
            for f in ("SetFloat64", "GetFloat64")
            for wrong in (0, 1, 3)
        ),
        *(
            (f, "which is Float64", (INPUTS, TWO, (SIZE * 2)(), VALUES, TWO))
            for f in ("SetBinary", "GetBinary")
        ),
    ],
}
"""Calls by the version of FMI: function, part of the message, and arguments."""


@each_kind
def test_a_wrong_argument_is_named_and_changes_nothing(name: str, fmi: Fmi) -> None:
    with fmi(name).initialise(start=1.0) as fmu:
        driver = Driver(fmu)
        driver.run([(1.0, 1e-3), (1.001, 1e-3)])
        for function, said, arguments in WRONG[fmu.prefix]:
            refused(fmu, said, fmu.call, function, *arguments)
            assert fmu.last_message.startswith(f"{fmu.prefix}{function}: ")
        for said, t, h in [
            ("currentCommunicationPoint = 1.001 s; expected 1.002 s", 1.001, 1e-3),  # backwards
            ("currentCommunicationPoint = 1.00201 s; expected 1.002 s", 1.00201, 2.0),
            ("currentCommunicationPoint", math.nan, 1e-3),
            ("communicationStepSize = 0 s", 1.002, 0.0),
            ("communicationStepSize", 1.002, math.nan),
            ("communicationStepSize", 1.002, math.inf),
        ]:
            refused(fmu, f"{fmu.prefix}DoStep: {said}", fmu.step, t, h)
        driver.step(1.002, 1e-3)


def test_derivatives_are_those_of_inputs_and_may_be_none() -> None:
    with FMI2().initialise() as fmu:
        refused(fmu, "motor.B is not an input", fmu.set_derivative, "motor.B", 1.0)
        assert fmu.call("SetRealInputDerivatives", None, NONE, None, None) == OK


# Instances


@pytest.mark.parametrize("token", ["{not-this-one}", ""])
def test_a_wrong_token_is_refused_with_both_values(token: str, fmi: Fmi) -> None:
    with fmi(token=token) as fmu:
        assert fmu.component is None
        message = error_of(fmu)
        assert message.startswith(f"{fmu.prefix}Instantiate")
        assert token in message and fmu.description.guid in message


@pytest.mark.parametrize(
    ("instance", "said"), [(None, "is NULL"), ("", "is empty"), (" \t\n\r", "is empty")]
)
def test_a_name_without_a_character_is_refused(instance: str | None, said: str, fmi: Fmi) -> None:
    with fmi(name=instance) as fmu:
        assert fmu.component is None
        (message,) = fmu.messages
        assert message[:2] == (ERROR, "logStatusError")
        assert message[2].startswith(f"{fmu.prefix}Instantiate")
        assert message[2].endswith(f": argument instanceName {said}.")


def test_other_kinds_and_promises_of_fmi_3_are_refused(fmi3: Fmi) -> None:
    for options, expected in (
        ({"event_mode": True}, "hasEventMode is false"),
        ({"intermediate": [0]}, "providesIntermediateUpdate is false"),
    ):
        with fmi3(**options) as fmu:
            assert fmu.component is None
            assert expected in fmu.last_message
    with fmi3() as fmu:
        environment = [ctypes.c_void_p(4711), fmu.logger]
        assert fmu.instantiate("ModelExchange", *environment) is None
        assert "not for model exchange" in fmu.last_message
        assert fmu.instantiate("ScheduledExecution", *environment, None, None, None) is None
        assert "not for scheduled execution" in fmu.last_message


def test_an_instantiation_that_fails_returns_null() -> None:
    with FMI2() as fmu:
        instantiate, guid = fmu.dll.fmi2Instantiate, fmu.description.guid.encode()
        callbacks = ctypes.byref(fmu.callbacks)
        for arguments, said in [
            ((b"test", 0, guid, None, callbacks), "not for model exchange"),
            ((None, 1, guid, None, callbacks), "instanceName is NULL"),
            ((b"test", 1, None, None, callbacks), "the importer gave NULL"),
            ((b"test", 1, b"100%s", None, callbacks), "100%%s"),  # escaped
        ]:
            assert instantiate(*arguments, 0, 0) is None
            assert fmu.last_message.startswith("fmi2Instantiate: ") and said in fmu.last_message
        assert instantiate(b"test", 1, guid, None, None, 0, 0) is None


@pytest.mark.parametrize(
    ("version", "options"),
    [
        *((2, {"resources": name}) for name in (None, "", "/tmp/x", "file:/tmp/x", "file:////x")),
        *((2, {"memory": True}), (2, {"logger": False})),
        *((3, {"early_return": True}), (3, {"logger": False})),
    ],
)
def test_importers_with_unusual_arguments_can_run_it(
    version: int, options: dict[str, Any], fmi3: Fmi
) -> None:
    with (FMI2 if version == 2 else fmi3)(**options) as fmu:
        assert fmu.set("rls.n", 3) == OK  # before ...
        assert fmu.enter() == OK
        assert fmu.set("rls.m", 2) == OK  # ... and in initialisation mode
        assert fmu.exit() == OK
        assert fmu.step(0.0, 1e-3) == OK
        assert fmu.step(5.0, 1e-3) == ERROR  # with a message, even if there is no logger


def limit_memory(fmu: Instance, full: Callable[[], bool]) -> Callable[[], int | None]:
    """Makes instances of an importer that has no more memory when it is full."""

    def allocate(count: int, size: int) -> int | None:
        return None if full() else fmu.allocate(count, size)

    fmu.callbacks.allocateMemory = fmi2.fmi2CallbackAllocateMemoryTYPE(allocate)
    arguments = (fmu.description.guid.encode(), None, ctypes.byref(fmu.callbacks), 0, 1)
    return lambda: fmu.dll.fmi2Instantiate(b"full", 1, *arguments)


@pytest.mark.parametrize("after", range(3))
def test_lack_of_memory_gives_no_instance_and_no_leak(after: int) -> None:
    """The importer has no more memory after `after` blocks."""
    with FMI2(memory=True) as fmu:
        before = set(fmu.blocks)
        assert len(before) == 3
        assert limit_memory(fmu, lambda: len(fmu.blocks) == 3 + after)() is None
        assert "out of memory" in fmu.last_message
        assert fmu.blocks == before


def test_lack_of_memory_for_a_state_is_an_error() -> None:
    with FMI2(memory=True).initialise() as fmu:
        data, first, full = fmu.serialise(fmu.save()), fmu.component, False
        fmu.component = limit_memory(fmu, lambda: full)()
        full = True
        assert fmu.call("GetFMUstate", STATE) == ERROR
        assert "out of memory" in fmu.last_message
        assert fmu.deserialise(data)[0] == ERROR
        assert "out of memory" in fmu.last_message
        fmu.dll.fmi2FreeInstance(ctypes.c_void_p(fmu.component))
        fmu.component = first


# Messages


def choose(fmu: Any, on: bool, *names: bytes) -> int:
    categories = (ctypes.c_char_p * len(names))(*names)
    return int(fmu.call("SetDebugLogging", on, SIZE(len(names)), categories))


@pytest.mark.parametrize(
    ("on", "chosen", "passed"),
    [
        (True, [], {"logEvents", "logStatusWarning", "logStatusDiscard", "logStatusError"}),
        (False, [], {"logStatusWarning", "logStatusDiscard", "logStatusError"}),
        (True, ["logEvents"], {"logEvents"}),
        (True, ["logStatusDiscard", "logStatusWarning"], {"logStatusDiscard", "logStatusWarning"}),
    ],
)
def test_a_message_is_logged_if_its_category_was_chosen(
    on: bool, chosen: list[str], passed: set[str]
) -> None:
    with FMI2(logging_on=not on) as fmu:
        assert choose(fmu, on, *map(str.encode, chosen)) == OK
        fmu.initialise()  # logs an event
        fmu.set_all({"theta": math.nan})
        assert fmu.step(0.0, 1e-3) == WARNING
        fmu.call("GetStatus", 0, ctypes.byref(ctypes.c_int()))  # returns fmi2Discard
        assert fmu.step(5.0, 1e-3) == ERROR
        assert {category for _, category, _ in fmu.messages} == passed


def test_in_fmi_3_named_log_categories_are_turned_on_and_off(fmi3: Fmi) -> None:
    def logged(fmu: Instance3) -> list[str]:
        """Categories of the messages of an error, a warning and an event."""
        fmu.messages.clear()
        assert fmu.step(7.0, 1e-3) == ERROR
        assert choose(fmu, True, b"logStatusDiscard", b"no such category") == WARNING
        assert fmu.call("Reset") == OK
        fmu.initialise()
        return [category for _, category, _ in fmu.messages]

    error, warning, event = "logStatusError", "logStatusWarning", "logEvents"
    with fmi3().initialise() as fmu:
        assert logged(fmu) == [error, warning, event]
        assert choose(fmu, True, b"logEvents") == OK  # the others stay
        assert logged(fmu) == [error, warning, event]
        assert choose(fmu, False, b"logStatusWarning") == OK
        assert logged(fmu) == [error, event]
        assert choose(fmu, False) == OK
        assert logged(fmu) == []
        assert choose(fmu, True, b"logStatusError") == OK
        assert logged(fmu) == [error]
    with fmi3(logging_on=False).initialise() as fmu:
        assert logged(fmu) == [error]


@pytest.mark.parametrize("name", ["Gelenk \u00fc \u03c3\u0302 \u20ac \U0001f9be", "100 %s"])
def test_the_logger_gets_the_name_of_the_instance(name: str) -> None:
    with FMI2(name=name, logging_on=False).initialise() as fmu:
        assert fmu.step(5.0, 1e-3) == ERROR
        assert fmu.names == {name}


def test_messages_show_texts_of_the_importer_in_ascii() -> None:
    """So messages are UTF-8 for any bytes of the importer, even if a long message is cut."""
    with FMI2(token="{\udcff}") as fmu:
        assert "{?}" in fmu.last_message
    with FMI2() as fmu:
        assert choose(fmu, True, b"log\xc3(") == WARNING
        assert "unknown category log?(" in fmu.last_message
    with FMI2(token="\u20ac" * 300) as fmu:
        assert "?" * 150 in fmu.last_message and fmu.last_message.isascii()


# Times


@pytest.mark.parametrize(
    ("said", "times"),
    [
        ("startTime", {"start": math.inf}),
        ("stopTime = -1 is before startTime = 0", {"stop": -1.0}),
        ("tolerance = ", {"tolerance": -1e-6}),
        ("tolerance = ", {"tolerance": math.inf}),
        ("stopTime", {"stop": math.nan}),
    ],
)
def test_an_impossible_experiment_is_refused(said: str, times: dict[str, float], fmi: Fmi) -> None:
    with fmi() as fmu:
        refused(fmu, said, partial(fmu.enter, **times))
        fmu.initialise()
        assert fmu.step(0.0, 1e-3) == OK


@each_kind
def test_a_step_after_the_stop_time_is_refused(name: str, fmi: Fmi) -> None:
    for h in (1e-4, 0.01):
        with fmi(name) as fmu:
            count = round(0.01 / h)
            fmu.initialise(start=1.0, stop=1.01)
            Driver(fmu, held=True).run([(1.0 + k * h, h) for k in range(count)])
            state = fmu.save()
            assert fmu.call("Reset") == OK
            fmu.initialise()
            assert fmu.restore(state) == OK  # with its stop time
            fmu.free(state)
            for late in (h, 2.1e-3 * h, h):
                said = "expected an end not after stopTime = 1.01 s"
                refused(fmu, said, fmu.step, 1.0 + count * h, late)
            assert fmu.step(1.0 + count * h, 1e-13) == OK  # a step that rounding can cause


TOO_LARGE = "more than 11000 internal steps. Expected inputs and parameters of a joint; the largest"


@pytest.mark.parametrize(
    ("name", "said", "start", "h", "inputs"),
    [
        ("StiffnessEstimator", "1e+09 s is more than 1e+09 times samplePeriod", {}, 1e9, {}),
        (
            *("AwasPlant", "1e+07 s is more than 1e+15 times noise.samplePeriod"),
            *({"noise.samplePeriod": 1e-9}, 1e7, {}),
        ),
        ("AwasPlant", "finite input tau, received nan", {}, 1.0, {"tau": (math.nan, 0)}),
        ("AwasPlant", "finite input tau_c, received inf", {}, 1.0, {"tau_c": (math.inf, 0)}),
        (
            *("AwasPlant", "finite input tau, received 1.7e+308 at its begin and inf at its end"),
            *({}, 1.0, {"tau": (1.7e308, 1.7e308)}),
        ),
        ("AwasPlant", "no solution", {}, 1.0, {"tau_ext": (1e300, 0)}),
        ("AwasPlant", "no solution", {}, 1.0, {"tau_ext": (0, 1e26)}),  # has one at first
        ("AwasPlant", f"{TOO_LARGE} input is tau = -1e+09", {}, 1e-3, {"tau": (-1e9, 0)}),
        (
            *("AntagonisticVsaPlant", f"{TOO_LARGE} input is tau_1 = -1e+09"),
            *({}, 1e-3, {"tau_1": (-1e9, 0)}),
        ),
    ],
)
def test_a_step_that_a_model_cannot_make_is_refused_and_can_be_made_otherwise(
    name: str, said: str, start: dict[str, float], h: float, inputs: dict[str, tuple[float, float]]
) -> None:
    with FMI2(name).initialise(start) as fmu:
        for wanted, (value, slope) in inputs.items():
            assert fmu.set(wanted, value) == fmu.set_derivative(wanted, slope) == OK
        refused(fmu, said, fmu.step, 0.0, h)
        for wanted in inputs:
            assert fmu.set(wanted, 0.0) == fmu.set_derivative(wanted, 0.0) == OK
        assert fmu.step(0.0, 1e-3) == OK


def test_a_step_has_a_finite_end() -> None:
    with FMI2("AwasPlant").initialise({"noise.samplePeriod": 1e300}, start=1e308) as fmu:
        refused(fmu, "ends beyond the largest number", fmu.step, 1e308, 1e308)


def test_the_status_gives_the_time_that_was_reached() -> None:
    time, number, text = REAL(-1.0), ctypes.c_int(7), ctypes.c_char_p(b"unchanged")

    def reached(fmu: Instance) -> float:
        assert fmu.call("GetRealStatus", 2, ctypes.byref(time)) == OK
        return time.value

    with FMI2().initialise(start=0.5) as fmu:
        assert reached(fmu) == 0.5
        assert fmu.step(0.5, 1e-3) == OK
        assert fmu.step(0.7, 1e-3) == ERROR
        assert reached(fmu) == 0.5 + 1e-3
        state = fmu.save()
        assert fmu.step(0.501, 0.25) == OK
        assert reached(fmu) == 0.501 + 0.25
        assert fmu.restore(state) == OK
        assert reached(fmu) == 0.5 + 1e-3
        fmu.free(state)
        assert fmu.call("GetBooleanStatus", 3, ctypes.byref(number)) == OK
        assert number.value == 0  # it does not request the end of the simulation
        for what in ("", "Real", "Integer", "Boolean", "String"):
            value = {"Real": time, "String": text}.get(what, number)
            assert (
                fmu.call(f"Get{what}Status", int(what == "String"), ctypes.byref(value)) == DISCARD
            )
            assert f"Get{what}Status" in fmu.last_message
