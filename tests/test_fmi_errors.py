"""Bad parameters, bad measurements, calls out of order: an answer, and nothing lost."""

from __future__ import annotations

import ctypes
import math
from collections.abc import Callable
from pathlib import Path

import pytest

from fmi_instance import ERROR, OK, WARNING, Instance

OUT_OF_RANGE = [
    ({"samplePeriod": 0.0}, "samplePeriod = 0", "(0, inf)"),
    ({"samplePeriod": -1.0}, "samplePeriod = -1", "(0, inf)"),
    ({"samplePeriod": math.nan}, "samplePeriod = ", "(0, inf)"),
    ({"motor.gamma": 0.0}, "motor.gamma = 0", "not 0"),
    ({"motor.B": 0.0}, "motor.B = 0", "(0, inf)"),
    ({"motor.D_theta": -1e-3}, "motor.D_theta = -0.001", "[0, inf)"),
    ({"filter.V_min": 20.0}, "filter.V_min = 20", "<= filter.V_max"),
    ({"filter.V_a": -1.0}, "filter.V_a = -1", "[0, inf)"),
    ({"filter.P_0": 0.0}, "filter.P_0 = 0", "(0, inf)"),
    ({"filter.kind": 4}, "filter.kind = 4", "[1, 3]"),
    ({"modality": 0}, "modality = 0", "[1, 3]"),
    ({"rls.n": 0}, "rls.n = 0", "[1, 8]"),
    ({"rls.n": 9}, "rls.n = 9", "[1, 8]"),
    ({"rls.m": 6}, "rls.m = 6", "[1, 5]"),
    ({"rls.P_0": 0.0}, "rls.P_0 = 0", "(0, inf)"),
    ({"rls.c": -1e-20}, "rls.c = -1e-20", "(0, inf)"),
    ({"rls.a": 1.5}, "rls.a = 1.5", "(0, 1]"),
    ({"rls.eta_0[1,2]": math.inf}, "rls.eta_0[1,2] = inf", "(-inf, inf)"),
    ({"encoder.theta": -1.0}, "encoder.theta = -1", "[0, inf)"),
    ({"encoder.q": -1.0}, "encoder.q = -1", "[0, inf)"),
    ({"encoder.theta_c": -1.0}, "encoder.theta_c = -1", "[0, inf)"),
    ({"residual.K_I": 2000.0}, "residual.K_I = 2000", "2 / samplePeriod"),
    ({"residual.K_I": 400.0, "samplePeriod": 0.005}, "residual.K_I = 400", "2 / samplePeriod"),
]


