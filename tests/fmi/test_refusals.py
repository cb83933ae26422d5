"""What no importer may do is refused with a message, and changes nothing: FMI 2.0 and 3.0."""

import ctypes
import math
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import fmpy
import pytest
from fmpy import fmi2

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


# Parameters and measurements


# At this limit alone, a relation to another parameter is not met: filter.V_min is not above V_max.
REFUSED_BY_A_RELATION = {("filter.V_max", "min")}


def refusal(fmu: Instance, name: str, value: float) -> str:
    """The message when a parameter is set and initialised; empty if it is accepted."""
    assert fmu.call("Reset") == OK
    if fmu.set(name, value) == OK and fmu.enter() == OK and fmu.exit() == OK:
        return ""
    return error_of(fmu)


@every_fmu
def test_a_parameter_at_its_limit_is_accepted_and_beyond_it_refused_by_its_name(name: str) -> None:
    with FMI2(name) as fmu:
        checked = 0
        for parameter in names(fmu, "parameter"):
            for which, limit, beyond in limits(fmu.variables[parameter]):
                if math.isfinite(limit):
                    refused = refusal(fmu, parameter, limit) != ""
                    assert refused == ((parameter, which) in REFUSED_BY_A_RELATION), parameter
                assert parameter in refusal(fmu, parameter, beyond)
                checked += 1
        assert checked > 20


@pytest.mark.parametrize(
    ("name", "bad", "allowed"),
    [
        ("samplePeriod", math.nan, "[1e-09, inf)"),
        ("filter.kind", 4, "[1, 3]"),
        ("modality", 2**40, "[1, 3]"),  # in FMI 3.0 an enumeration has 64 bits
        ("modality", -(2**63), "[1, 3]"),
        ("rls.n", 9, "[1, 8]"),
        ("rls.eta_0[1,2]", math.inf, "(-inf, inf)"),
    ],
)
def test_a_parameter_out_of_range_is_refused_where_it_is_set(
    name: str, bad: float, allowed: str, fmi: Fmi
) -> None:
    with fmi() as fmu:
        start = fmu.get(name) if fmi.kind is Instance3 else float(fmu.variables[name].start)
        assert fmu.set(name, bad) == ERROR
        message = error_of(fmu)
        assert f"{name} = " in message and allowed in message
        assert fmu.enter() == OK  # it still has its start value
        assert fmu.get(name) == start
        assert fmu.set(name, bad) == ERROR
        assert fmu.exit() == OK
        assert fmu.step(0.0, 1e-3) == OK


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
            for k, phi in enumerate((0.0, 0.2, -0.21, 0.3, 0.0, 0.3)):
                fmu.set_all({"q": phi})
                statuses.append(fmu.step(k * 1e-3, 1e-3))
            assert statuses == [OK, OK, WARNING if method == 2 else OK, OK, OK, OK]
            warnings = [message for status, _, message in fmu.messages if status == WARNING]
            assert len(warnings) == (method == 2)
            assert all("range.phi = 0.1" in text and "-0.21" in text for text in warnings)
            assert fmu.call("Reset") == OK


# Order of the calls

INSTANTIATED, INITIALISATION, STEP, TERMINATED = "instantiated", "initialisation", "step", "end"
EVERYWHERE = {INSTANTIATED, INITIALISATION, STEP, TERMINATED}
VARIABLES = r"(Real|Integer|Boolean|String|(U?Int|Float)\d+|Binary|Clock)"
ALLOWED = {
    r"fmi.(SetDebugLogging|Reset|\w*FMU[Ss]tate\w*)": EVERYWHERE,
    r"fmi.(SetupExperiment|EnterInitializationMode)": {INSTANTIATED},
    r"fmi.ExitInitializationMode": {INITIALISATION},
    r"fmi.(DoStep|Terminate)": {STEP},
    rf"fmi3Get{VARIABLES}": EVERYWHERE,
    rf"fmi2Get({VARIABLES}|DirectionalDerivative)": EVERYWHERE - {INSTANTIATED},
    rf"fmi.Set({VARIABLES}|RealInputDerivatives)": EVERYWHERE - {TERMINATED},
    r"fmi2Get(RealOutputDerivatives|\w*Status)": {STEP, TERMINATED},
}
"""By functions, the states in which the standard allows them; others are not for these FMUs.

FMI 2.0, section 4.2.4; FMI 3.0, section 2.3.
"""


