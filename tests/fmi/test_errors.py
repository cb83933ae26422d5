"""Bad parameters, bad measurements, calls out of order: each gives an error and changes nothing."""

from __future__ import annotations

import ctypes
import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import fmpy.fmi2 as fmi2
import pytest

import sigmahat
from fmi_instance import DISCARD, ERROR, OK, WARNING, Instance
from fmi_runs import ESTIMATORS, PLANTS, Driver, names

every_fmu = pytest.mark.parametrize("name", ESTIMATORS + PLANTS)

OUT_OF_RANGE = [  # test_limits.py has all limits
    ("samplePeriod", math.nan, "[1e-09, inf)"),
    ("filter.kind", 4, "[1, 3]"),
    ("rls.n", 9, "[1, 8]"),
    ("rls.a", 1.5, "[1e-15, 1]"),
    ("rls.eta_0[1,2]", math.inf, "(-inf, inf)"),
]
CONTRADICTORY = [
    ({"motor.gamma": 0.0}, "motor.gamma = 0", "not 0"),
    ({"filter.V_min": 20.0}, "filter.V_min = 20", "<= filter.V_max"),
    ({"residual.K_I": 2000.0}, "residual.K_I = 2000", "2 / samplePeriod"),
    ({"residual.K_I": 400.0, "samplePeriod": 0.005}, "residual.K_I = 400", "2 / samplePeriod"),
]


@pytest.mark.parametrize(("name", "bad", "allowed"), OUT_OF_RANGE)
def test_a_parameter_out_of_range_is_refused_where_it_is_set(
    name: str, bad: float, allowed: str, estimator_fmu: Path
) -> None:
    with Instance(estimator_fmu, logging_on=False) as fmu:
        assert fmu.setup() == OK
        assert fmu.set(name, bad) == ERROR
        status, category, message = fmu.messages[-1]
        assert (status, category) == (ERROR, "logStatusError")
        assert f"{name} = " in message and allowed in message
        assert math.isnan(bad) or f"{bad:g}" in message
        assert fmu.enter() == OK  # it still has its start value
        assert fmu.get(name) == float(fmu.variables[name].start)
        assert fmu.set(name, bad) == ERROR
        assert fmu.exit() == OK
        assert fmu.step(0.0, 1e-3) == OK


@pytest.mark.parametrize(("values", "named", "allowed"), CONTRADICTORY)
def test_parameters_that_contradict_each_other_are_named_at_the_end_of_the_initialisation(
    values: dict[str, float], named: str, allowed: str, estimator_fmu: Path
) -> None:
    with Instance(estimator_fmu, logging_on=False) as fmu:
        assert fmu.setup() == OK
        starts = {name: float(fmu.variables[name].start) for name in values}
        fmu.set_all(values)
        assert fmu.enter() == OK
        assert fmu.exit() == ERROR
        status, category, message = fmu.messages[-1]
        assert (status, category) == (ERROR, "logStatusError")
        assert named in message and allowed in message
        assert fmu.step(0.0, 1e-3) == ERROR  # not initialised
        fmu.set_all(starts)  # the instance is still in initialisation mode
        assert fmu.exit() == OK
        assert fmu.step(0.0, 1e-3) == OK


