"""sigmahat.Estimator gives the results of the FMU without the FMU, and clear error messages."""

import copy
import pickle
import struct
import sys
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

import sigmahat
from controllers import run
from fmi_instance import OK, Instance
from forged_states import signed
from plant_runs import run_plant
from recordings import one_seed
from sigmahat.fmi.instance import installed

Samples = dict[str, NDArray[Any]]
T, N = 1e-3, 3000
INPUTS = ("theta", "q", "tau", "theta_c")
SETTINGS: list[dict[str, Any]] = [
    {},
    {"deformation": "Filtered", "rls.kind": "ConstantFactor", "filter.kind": "Kalman"},
    {"method": "FilteredRegression"},
    {"method": "FilteredRegression", "rls.n": 3, "regression.drift": 1e-3},
    {"modality": "Sensor"},
    {"modality": "Model"},
    {"method": "FilteredRegression", "modality": "Sensor", "prior.hysteresis": 0.01},
    {"method": "FilteredRegression", "modality": "Model"},
]


@pytest.fixture(scope="module")
def z() -> Samples:
    """Measurements of the scenario table1, with a torque sensor, and a gap of ten samples."""
    plant = one_seed("table1").recording.plant
    measured = {name: plant[f"{name}_measured"][:N].copy() for name in INPUTS}
    measured["tau_e_sensor"] = plant["tau_e"][:N] + 0.01 * np.sin(np.arange(N))
    measured["q"][2000:2010] = np.nan
    return measured


def by_fmu(z: Samples, start: Mapping[str, Any]) -> Samples:
    variables = installed("StiffnessEstimator").variables
    every = [name for name, v in variables.items() if v.causality == "output"]
    inputs = np.column_stack(list(z.values()))
    inputs = np.concatenate([inputs, inputs[-1:]])
    rows = run_plant("StiffnessEstimator", list(z), T, inputs, start, every, held=True)
    # The row of a tick is the one after the step that begins with it.
    return {name: values[1:] for name, values in rows.items()}


@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize("start", SETTINGS, ids=str)
def test_run_gives_the_bits_of_the_fmu(start: dict[str, Any], z: Samples) -> None:
    expected = by_fmu(z, start)
    estimator = sigmahat.Estimator(start, record=list(expected))
    found = estimator.run(**z)
    assert not found["valid"][2000:2010].any() and found["valid"][:2000].all()
    for name, values in expected.items():
        np.testing.assert_array_equal(found[name], values, err_msg=name)
        assert estimator.output(name) == values[-1]
    n, m = estimator.parameters[0]["rls.n"], estimator.parameters[0]["rls.m"]
    assert estimator.eta.shape == (n, m)
    assert estimator.eta[1, 2] == expected["eta[1,2]"][-1]
    assert found.units["sigma_std"] == "N.m/rad"


@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize("start", SETTINGS, ids=str)
def test_a_saved_estimator_goes_on_with_the_bits_of_the_fmu(
    start: dict[str, Any], z: Samples
) -> None:
    expected = by_fmu(z, start)
    first, second = sigmahat.Estimator(start), sigmahat.Estimator(record=list(expected))
    first.run(**{name: each[:1500] for name, each in z.items()})
    second.restore(first.save())
    assert second.parameters == first.parameters and second.save() == first.save()
    found = second.run(**{name: each[1500:] for name, each in z.items()})
    for name, values in expected.items():
        np.testing.assert_array_equal(found[name], values[1500:], err_msg=name)


@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize(
    "start",
    [each for each in SETTINGS if each.get("method") == "FilteredRegression"],
    ids=str,
)
def test_evaluate_gives_the_bits_of_the_fmu_after_a_gap(start: dict[str, Any], z: Samples) -> None:
    """At the first sample after a gap, the outputs of the FMU are those at a constant deformation.
    With rows of one sample, no computation is left for later ticks."""
    start = {**start, "regression.decimation": 1, "rls.m": 1}
    phi = np.linspace(-0.05, 0.05, 7)
    nothing = np.zeros(2 * len(phi))
    at_rest = {name: nothing for name in z} | {"q": np.column_stack([phi * np.nan, phi]).ravel()}
    rows = by_fmu({name: np.concatenate([z[name], at_rest[name]]) for name in z}, start)
    estimator = sigmahat.Estimator(start)
    estimator.run(**z)
    for name, values in estimator.evaluate(phi).items():
        np.testing.assert_array_equal(values, rows[name][N + 1 :: 2], err_msg=name)