def allowed(function: str) -> set[str]:
    return next((ALLOWED[each] for each in ALLOWED if re.fullmatch(each, function)), set())


def functions(fmu: Any) -> list[str]:
    """Functions of the standard that take an instance and leave it."""
    header = Path(fmpy.__file__).parent / "c-code" / f"{fmu.prefix}Functions.h"
    pattern = rf"^#define \w+\s+{fmu.prefix}FullName\({fmu.prefix}(\w+)\)"
    found = re.findall(pattern, header.read_text(), re.MULTILINE)
    others = re.compile(r"Instantiate|FreeInstance|GetVersion|GetTypesPlatform|CancelStep")
    return [f for f in found if not others.match(f) and hasattr(fmu.dll, fmu.prefix + f)]


@pytest.mark.parametrize("state", sorted(EVERYWHERE))
def test_a_function_is_refused_where_the_standard_does_not_allow_it(state: str, fmi: Fmi) -> None:
    nothing = [NONE] * 12  # NULL, 0 or false for any argument
    with fmi() as fmu:
        every = functions(fmu)
    assert len(every) > 25
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
                continue
            assert status == ERROR, function
            assert len(fmu.messages) == 1
            message = error_of(fmu)
            assert message.startswith(f"{fmu.prefix}{function}: "), message
            assert refused or "has no" in message


def test_without_an_instance_every_function_fails_quietly(fmi: Fmi) -> None:
    with fmi() as fmu:
        for function in functions(fmu):
            assert fmu.dll[fmu.prefix + function](*[None] * 12) == ERROR, function
        fmu.dll[f"{fmu.prefix}FreeInstance"](None)
        version = fmu.dll[f"{fmu.prefix}GetVersion"]
        version.restype = ctypes.c_char_p
        assert version() == fmu.description.fmiVersion.encode()
        assert fmu.messages == []


# Arguments


@each_kind
def test_invalid_references_and_values_are_refused(name: str, fmi: Fmi) -> None:
    with fmi(name) as fmu:
        driver = Driver(fmu)
        fmu.initialise()
        driver.step(0.0, 1e-3)
        before, unknown = driver.result(), (ctypes.c_uint * 1)(100000)
        theta, place = fmu.references([driver.inputs[0]]), (ctypes.c_int64 * 1)()
        for kind in {kind for kind, _ in fmu.types.values()}:
            for function in (f"Get{kind}", f"Set{kind}"):
                assert fmu.access(function, unknown, place) == ERROR
                assert "unknown value reference 100000" in fmu.last_message
                assert fmu.access(function, None, place) == ERROR
                assert "valueReferences is NULL" in fmu.last_message
                n = [ONE] * (2 if fmi.kind is Instance3 else 1)
                assert fmu.call(function, theta, n[0], None, *n[1:]) == ERROR
                if kind != fmu.real:
                    assert fmu.access(function, theta, place) == ERROR
                    assert f"is {driver.inputs[0]}, which is {fmu.real}" in fmu.last_message
                assert fmu.access(function, None, (ctypes.c_int64 * 0)()) == OK
        assert place[0] == 0  # nothing was read
        for refused in names(fmu, "output") + names(fmu, "parameter", "fixed"):
            assert fmu.set(refused, 1) == ERROR
            assert f"{refused} cannot be set now" in fmu.last_message
        for tunable in names(fmu, "parameter", "tunable"):
            good = fmu.get(tunable)
            if fmu.variables[tunable].type == fmu.real:
                for bad in (math.nan, math.inf):
                    assert fmu.set(tunable, bad) == ERROR
                    assert f"{tunable} = " in fmu.last_message and "range" in fmu.last_message
            assert fmu.get(tunable) == good
        if fmi.kind is Instance3:
            assert fmu.set("time", 1.0) == ERROR
            assert "is time, which can only be read" in fmu.last_message
            assert fmu.get("time") == 1e-3
        assert driver.result() == before
        driver.step(1e-3, 1e-3)