@pytest.mark.parametrize("name", ["theta", "q", "theta_c", "tau", "tau_e_sensor"])
@pytest.mark.parametrize("bad", [math.nan, math.inf, -math.inf, 1e300])
def test_a_bad_measurement_skips_the_tick_and_warns_once(
    name: str, bad: float, estimator_fmu: Path
) -> None:
    watched = ["sigma", "tau_e", "tau_e_residual", "theta_dot", "phi", "rho", "eta[0,0]"]
    with Instance(estimator_fmu) as fmu:
        fmu.initialise({"modality": 2, "rls.P_0": 1.0, "rls.kind": 2})
        k = 0

        def step(expected: int) -> None:
            nonlocal k
            assert fmu.step(k * 1e-3, 1e-3) == expected
            k += 1

        fmu.set_all({"theta": 0.1, "q": 0.11, "theta_c": 5.0, "tau": 0.2, "tau_e_sensor": 1.0})
        for _ in range(5):
            step(OK)
        before, good = fmu.get_all(watched), fmu.variables[name]
        assert before[0] != 0.0 and good.causality == "input"
        values = {"theta": 0.1, "q": 0.11, "theta_c": 5.0, "tau": 0.2, "tau_e_sensor": 1.0}
        fmu.set_all({name: bad})
        for _ in range(3):
            step(WARNING)
            assert fmu.get("valid") == 0
            assert fmu.get_all(watched) == before
        fmu.set_all(values)
        step(OK)
        assert fmu.get("valid") == 1
        assert all(math.isfinite(value) for value in fmu.get_all(watched))
        fmu.set_all({name: bad})
        step(WARNING)
        warnings = [message for status, _, message in fmu.messages if status == WARNING]
        assert len(warnings) == 2  # one for each sequence of bad measurements
        assert name in warnings[0] and "skipped" in warnings[0]


@pytest.mark.parametrize("method", [1, 2])
def test_a_deformation_far_beyond_its_range_is_reported_once(
    method: int, estimator_fmu: Path
) -> None:
    with Instance(estimator_fmu) as fmu:
        for _ in range(2):  # after a reset it is reported again
            fmu.messages.clear()
            fmu.initialise({"method": method, "range.phi": 0.1})
            statuses = []
            for k, phi in enumerate((0.0, 0.2, -0.21, 0.3, 0.0, 0.3)):
                fmu.set_all({"q": phi})
                statuses.append(fmu.step(k * 1e-3, 1e-3))
            expected = [OK, OK, WARNING, OK, OK, OK] if method == 2 else [OK] * 6
            assert statuses == expected
            warnings = [message for status, _, message in fmu.messages if status == WARNING]
            assert len(warnings) == expected.count(WARNING)
            assert all("range.phi = 0.1" in text and "-0.21" in text for text in warnings)
            assert fmu.call("fmi2Reset") == OK


INSTANTIATED, INITIALISATION, STEP, TERMINATED = "instantiated", "initialisation", "step", "end"
EVERYWHERE = {INSTANTIATED, INITIALISATION, STEP, TERMINATED}
SETTABLE, READABLE = EVERYWHERE - {TERMINATED}, EVERYWHERE - {INSTANTIATED}
STEPPED = {STEP, TERMINATED}
ONE, ORDER = ctypes.c_size_t(1), (ctypes.c_int * 1)(1)


def variables_call(function: str, name: str, c_type: Any, *between: Any) -> Callable[..., int]:
    """A call for one variable: value reference, number 1, arguments `between`, array of values."""
    return lambda fmu: fmu.call(function, fmu.references([name]), ONE, *between, (c_type * 1)())


def status_call(function: str, kind: int, c_type: Any) -> Callable[[Instance], int]:
    return lambda fmu: fmu.call(function, kind, ctypes.byref(c_type()))


def with_state(function: str, *others: Any) -> Callable[[Instance], int]:
    """A call with a saved state, which is freed afterwards."""

    def call(fmu: Instance) -> int:
        state = fmu.save()
        status = fmu.call(function, state, *others)
        fmu.free(state)
        return status

    return call


def save_and_free(fmu: Instance) -> int:
    state = ctypes.c_void_p()
    status = fmu.call("fmi2GetFMUstate", ctypes.byref(state))
    fmu.free(state)
    return status