@pytest.mark.parametrize(("method", "missing"), [("Paper2011", 7), ("FilteredRegression", 1)])
def test_restarted_filters_are_those_after_missing_samples(
    method: str, missing: int, z: Samples
) -> None:
    """With K_I = 300/s, Paper2011 forgets its residual after 6.7 ms."""
    one, other = (sigmahat.Estimator({"method": method}) for _ in range(2))
    half = {name: each[:1500] for name, each in z.items()}
    one.run(**half)
    other.run(**half)
    one.restart_filters()
    other.run(*np.full((3, missing), np.nan))
    assert one.save() == other.save()


@pytest.mark.parametrize("start", SETTINGS[1:3], ids=str)
def test_ticks_are_those_of_run_also_in_turns(start: dict[str, Any], z: Samples) -> None:
    record = ("sigma", "confident", "doubt", "valid")
    whole = sigmahat.Estimator(start, record).run(**z)
    estimator = sigmahat.Estimator(start, record)
    head = estimator.run(**{name: each[:1000] for name, each in z.items()})
    ticks = [estimator.tick(**{name: each[k] for name, each in z.items()}) for k in range(1000, N)]
    for name in record:
        joined = np.concatenate([head[name], [each[name] for each in ticks]])
        np.testing.assert_array_equal(joined, whole[name], err_msg=name)
    assert type(ticks[0]["sigma"]) is float and type(ticks[0]["valid"]) is bool
    assert isinstance(ticks[0]["doubt"], str)


def test_many_joints_are_as_many_estimators(z: Samples) -> None:
    single = [sigmahat.Estimator(each) for each in SETTINGS]
    alone = [each.run(**z)["sigma"] for each in single]
    several = {name: np.tile(each, (len(SETTINGS), 1)) for name, each in z.items()}
    together = sigmahat.Estimator(SETTINGS)
    np.testing.assert_array_equal(together.run(**several)["sigma"], alone)
    assert together.output("sigma").tolist() == [each[-1] for each in alone]
    assert together.eta.shape == (len(SETTINGS), 6, 3)
    for name, values in together.evaluate([0.0, 0.01]).items():
        np.testing.assert_array_equal(values, [e.evaluate([0.0, 0.01])[name] for e in single])
    # GIVEN one set of parameters, THEN the samples define the number of joints.
    alike = sigmahat.Estimator(SETTINGS[0])
    np.testing.assert_array_equal(alike.run(**several)["sigma"], [alone[0]] * len(SETTINGS))
    tick = alike.tick(**{name: each[:, 0] for name, each in several.items()})
    assert tick["sigma"].shape == (len(SETTINGS),) and tick["valid"].dtype == bool


def test_reset_forgets_and_keeps_what_was_tuned(z: Samples) -> None:
    estimator = sigmahat.Estimator({})
    first = estimator.run(**z)["sigma"]
    estimator.reset()
    np.testing.assert_array_equal(estimator.run(**z)["sigma"], first)
    estimator.tune({"motor.D_theta": 2e-3})
    estimator.reset()
    tuned = sigmahat.Estimator({"motor.D_theta": 2e-3}).run(**z)["sigma"]
    np.testing.assert_array_equal(estimator.run(**z)["sigma"], tuned)