def test_a_set_with_one_bad_reference_changes_nothing(fmi: Fmi) -> None:
    with fmi().initialise() as fmu:
        references = (ctypes.c_uint * 2)(fmu.reference("tau"), 100000)
        assert fmu.access(f"Set{fmu.real}", references, (REAL * 2)(7.0, 7.0)) == ERROR
        assert fmu.get("tau") == 0.0


BYTES, STATE = ctypes.create_string_buffer(1), ctypes.byref(ctypes.c_void_p())


@pytest.mark.parametrize(
    ("function", "argument", "arguments"),
    [
        ("GetFMUstate", "FMUstate", (None,)),
        ("SetFMUstate", "FMUstate", (None,)),
        ("SerializedFMUstateSize", "FMUstate", (None, ctypes.byref(ONE))),
        ("SerializedFMUstateSize", "size", (BYTES, None)),
        ("SerializeFMUstate", "FMUstate", (None, BYTES, ONE)),
        ("SerializeFMUstate", "serializedState", (BYTES, None, ONE)),
        ("DeSerializeFMUstate", "serializedState", (None, ONE, STATE)),
        ("DeSerializeFMUstate", "FMUstate", (BYTES, ONE, None)),
        ("SetDebugLogging", "categories", (1, ONE, None)),
    ],
)
def test_an_argument_that_is_missing_is_named(
    function: str, argument: str, arguments: tuple[Any, ...]
) -> None:
    with FMI2() as fmu:
        assert fmu.call(function, *arguments) == ERROR
        assert function in fmu.last_message and argument in fmu.last_message


def test_derivatives_of_inputs_need_an_input_and_the_order_1() -> None:
    with FMI2().initialise() as fmu:
        tau, value = fmu.references(["tau"]), (REAL * 1)(1.0)
        assert fmu.set_derivative("tau", 1.0, order=2) == ERROR
        assert fmu.set_derivative("motor.B", 1.0) == ERROR
        assert fmu.call("SetRealInputDerivatives", tau, ONE, None, value) == ERROR
        assert "argument order is NULL" in fmu.last_message
        assert fmu.call("SetRealInputDerivatives", None, NONE, None, None) == OK
        assert fmu.call("GetRealOutputDerivatives", None, NONE, None, None) == OK


RESULTS = ["eventHandlingNeeded", "terminateSimulation", "earlyReturn", "lastSuccessfulTime"]


def test_a_step_needs_a_place_for_each_of_its_results(fmi3: Fmi) -> None:
    with fmi3().initialise() as fmu:
        for missing, name in enumerate(RESULTS):
            given = [None if i == missing else ctypes.byref(REAL()) for i in range(4)]
            assert fmu.call("DoStep", REAL(0.0), REAL(1e-3), True, *given) == ERROR
            assert f"argument {name} is NULL" in fmu.last_message
        assert fmu.step(0.0, 1e-3) == OK


def test_each_reference_needs_one_value(fmi3: Fmi) -> None:
    with fmi3() as fmu:
        references, values = fmu.references(["rls.c", "rls.a"]), (REAL * 3)(0.5, 0.5)
        for function in ("SetFloat64", "GetFloat64"):
            for wrong in (0, 1, 3):
                assert fmu.call(function, references, SIZE(2), values, SIZE(wrong)) == ERROR
                assert f"nValues = {wrong}; expected 2" in fmu.last_message
        assert fmu.get("rls.a") == 0.1


# Instances


@pytest.mark.parametrize("token", ["{not-this-one}", ""])
def test_a_wrong_token_is_refused_with_both_values(token: str, fmi: Fmi) -> None:
    with fmi(token=token) as fmu:
        assert fmu.component is None
        message = error_of(fmu)
        assert message.startswith(f"{fmu.prefix}Instantiate")
        assert token in message and fmu.description.guid in message


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