# FMI 2.0, table in section 4.2.4: the states in which each function is allowed, for a slave without
# asynchronous steps. A call that is allowed may still be refused, but for another reason.
CALLS: dict[str, tuple[set[str], Callable[[Instance], int]]] = {
    "fmi2SetDebugLogging": (EVERYWHERE, lambda fmu: fmu.call("fmi2SetDebugLogging", 1, 0, None)),
    "fmi2SetupExperiment": ({INSTANTIATED}, lambda fmu: fmu.setup()),
    "fmi2EnterInitializationMode": ({INSTANTIATED}, lambda fmu: fmu.enter()),
    "fmi2ExitInitializationMode": ({INITIALISATION}, lambda fmu: fmu.exit()),
    "fmi2Terminate": ({STEP}, lambda fmu: fmu.call("fmi2Terminate")),
    "fmi2Reset": (EVERYWHERE, lambda fmu: fmu.call("fmi2Reset")),
    "fmi2GetReal": (READABLE, variables_call("fmi2GetReal", "sigma", ctypes.c_double)),
    "fmi2GetInteger": (READABLE, variables_call("fmi2GetInteger", "rls.n", ctypes.c_int)),
    "fmi2GetBoolean": (READABLE, variables_call("fmi2GetBoolean", "valid", ctypes.c_int)),
    "fmi2GetString": (READABLE, variables_call("fmi2GetString", "sigma", ctypes.c_char_p)),
    "fmi2SetReal": (SETTABLE, variables_call("fmi2SetReal", "tau", ctypes.c_double)),
    "fmi2SetInteger": (SETTABLE, variables_call("fmi2SetInteger", "modality", ctypes.c_int)),
    "fmi2SetBoolean": (SETTABLE, variables_call("fmi2SetBoolean", "rls.symmetric", ctypes.c_int)),
    "fmi2SetString": (SETTABLE, variables_call("fmi2SetString", "tau", ctypes.c_char_p)),
    "fmi2GetFMUstate": (EVERYWHERE, save_and_free),
    "fmi2SetFMUstate": (EVERYWHERE, with_state("fmi2SetFMUstate")),
    "fmi2FreeFMUstate": (EVERYWHERE, lambda fmu: fmu.call("fmi2FreeFMUstate", None)),
    "fmi2SerializedFMUstateSize": (
        EVERYWHERE,
        with_state("fmi2SerializedFMUstateSize", ctypes.byref(ctypes.c_size_t())),
    ),
    "fmi2SerializeFMUstate": (
        EVERYWHERE,
        with_state("fmi2SerializeFMUstate", ctypes.create_string_buffer(1), ctypes.c_size_t(1)),
    ),
    "fmi2DeSerializeFMUstate": (EVERYWHERE, lambda fmu: fmu.deserialise(b"x")[0]),
    "fmi2GetDirectionalDerivative": (
        READABLE,
        lambda fmu: fmu.call("fmi2GetDirectionalDerivative", *[None, ONE] * 2, None, None),
    ),
    "fmi2SetRealInputDerivatives": (SETTABLE, lambda fmu: fmu.set_derivative("tau", 1.0)),
    "fmi2GetRealOutputDerivatives": (
        STEPPED,
        variables_call("fmi2GetRealOutputDerivatives", "sigma", ctypes.c_double, ORDER),
    ),
    "fmi2DoStep": ({STEP}, lambda fmu: fmu.step(0.0, 1e-3)),
    "fmi2GetStatus": (STEPPED, status_call("fmi2GetStatus", 0, ctypes.c_int)),
    "fmi2GetRealStatus": (STEPPED, status_call("fmi2GetRealStatus", 2, ctypes.c_double)),
    "fmi2GetIntegerStatus": (STEPPED, status_call("fmi2GetIntegerStatus", 1, ctypes.c_int)),
    "fmi2GetBooleanStatus": (STEPPED, status_call("fmi2GetBooleanStatus", 3, ctypes.c_int)),
    "fmi2GetStringStatus": (STEPPED, status_call("fmi2GetStringStatus", 1, ctypes.c_char_p)),
}