@pytest.mark.parametrize(
    ("parameters", "message"),
    [
        ({"motor.b": 1.0}, r"parameter of StiffnessEstimator.*motor\.b.*motor\.B"),
        ({"method": "Regression"}, "Regression.*FilteredRegression"),
        ({"motor.B": -1.0}, r"motor\.B: expected >= 1e-15, got -1"),
        ({"motor.B": float("nan")}, r"motor\.B: expected .*got nan"),
        ({"motor.B": True}, r"motor\.B: expected Real, got True"),
        ({"rls.n": 9}, r"rls\.n: expected .*8.* got 9"),
        ({"sigma": 1.0}, "sigma"),
        ([], "one joint or more"),
        ("Paper2011", "parameters of one joint or more, got 'Paper2011'"),
        ([None], r"parameters of one joint or more, got \[None\]"),
        ({"rls.n": float("inf")}, r"rls\.n: expected Integer, got inf"),
        ({"method": None}, "method: expected one of Paper2011, FilteredRegression, got None"),
    ],
)
def test_parameters_that_do_not_fit(parameters: Any, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        sigmahat.Estimator(parameters)


def test_what_is_misused_is_named_and_changes_nothing(z: Samples) -> None:
    with pytest.raises(ValueError, match="sigma_hat"):
        sigmahat.Estimator({}, record=["sigma_hat"])
    estimator = sigmahat.Estimator({})
    run, tick, tune = estimator.run, estimator.tick, estimator.tune
    theta, q, tau = z["theta"], z["q"], z["tau"]

    def refused(call: Callable[..., Any], *arguments: Any, message: str) -> None:
        with pytest.raises(ValueError, match=message):
            call(*arguments)

    refused(run, theta, q, message="modality Residual needs tau")
    refused(run, theta, q[1:], tau, message=r"theta \(3000,\), q \(2999,\)")
    refused(run, 0.0, 0.0, 0.0, message=r"equal shapes.*\(\)")
    expected = run(**z)["sigma"]
    refused(run, *np.zeros((3, 2, 5)), message=r"one joint\(s\), got 2")
    refused(tick, np.zeros(3), 0.0, 0.0, message=r"expected samples of one joint\(s\), got 3")
    refused(tick, 0.0, 0.0, message="modality Residual needs tau")
    refused(tick, np.zeros((2, 3)), 0.0, 0.0, message="expected numbers, or arrays of shape")
    refused(run, *np.zeros((3, 0, 5)), message="one joint or more, got none")
    refused(tune, {"motor.B": 1e-5, "rls.n": 3}, message=r"rls\.n cannot be changed")
    refused(tune, {"motor.B": 1e-5, "motor.gamma": 0.0}, message=r"motor\.gamma: expected .*got 0")
    estimator.reset()
    np.testing.assert_array_equal(run(**z)["sigma"], expected)


def test_masked_samples_are_skipped(z: Samples) -> None:
    mask = np.arange(N) % 7 == 0
    found = sigmahat.Estimator({}).run(**{**z, "q": np.ma.masked_array(z["q"] + 9.0 * mask, mask)})
    gaps = sigmahat.Estimator({}).run(**{**z, "q": np.where(mask, np.nan, z["q"])})
    np.testing.assert_array_equal(found["sigma"], gaps["sigma"])
    assert not found["valid"][mask].any()


def test_many_joints_are_saved_together(z: Samples) -> None:
    estimator = sigmahat.Estimator(SETTINGS[:3])
    several = {name: np.tile(each, (3, 1)) for name, each in z.items()}
    estimator.run(**several)
    other = sigmahat.Estimator([{}, {}, {}])
    other.restore(estimator.save())
    assert other.parameters == estimator.parameters
    np.testing.assert_array_equal(other.run(**several)["sigma"], estimator.run(**several)["sigma"])
    with pytest.raises(ValueError, match="of another number of joints"):
        sigmahat.Estimator().restore(estimator.save())


HEADER, CHECKSUM = 88, 80  # places in a saved state


def forged(state: bytes, place: int, value: float) -> bytes:
    """A state with another value at a place, and with the right checksum."""
    changed = bytearray(state)
    struct.pack_into("<d", changed, place, value)
    return signed(changed, CHECKSUM)


@pytest.mark.parametrize(
    ("changed", "message"),
    [
        (lambda state: state[: HEADER - 1], r"the state \(87 bytes\) is truncated"),
        (lambda state: b"sigmahat" + state[8:], "not the state of an Estimator"),
        (lambda state: state[:8] + b"\0" + state[9:], "another version of the format"),
        (lambda state: state[:20] + b"?" + state[21:], "another version of the estimator"),
        (lambda state: state[:12] + b"\2" + state[13:], "another number of joints"),
        (lambda state: state[:-1], "truncated or too long"),
        (lambda state: state + b"\0", "truncated or too long"),
        (lambda state: state[:5000] + bytes([state[5000] ^ 1]) + state[5001:], "its checksum"),
        (lambda state: forged(state, HEADER, -1.0), "values that an Estimator never saves"),
        (lambda state: forged(state, HEADER, np.nan), "values that an Estimator never saves"),
    ],
)
def test_bytes_that_are_no_state_are_refused_and_change_nothing(
    changed: Callable[[bytes], bytes], message: str, z: Samples
) -> None:
    estimator = sigmahat.Estimator({"method": "FilteredRegression"})
    estimator.run(**z)
    before, parameters = estimator.save(), estimator.parameters
    with pytest.raises(ValueError, match=message):
        estimator.restore(changed(before))
    assert estimator.save() == before and estimator.parameters == parameters


def test_a_forged_state_is_refused_or_can_go_on(z: Samples) -> None:
    """No value at any place of a state makes a tick crash or run for ever."""
    estimator = sigmahat.Estimator({"method": "FilteredRegression"})
    estimator.run(**z)
    state, refused = estimator.save(), 0
    for place in range(HEADER, len(state) - 8, len(state) // 60 // 8 * 8):
        try:
            estimator.restore(forged(state, place, -1e300))
        except ValueError:
            refused += 1
        else:
            estimator.run(*np.zeros((3, 20)))
    assert refused > 0


@pytest.mark.parametrize("copied", [copy.copy, copy.deepcopy])
def test_a_copy_goes_on_by_itself(copied: Any, z: Samples) -> None:
    estimator = sigmahat.Estimator({})
    estimator.run(**{name: each[:1000] for name, each in z.items()})
    other, later = copied(estimator), {name: each[1000:] for name, each in z.items()}
    first = other.run(**later)["sigma"]
    np.testing.assert_array_equal(estimator.run(**later)["sigma"], first)
    with pytest.raises(TypeError, match="cannot be pickled"):
        pickle.dumps(estimator)


def test_tuned_parameters_have_their_effect_while_it_runs(
    z: Samples,
) -> None:
    estimator = sigmahat.Estimator({"method": "FilteredRegression"})
    with Instance(sigmahat.fmu("StiffnessEstimator")).initialise({"method": 2}) as fmu:
        for k in range(1500):
            row = {name: float(each[k]) for name, each in z.items()}
            row["tau_e_sensor"] = 0.1 * row["q"]
            if k == 1000:
                estimator.tune({"noise.tau": 0.1, "modality": "Sensor"})
                fmu.set_all({"noise.tau": 0.1, "modality": 2})
            now = estimator.tick(**row)
            fmu.set_all(row)
            assert fmu.step(k * T, T) == OK
        assert [now[name] for name in ("sigma", "sigma_std")] == fmu.get_all(["sigma", "sigma_std"])
    assert estimator.parameters[0]["noise.tau"] == 0.1


def test_ctrl_c_ends_a_long_run() -> None:
    program = """
import os, signal, threading, numpy as np, sigmahat
zeros = np.zeros(50_000_000)
estimator = sigmahat.Estimator({"method": "FilteredRegression"})
threading.Timer(1.0, os.kill, (os.getpid(), signal.SIGINT)).start()
try:
    estimator.run(zeros, zeros, zeros)
except KeyboardInterrupt:
    print("interrupted")
"""
    assert run(sys.executable, "-c", program) == "interrupted\n"


def test_the_estimate_is_evaluated_at_any_deformation(z: Samples) -> None:
    """`evaluate` at the last point of operation returns the last outputs and changes no state. The
    standard deviations are also equal, as each regression row has one sample."""
    estimator = sigmahat.Estimator(
        {"method": "FilteredRegression", "rls.n": 3, "regression.decimation": 1}
    )
    estimator.run(**z)
    names = ("tau_e", "tau_e_std", "sigma", "sigma_std", "sigma_per_gain")
    last, memory = [estimator.output(name) for name in names], estimator._joints.memory.copy()
    found = estimator.evaluate(estimator.output("phi"), estimator.output("setPoint"))
    assert [found[name] for name in names] == pytest.approx(last, rel=1e-12)
    grid = estimator.evaluate(np.linspace(-0.05, 0.05, 5)[:, np.newaxis], [60.0, 80.0])
    assert all(grid[name].shape == (5, 2) for name in names)
    assert np.all(grid["sigma"][:, 1] > grid["sigma"][:, 0])  # a longer lever arm
    assert np.array_equal(memory, estimator._joints.memory)
    assert estimator.evaluate(np.nan)["sigma_std"] == np.inf


@pytest.mark.parametrize(("given", "warned"), [(0.004, True), (0.02, False), (0.3, True)])
def test_a_range_that_is_far_from_the_motion_is_warned_of_once(
    given: float, warned: bool, caplog: pytest.LogCaptureFixture
) -> None:
    t = 1e-3 * np.arange(2000)
    theta = 0.3 * np.sin(6 * t)
    q = theta + 0.01 * np.cos(7 * t)
    estimator = sigmahat.Estimator({"method": "FilteredRegression", "range.phi": given})
    for _ in range(2):
        estimator.run(theta, q, np.cos(t))
    words = [each.getMessage() for each in caplog.records]
    assert len(words) == warned
    assert all(f"is up to 0.01 rad, but range.phi is {given}" in each for each in words)
    # THEN a program that checks the range itself gets no warning.
    silent = sigmahat.Estimator(estimator.parameters[0], warn_of_range=False)
    silent.run(theta, q, np.cos(t))
    assert len(caplog.records) == len(words)


def test_an_unknown_name_of_the_package_is_an_attribute_error() -> None:
    with pytest.raises(AttributeError, match="no attribute 'Estimates'"):
        sigmahat.Estimates  # type: ignore[attr-defined]  # noqa: B018