@pytest.mark.parametrize(
    ("name", "shown"),
    [
        ("Gel\udce4nk", "Gel?nk"),
        ("\udced\udca0\udc80", "???"),
        ("Gelenk \u00fc \u03c3\u0302 \u20ac \U0001f9be", None),
        ("100 %s", None),
    ],
)
def test_the_name_of_an_instance_is_shown_without_bytes_that_are_not_utf8(
    name: str, shown: str | None
) -> None:
    with FMI2(name=name, logging_on=False) as fmu:
        assert [status for status, _, _ in fmu.messages] == [WARNING] * (shown is not None)
        assert all("not UTF-8" in text and str(shown) in text for _, _, text in fmu.messages)
        fmu.initialise()
        assert fmu.step(5.0, 1e-3) == ERROR
        assert fmu.names == {shown or name}


def test_messages_about_texts_that_are_not_utf8_are_utf8() -> None:
    with FMI2(token="{\udcff}") as fmu:
        assert "{?}" in fmu.last_message
    with FMI2() as fmu:
        assert choose(fmu, True, b"log\xc3(") == WARNING
        assert "unknown category log?(" in fmu.last_message
    for length in range(300, 304):  # a long message is not cut inside a character
        with FMI2(token="x" * (length - 300) + "\u20ac" * length) as fmu:
            assert "\u20ac" * 50 in fmu.last_message


# Times


@pytest.mark.parametrize(
    ("times", "expected"),
    [
        ({"start": math.inf}, "startTime"),
        ({"stop": -1.0}, "stopTime = -1 is before startTime = 0"),
        ({"stop": math.nan}, "stopTime"),
        ({"tolerance": -1e-6}, "tolerance = "),
        ({"tolerance": math.inf}, "tolerance = "),
    ],
)
def test_an_impossible_experiment_is_refused(
    times: dict[str, float], expected: str, fmi: Fmi
) -> None:
    with fmi() as fmu:
        assert fmu.enter(**times) == ERROR
        assert expected in fmu.last_message
        fmu.initialise()
        assert fmu.step(0.0, 1e-3) == OK


@each_kind
def test_a_step_after_the_stop_time_is_refused(name: str, fmi: Fmi) -> None:
    for h in (1e-4, 0.01):
        with fmi(name) as fmu:
            driver, count = Driver(fmu, held=True), round(0.01 / h)
            fmu.initialise(start=1.0, stop=1.01)
            driver.run([(1.0 + k * h, h) for k in range(count)])
            before = driver.result()
            for end in (h, 2.1e-3 * h):
                for _ in range(3):
                    assert fmu.step(1.0 + count * h, end) == ERROR
                    assert "expected an end not after stopTime = 1.01 s" in fmu.last_message
            assert driver.result() == before
            assert fmu.step(1.0 + count * h, 1e-13) == OK  # as an importer makes it by rounding


@each_kind
def test_steps_at_a_wrong_time_are_refused_and_change_nothing(name: str, fmi: Fmi) -> None:
    with fmi(name) as fmu, fmi(name) as other:
        driver, expected = Driver(fmu), Driver(other)
        for instance in (fmu, other):
            instance.initialise(start=1.0)
        for each in (driver, expected):
            each.run([(1.0, 1e-3), (1.001, 1e-3)])
        for t, h, named in [
            (1.001, 1e-3, "currentCommunicationPoint = 1.001 s; expected 1.002 s"),  # backwards
            (1.00201, 2.0, "currentCommunicationPoint = 1.00201 s; expected 1.002 s"),
            (math.nan, 1e-3, "currentCommunicationPoint"),
            (1.002, 0.0, "communicationStepSize = 0 s"),
            (1.002, math.nan, "communicationStepSize"),
            (1.002, math.inf, "communicationStepSize"),
        ]:
            assert fmu.step(t, h) == ERROR
            message = error_of(fmu)
            assert message.startswith(f"{fmu.prefix}DoStep: ") and named in message
            assert driver.result() == expected.result()
        assert driver.step(1.002, 1e-3) == expected.step(1.002, 1e-3)


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
        assert fmu.call("GetRealStatus", 2, None) == ERROR
        assert fmu.call("CancelStep") == ERROR
        assert "no step is in progress" in fmu.last_message