@pytest.mark.parametrize("state", sorted(EVERYWHERE))
@pytest.mark.parametrize("function", CALLS)
def test_a_function_is_refused_where_the_standard_does_not_allow_it(
    function: str, state: str, estimator_fmu: Path
) -> None:
    allowed, call = CALLS[function]
    with Instance(estimator_fmu) as fmu:
        if state != INSTANTIATED:
            assert fmu.setup() == OK and fmu.enter() == OK
        if state in STEPPED:
            assert fmu.exit() == OK
        if state == TERMINATED:
            assert fmu.call("fmi2Terminate") == OK
        fmu.messages.clear()
        status = call(fmu)
        refused = [text for _, _, text in fmu.messages if f"{function}: not allowed" in text]
        assert bool(refused) == (state not in allowed)
        if state not in allowed:
            assert status == ERROR
        assert fmu.call("fmi2Reset") == OK
        fmu.initialise()
        assert fmu.step(0.0, 1e-3) == OK


def test_a_step_cannot_be_cancelled(estimator_fmu: Path) -> None:
    with Instance(estimator_fmu) as fmu:
        fmu.initialise()
        assert fmu.call("fmi2CancelStep") == ERROR
        assert "no step is in progress" in fmu.messages[-1][2]
        assert fmu.step(0.0, 1e-3) == OK


def test_unknown_references_and_null_arguments_are_refused(estimator_fmu: Path) -> None:
    with Instance(estimator_fmu) as fmu:
        fmu.initialise()
        one, value = ctypes.c_size_t(1), (ctypes.c_double * 1)(7.0)
        unknown = (ctypes.c_uint * 1)(100000)
        assert fmu.call("fmi2GetReal", unknown, one, value) == ERROR
        assert "100000" in fmu.messages[-1][2]
        assert fmu.call("fmi2SetReal", unknown, one, value) == ERROR
        assert fmu.call("fmi2GetReal", None, one, value) == ERROR
        assert "valueReferences is NULL" in fmu.messages[-1][2]
        assert fmu.call("fmi2SetReal", fmu.references(["tau"]), one, None) == ERROR
        assert fmu.call("fmi2GetReal", None, ctypes.c_size_t(0), None) == OK
        assert fmu.call("fmi2GetString", unknown, one, (ctypes.c_char_p * 1)()) == ERROR
        assert fmu.set_derivative("tau", 1.0, order=2) == ERROR
        assert fmu.set_derivative("motor.B", 1.0) == ERROR
        assert fmu.call("fmi2GetRealOutputDerivatives", unknown, one, None, value) == ERROR
        assert fmu.step(0.0, 1e-3) == OK
    with Instance(estimator_fmu) as fmu:
        for function in ("fmi2Terminate", "fmi2Reset", "fmi2EnterInitializationMode"):
            assert getattr(fmu.dll, function)(None) == ERROR
        fmu.dll.fmi2FreeInstance(None)


def test_a_set_with_one_bad_reference_changes_nothing(estimator_fmu: Path) -> None:
    with Instance(estimator_fmu) as fmu:
        fmu.initialise()
        references = (ctypes.c_uint * 2)(fmu.reference("tau"), 100000)
        values = (ctypes.c_double * 2)(7.0, 7.0)
        assert fmu.call("fmi2SetReal", references, ctypes.c_size_t(2), values) == ERROR
        assert fmu.get("tau") == 0.0


def test_a_wrong_guid_is_refused_with_both_values(estimator_fmu: Path) -> None:
    with Instance(estimator_fmu, guid="{not-this-one}") as fmu:
        assert not fmu.component
        status, _, message = fmu.messages[-1]
        assert status == ERROR
        assert "{not-this-one}" in message and fmu.description.guid in message


def test_a_percent_sign_in_a_message_is_escaped(estimator_fmu: Path) -> None:
    with Instance(estimator_fmu, guid="{100%s}") as fmu:
        assert "{100%%s}" in fmu.messages[-1][2]