@pytest.mark.parametrize(("values", "named", "allowed"), OUT_OF_RANGE)
def test_a_parameter_out_of_range_is_named_with_value_and_range(
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
        fmu.set_all(starts)  # still in initialisation mode: mend it
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
        assert len(warnings) == 2  # one for each episode
        assert name in warnings[0] and "skipped" in warnings[0]


def test_the_first_tick_waits_for_a_good_measurement(estimator_fmu: Path) -> None:
    """Starting late at a position away from 0 is starting there, not moving there."""
    with Instance(estimator_fmu) as late, Instance(estimator_fmu) as prompt:
        for fmu in (late, prompt):
            fmu.initialise()
        late.set_all({"theta": math.nan})
        assert late.step(0.0, 1e-3) == WARNING
        sample = {"theta": 2.0, "q": 2.001, "tau": 0.1}
        for fmu in (late, prompt):
            fmu.set_all(sample)
        for k in range(5):
            assert prompt.step(k * 1e-3, 1e-3) == OK
            assert late.step((k + 1) * 1e-3, 1e-3) == OK
        names = ["sigma", "theta_dot", "tau_e_residual"]
        assert late.get_all(names) == prompt.get_all(names)


CALLS: list[tuple[str, Callable[[Instance], int]]] = [
    ("fmi2DoStep", lambda fmu: fmu.step(0.0, 1e-3)),
    ("fmi2ExitInitializationMode", lambda fmu: fmu.exit()),
    ("fmi2Terminate", lambda fmu: fmu.call("fmi2Terminate")),
    ("fmi2GetReal", lambda fmu: fmu.status_and_value("sigma")[0]),
    ("fmi2CancelStep", lambda fmu: fmu.call("fmi2CancelStep")),
]


@pytest.mark.parametrize(("function", "call"), CALLS, ids=[name for name, _ in CALLS])
def test_a_call_before_initialisation_is_refused(
    function: str, call: Callable[[Instance], int], estimator_fmu: Path
) -> None:
    with Instance(estimator_fmu) as fmu:
        assert call(fmu) == ERROR
        assert function in fmu.messages[-1][2]
        fmu.initialise()
        assert fmu.step(0.0, 1e-3) == OK


def test_a_call_after_initialisation_is_refused(estimator_fmu: Path) -> None:
    with Instance(estimator_fmu) as fmu:
        fmu.initialise()
        for status in (fmu.setup(), fmu.enter(), fmu.exit()):
            assert status == ERROR
            assert "between steps" in fmu.messages[-1][2]
        assert fmu.set("rls.n", 2) == ERROR
        assert "rls.n" in fmu.messages[-1][2] and "fixed" in fmu.messages[-1][2]
        assert fmu.set("sigma", 1.0) == ERROR
        assert "output" in fmu.messages[-1][2]
        assert fmu.step(0.0, 1e-3) == OK
        assert fmu.call("fmi2Terminate") == OK
        assert fmu.step(1e-3, 1e-3) == ERROR
        assert fmu.get("sigma") == 0.0


def test_unknown_references_and_null_arguments(estimator_fmu: Path) -> None:
    with Instance(estimator_fmu) as fmu:
        fmu.initialise()
        one, value = ctypes.c_size_t(1), (ctypes.c_double * 1)(7.0)
        unknown = (ctypes.c_uint * 1)(100000)
        assert fmu.call("fmi2GetReal", unknown, one, value) == ERROR
        assert "100000" in fmu.messages[-1][2]
        assert fmu.call("fmi2SetReal", unknown, one, value) == ERROR
        integer = (ctypes.c_int * 1)()
        assert fmu.call("fmi2GetInteger", fmu.references(["sigma"]), one, integer) == ERROR
        assert "sigma" in fmu.messages[-1][2] and "Real" in fmu.messages[-1][2]
        assert fmu.call("fmi2GetReal", None, one, value) == ERROR
        assert "vr is NULL" in fmu.messages[-1][2]
        assert fmu.call("fmi2SetReal", fmu.references(["tau"]), one, None) == ERROR
        assert fmu.call("fmi2GetReal", None, ctypes.c_size_t(0), None) == OK
        assert fmu.call("fmi2GetString", unknown, one, (ctypes.c_char_p * 1)()) == ERROR
        assert fmu.call("fmi2GetFMUstate", None) == ERROR
        assert fmu.call("fmi2SetFMUstate", None) == ERROR
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
def test_odd_importers(
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
        assert fmu.step(5.0, 1e-3) == ERROR  # has something to say, maybe to nobody
        assert set(fmu.environments) <= {4711}


def test_log_categories_filter(estimator_fmu: Path) -> None:
    def choose(fmu: Instance, on: bool, *names: bytes) -> int:
        return fmu.call(
            "fmi2SetDebugLogging",
            int(on),
            ctypes.c_size_t(len(names)),
            (ctypes.c_char_p * len(names))(*names),
        )

    with Instance(estimator_fmu) as fmu:
        declared = {category.name for category in fmu.description.logCategories or []} or {
            "logEvents",
            "logStatusWarning",
            "logStatusError",
            "logAll",
        }
        for name in declared:
            assert choose(fmu, True, name.encode()) == OK
        assert choose(fmu, True, b"logStatusWarning") == OK
        fmu.initialise()
        assert fmu.step(1.0, 1e-3) == ERROR
        assert fmu.messages == []
        assert choose(fmu, True, b"logAll") == OK
        assert fmu.step(1.0, 1e-3) == ERROR
        assert fmu.messages[-1][1] == "logStatusError"
        assert choose(fmu, True, b"no such category") == ERROR
        assert "no such category" in fmu.messages[-1][2]