@pytest.mark.parametrize(
    "resources",
    [
        None,
        "",
        "/tmp/x/resources",
        "file:/tmp/x/resources",
        "file:///tmp/x/resources/",
        "file:////x",
    ],
)
@pytest.mark.parametrize("logger", [True, False])
@pytest.mark.parametrize("memory", [True, False])
def test_importers_with_unusual_arguments_can_run_it(
    resources: str | None, logger: bool, memory: bool, estimator_fmu: Path
) -> None:
    with Instance(estimator_fmu, resources=resources, logger=logger, memory=memory) as fmu:
        assert fmu.component
        assert fmu.set("rls.n", 3) == OK  # before ...
        assert fmu.setup() == OK
        assert fmu.enter() == OK
        assert fmu.set("rls.m", 2) == OK  # ... and in initialisation mode
        assert fmu.exit() == OK
        assert fmu.step(0.0, 1e-3) == OK
        assert fmu.step(5.0, 1e-3) == ERROR  # with a message, even if there is no logger
        assert set(fmu.environments) <= {4711}


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
    on: bool, chosen: list[str], passed: set[str], estimator_fmu: Path
) -> None:
    with Instance(estimator_fmu, logging_on=not on) as fmu:
        categories = (ctypes.c_char_p * len(chosen))(*map(str.encode, chosen))
        count = ctypes.c_size_t(len(chosen))
        assert fmu.call("fmi2SetDebugLogging", int(on), count, categories) == OK
        fmu.initialise()  # logs an event
        fmu.set_all({"theta": math.nan})
        assert fmu.step(0.0, 1e-3) == WARNING
        fmu.call("fmi2GetStatus", 0, ctypes.byref(ctypes.c_int()))  # returns fmi2Discard
        assert fmu.step(5.0, 1e-3) == ERROR
        assert {category for _, category, _ in fmu.messages} == passed


def test_the_warning_says_if_the_regression_overflows(estimator_fmu: Path) -> None:
    with Instance(estimator_fmu) as fmu:
        fmu.initialise()
        fmu.set_all({"q": 1e12, "theta": -1e12})
        assert fmu.step(0.0, 1e-3) == WARNING
        assert "regression overflows at theta = -1e+12" in fmu.messages[-1][2]


def test_a_combination_of_parameters_that_overflows_is_refused(estimator_fmu: Path) -> None:
    with Instance(estimator_fmu) as fmu:
        assert fmu.setup() == OK
        fmu.set_all({"setPoint.offset": 1e308, "rls.eta_0[0,2]": 1.0})
        assert fmu.enter() == OK
        assert fmu.exit() == ERROR
        assert "output sigma" in fmu.messages[-1][2] and "not finite" in fmu.messages[-1][2]
        fmu.set_all({"setPoint.offset": 100.0})
        assert fmu.exit() == OK


@pytest.mark.parametrize(
    ("name", "shown"),
    [("\udcff\udcfe", "??"), ("Gel\udce4nk", "Gel?nk"), ("\udced\udca0\udc80", "???")],
)
def test_an_instance_name_that_is_not_utf8_is_shown_without_those_bytes(
    name: str, shown: str, estimator_fmu: Path
) -> None:
    with Instance(estimator_fmu, name=name, logging_on=False) as fmu:
        assert fmu.component
        assert [status for status, _, _ in fmu.messages] == [WARNING]
        assert "not UTF-8" in fmu.messages[0][2] and shown in fmu.messages[0][2]
        fmu.initialise()
        assert fmu.step(0.0, 1e-3) == OK
        assert fmu.step(5.0, 1e-3) == ERROR
        assert fmu.names == {shown}


@pytest.mark.parametrize("name", ["Gelenk \u00fc \u03c3\u0302 \u20ac \U0001f9be", "", "100 %s"])
def test_any_other_instance_name_is_shown_as_it_is(name: str, estimator_fmu: Path) -> None:
    with Instance(estimator_fmu, name=name) as fmu:
        assert fmu.messages == []
        assert fmu.step(0.0, 1e-3) == ERROR
        assert fmu.names == {name}


def test_messages_about_texts_that_are_not_utf8_are_utf8(
    estimator_fmu: Path,
) -> None:
    with Instance(estimator_fmu, guid="{\udcff}") as fmu:
        assert not fmu.component
        assert "{?}" in fmu.messages[-1][2]
    with Instance(estimator_fmu) as fmu:
        category = (ctypes.c_char_p * 1)(b"log\xc3(")
        assert fmu.call("fmi2SetDebugLogging", 1, ONE, category) == WARNING
        assert "unknown category log?(" in fmu.messages[-1][2]
        fmu.initialise()
        assert fmu.step(0.0, 1e-3) == OK


@pytest.mark.parametrize("length", range(300, 304))
def test_a_long_message_is_not_cut_inside_a_character(length: int, estimator_fmu: Path) -> None:
    with Instance(estimator_fmu, guid="x" * (length - 300) + "\u20ac" * length) as fmu:
        assert "\u20ac" * 50 in fmu.messages[-1][2]


@pytest.mark.parametrize(
    ("start", "stop", "expected"),
    [
        (math.nan, None, "startTime"),
        (math.inf, None, "startTime"),
        (0.0, -1.0, "stopTime = -1 is before startTime = 0"),
        (0.0, math.nan, "stopTime"),
    ],
)
def test_an_experiment_with_impossible_times_is_refused(
    start: float, stop: float | None, expected: str, estimator_fmu: Path
) -> None:
    with Instance(estimator_fmu) as fmu:
        status = fmu.call(
            "fmi2SetupExperiment",
            *(0, ctypes.c_double(0.0), ctypes.c_double(start)),
            *(int(stop is not None), ctypes.c_double(stop or 0.0)),
        )
        assert status == ERROR
        assert expected in fmu.messages[-1][2]
        fmu.initialise()
        assert fmu.step(0.0, 1e-3) == OK


@pytest.mark.parametrize("bad", [-1e-6, math.nan, math.inf])
def test_a_tolerance_that_is_no_tolerance_is_refused(bad: float, estimator_fmu: Path) -> None:
    def setup(fmu: Instance, defined: int) -> int:
        times = (ctypes.c_double(0.0), 0, ctypes.c_double(0.0))
        return fmu.call("fmi2SetupExperiment", defined, ctypes.c_double(bad), *times)

    with Instance(estimator_fmu) as fmu:
        assert setup(fmu, 1) == ERROR
        assert "fmi2SetupExperiment: tolerance = " in fmu.messages[-1][2]
        assert setup(fmu, 0) == OK  # it is not defined


@every_fmu
@pytest.mark.parametrize("h", [1e-4, 1e-3, 0.01])
def test_a_step_after_the_stop_time_is_refused(name: str, h: float) -> None:
    with Instance(sigmahat.fmu(name)) as fmu:
        driver = Driver(fmu)
        assert fmu.setup(start=1.0, stop=1.01) == OK
        assert fmu.enter() == OK and fmu.exit() == OK
        count = round(0.01 / h)
        driver.run([(1.0 + k * h, h) for k in range(count)])
        before = driver.result()
        for end in (h, 2.1e-3 * h):
            for _ in range(3):
                assert fmu.step(1.0 + count * h, end) == ERROR
                assert "expected an end not after stopTime = 1.01 s" in fmu.messages[-1][2]
        assert driver.result() == before
        assert fmu.step(1.0 + count * h, 1e-13) == OK  # as an importer makes it by rounding


@every_fmu
def test_without_a_stop_time_there_is_no_end(name: str) -> None:
    with Instance(sigmahat.fmu(name)) as fmu:
        assert fmu.setup() == OK  # the value of stopTime, 0, is not defined
        assert fmu.enter() == OK and fmu.exit() == OK
        Driver(fmu).run([(k * 1e-3, 1e-3) for k in range(12)])


@every_fmu
def test_steps_at_a_wrong_time_are_refused_and_change_nothing(name: str) -> None:
    with Instance(sigmahat.fmu(name)) as fmu, Instance(sigmahat.fmu(name)) as other:
        driver, expected = Driver(fmu), Driver(other)
        for instance in (fmu, other):
            instance.initialise(start=1.0)
        driver.run([(1.0, 1e-3), (1.001, 1e-3)])
        expected.run([(1.0, 1e-3), (1.001, 1e-3)])
        for t, h, named in [
            (1.001, 1e-3, "currentCommunicationPoint = 1.001 s; expected 1.002 s"),  # backwards
            (0.0, 1e-3, "currentCommunicationPoint = 0 s; expected 1.002 s"),
            (1.003, 1e-3, "currentCommunicationPoint = 1.003 s; expected 1.002 s"),  # a gap
            (1.00201, 1e-3, "currentCommunicationPoint = 1.00201 s; expected 1.002 s"),
            (1.001, 2.0, "currentCommunicationPoint = 1.001 s; expected 1.002 s"),
            (1.00201, 2.0, "currentCommunicationPoint = 1.00201 s; expected 1.002 s"),
            (math.nan, 1e-3, "currentCommunicationPoint"),
            (math.inf, 1e-3, "currentCommunicationPoint"),
            (1.002, 0.0, "communicationStepSize = 0 s"),
            (1.002, -1e-3, "communicationStepSize = -0.001 s"),
            (1.002, math.nan, "communicationStepSize"),
            (1.002, math.inf, "communicationStepSize"),
        ]:
            assert fmu.step(t, h) == ERROR
            status, category, message = fmu.messages[-1]
            assert (status, category) == (ERROR, "logStatusError")
            assert message.startswith("fmi2DoStep: ") and named in message
            assert driver.result() == expected.result()
        assert driver.step(1.002, 1e-3) == expected.step(1.002, 1e-3)


@every_fmu
def test_invalid_references_and_values_are_refused(name: str) -> None:
    with Instance(sigmahat.fmu(name)) as fmu:
        driver = Driver(fmu)
        fmu.initialise()
        driver.step(0.0, 1e-3)
        before = driver.result()
        unknown = (ctypes.c_uint * 1)(len(fmu.variables))
        for kind, c_type in (
            ("Real", ctypes.c_double),
            ("Integer", ctypes.c_int),
            ("Boolean", ctypes.c_int),
        ):
            for what in ("Get", "Set"):
                assert fmu.call(f"fmi2{what}{kind}", unknown, ONE, (c_type * 1)()) == ERROR
                message = fmu.messages[-1][2]
                assert f"unknown value reference {len(fmu.variables)}" in message
        for fixed in names(fmu, "parameter", "fixed"):
            assert fmu.set(fixed, 1) == ERROR
            assert f"{fixed} cannot be set now" in fmu.messages[-1][2]
            assert "fixed" in fmu.messages[-1][2]
        for output in names(fmu, "output"):
            assert fmu.set(output, 1) == ERROR
            assert f"{output} cannot be set now" in fmu.messages[-1][2]
        for tunable in names(fmu, "parameter", "tunable"):
            if fmu.variables[tunable].type != "Real":
                continue
            good = fmu.get(tunable)
            for bad in (math.nan, math.inf):
                assert fmu.set(tunable, bad) == ERROR
                assert f"{tunable} = " in fmu.messages[-1][2]
                assert "range" in fmu.messages[-1][2]
            assert fmu.get(tunable) == good
        assert driver.result() == before
        driver.step(1e-3, 1e-3)


def test_a_bad_input_derivative_skips_the_ticks_that_use_it(estimator_fmu: Path) -> None:
    with Instance(estimator_fmu) as fmu:
        fmu.initialise()
        assert fmu.set_derivative("theta", math.nan) == OK
        assert fmu.step(0.0, 2e-3) == WARNING
        message = fmu.messages[-1][2].replace("-nan", "nan")
        assert "expected theta finite" in message and "received nan" in message
        assert fmu.step(2e-3, 1e-3) == OK
        assert fmu.get("valid") == 1


def test_the_status_gives_the_time_that_was_reached(estimator_fmu: Path) -> None:
    time, number, text = ctypes.c_double(-1.0), ctypes.c_int(7), ctypes.c_char_p(b"unchanged")

    def reached(fmu: Instance) -> float:
        assert fmu.call("fmi2GetRealStatus", 2, ctypes.byref(time)) == OK
        return time.value

    with Instance(estimator_fmu) as fmu:
        fmu.initialise(start=0.5)
        assert reached(fmu) == 0.5
        assert fmu.step(0.5, 1e-3) == OK
        assert reached(fmu) == 0.5 + 1e-3
        assert fmu.step(0.7, 1e-3) == ERROR
        assert reached(fmu) == 0.5 + 1e-3
        state = fmu.save()
        assert fmu.step(0.501, 0.25) == OK
        assert reached(fmu) == 0.501 + 0.25
        assert fmu.restore(state) == OK
        assert reached(fmu) == 0.5 + 1e-3
        fmu.free(state)
        assert fmu.call("fmi2GetBooleanStatus", 3, ctypes.byref(number)) == OK
        assert number.value == 0  # it does not request the end of the simulation
        others: list[tuple[str, int, Any]] = [
            ("fmi2GetStatus", 0, number),
            ("fmi2GetRealStatus", 0, time),
            ("fmi2GetIntegerStatus", 0, number),
            ("fmi2GetBooleanStatus", 0, number),
            ("fmi2GetStringStatus", 1, text),
        ]
        for function, kind, value in others:
            assert fmu.call(function, kind, ctypes.byref(value)) == DISCARD
            assert function in fmu.messages[-1][2]
        assert fmu.call("fmi2GetRealStatus", 2, None) == ERROR
        assert fmu.call("fmi2Terminate") == OK
        assert reached(fmu) == 0.5 + 1e-3


@every_fmu
def test_an_instantiation_that_fails_returns_null(name: str) -> None:
    with Instance(sigmahat.fmu(name)) as fmu:
        instantiate, guid = fmu.dll.fmi2Instantiate, fmu.description.guid.encode()
        callbacks = ctypes.byref(fmu.callbacks)
        fmu.messages.clear()
        for arguments, said in [
            ((b"test", 0, guid, None, callbacks), "not for model exchange"),
            ((None, 1, guid, None, callbacks), "instanceName is NULL"),
            ((b"test", 1, None, None, callbacks), "the importer gave NULL"),
            ((b"test", 1, b"{wrong}", None, callbacks), "{wrong}"),
        ]:
            assert instantiate(*arguments, 0, 0) is None
            status, category, message = fmu.messages[-1]
            assert (status, category) == (ERROR, "logStatusError")
            assert message.startswith("fmi2Instantiate: ") and said in message
        assert fmu.description.guid in fmu.messages[-1][2]
        assert instantiate(b"test", 1, guid, None, None, 0, 0) is None


@pytest.mark.parametrize("after", range(3))
def test_lack_of_memory_gives_no_instance_and_no_leak(after: int, estimator_fmu: Path) -> None:
    """The importer has no more memory after `after` blocks."""
    with Instance(estimator_fmu, memory=True) as fmu:
        before = set(fmu.blocks)
        assert len(before) == 3

        def allocate(count: int, size: int) -> int | None:
            return None if len(fmu.blocks) == 3 + after else fmu.allocate(count, size)

        fmu.callbacks.allocateMemory = fmi2.fmi2CallbackAllocateMemoryTYPE(allocate)
        guid = fmu.description.guid.encode()
        assert (
            fmu.dll.fmi2Instantiate(b"x", 1, guid, None, ctypes.byref(fmu.callbacks), 0, 0) is None
        )
        assert "out of memory" in fmu.messages[-1][2]
        assert fmu.blocks == before
