"""FilteredRegression, every output of every tick, against a second implementation.

That one, in helpers/dense_*.py, has dense matrices in extended precision and the filters of scipy.
Decisions compare a number with a threshold. In these runs the numbers are far from it, so that
rounding errors decide nothing.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from c_library import Array, Estimator, Library
from c_regression import PLAIN
from dense_regression import START, Oracle
from oracle import RESIDUAL, SENSOR
from reference_joints import table1_recording
from regression_joint import GAMMA, Joint

SHORT = Joint(duration=1.5, tau_coulomb=0.02)
JOINT = Joint(duration=3.0, tau_coulomb=0.02)
WIDE = Joint(duration=4.0, tau_coulomb=0.02, deformation=0.05)
FAST = Joint(duration=3.0, frequency=8.0, amplitude=0.05, tau_coulomb=0.02)
CREEPS = Joint(duration=4.0, frequency=0.2, amplitude=0.5, tau_coulomb=0.02)
ONE = {"rls.n": 1, "rls.m": 1}
POWERS, SET_POWER, GAP, HYSTERESIS, MOTOR_ENCODER, KNEE = range(1, 7)


def compare(found: NDArray[np.void], expected: Mapping[str, Array]) -> None:
    """Every output, to 1e-7 of its largest value; each coefficient of eta by itself."""
    for name, want in expected.items():
        largest = np.max(np.abs(want), axis=0)
        error = np.max(np.abs(found[name] - want), axis=0)
        assert np.all(error <= 1e-7 * largest), (name, np.max(error / np.maximum(largest, 1e-300)))


def check(
    c: Library, p: Mapping[str, float], z: Array, modality: Array | None = None
) -> tuple[Oracle, NDArray[np.void]]:
    """Compares a run, in which the modality may change."""
    modalities = np.full(len(z), p["modality"]) if modality is None else modality
    oracle = Oracle(c, p, z, None, modalities)
    estimator = Estimator(c, p)
    changes = [*(np.flatnonzero(np.diff(modalities)) + 1), len(z)]
    parts, first = [], 0
    for last in changes:
        c.set(estimator.parameters, "modality", int(modalities[first]))
        parts.append(estimator.run(z[first:last]))
        first = last
    found = np.concatenate(parts)
    good = np.all(np.isfinite(z), axis=1)
    assert np.array_equal(found["valid"] == 1, good)
    compare(found[good], oracle.run())
    regression = estimator.state.method.regression
    assert list(regression.refit.used)[1:] == oracle.used[1:]
    assert bool(regression.friction_drifts) == oracle.friction_drifts
    return oracle, found


CASES: Mapping[str, tuple[Joint, Mapping[str, float]]] = {
    "one coefficient": (SHORT, ONE),
    "one coefficient, plain": (JOINT, {**ONE, **PLAIN}),
    "sensor": (SHORT, {**ONE, "modality": SENSOR}),
    "general basis": (SHORT, {"rls.symmetric": 0, "rls.n": 4, "rls.m": 1}),
    "turned round": (replace(FAST, duration=1.5), {**ONE, "motor.gamma": -50.0}),
    "held torque": (SHORT, {**ONE, "torque.held": 1}),
}
LONG_CASES: Mapping[str, tuple[Joint, Mapping[str, float]]] = {
    "all columns": (JOINT, {"motor.D_theta": 1.1e-3, "motor.B": 2.5e-5}),
    "exact inertia": (JOINT, {"prior.B": 0.0}),
    "sensor with all columns": (JOINT, {"modality": SENSOR}),
    "drift": (FAST, {"regression.drift": 1e-2}),
    "strong drift": (FAST, {"regression.drift": 1e3}),
    "creeping": (CREEPS, {}),
    "fast": (FAST, {"motor.B": 2.5e-5}),
    "turned round, fast, held": (FAST, {"motor.gamma": -50.0, "torque.held": 1}),
    "other parameters": (
        FAST,
        {
            "regression.bandwidth": 200.0,
            "regression.slow": 0.2,
            "range.phi": 0.1,
            "noise.tau": 0.01,
        },
    ),
    "limited bandwidth": (JOINT, {"noise.tau": 3e-4}),
    "other encoder of the link": (FAST, {"encoder.q": 10000.0}),
    "coarse encoders": (JOINT, {"encoder.theta": 4000.0, "encoder.q": 4000.0}),
    "no memory": (JOINT, {"regression.memory": 0.0, "motor.B": 3.5e-5}),
}


def run_case(c: Library, joint: Joint, values: Mapping[str, float]) -> None:
    p = {**START, **values}
    counts = {"encoder.theta": 40000.0, **p}["encoder.theta"]
    z = replace(joint, counts=counts).measurements()
    z[:, 3] *= np.sign(p["motor.gamma"])
    check(c, p, z)


@pytest.mark.parametrize("case", CASES)
def test_every_tick(c: Library, case: str) -> None:
    run_case(c, *CASES[case])


@pytest.mark.slow("dense matrices in extended precision")
@pytest.mark.parametrize("case", LONG_CASES)
def test_every_tick_of_longer_runs(c: Library, case: str) -> None:
    run_case(c, *LONG_CASES[case])


@pytest.mark.slow("dense matrices in extended precision")
def test_every_tick_of_table1(c: Library) -> None:
    check(c, START, table1_recording().measurements()[:3000])


def hysteresis(joint: Joint, z: Array) -> Array:
    width, state, loop = 0.006, 0.0, np.zeros(len(z))
    phi = joint.motion[3]
    for k in range(1, len(z)):
        state = np.clip(state + phi[k] - phi[k - 1], -width, width)
        loop[k] = 2.0 * state / width
    return loop


def dead_zone(joint: Joint, z: Array) -> Array:
    return -140.0 * np.clip(joint.motion[3], -0.012, 0.012)


def powers(joint: Joint, z: Array) -> Array:
    return 3e5 * joint.motion[3] ** 5


def set_powers(joint: Joint, z: Array) -> Array:
    _, _, _, phi, r = joint.motion
    return phi * 3e6 * (r - 0.07) ** 3


def ripple_of_the_motor(joint: Joint, z: Array) -> Array:
    theta, theta_dot, theta_ddot, _, _ = joint.motion
    angle, size = GAMMA * theta, 3e-4
    first, second = GAMMA * theta_dot * np.cos(angle), GAMMA * theta_ddot * np.cos(angle)
    second = second - (GAMMA * theta_dot) ** 2 * np.sin(angle)
    return size * (GAMMA**2 * (1e-3 * first + 2.3e-5 * second) + 140.0 * np.sin(angle))


def knees(joint: Joint, z: Array) -> Array:
    phi = joint.motion[3]
    return 100.0 * np.sign(phi) * np.maximum(np.abs(phi) - 0.021, 0.0)


def kink(joint: Joint, z: Array) -> Array:
    return 60.0 * np.abs(joint.motion[3])


def stribeck(joint: Joint, z: Array) -> Array:
    return -GAMMA * 0.08 * np.exp(-np.abs(joint.motion[1]) / 1.0) * np.sign(joint.motion[1])


def cogging(joint: Joint, z: Array) -> Array:
    return -GAMMA * 0.03 * np.sin(6 * GAMMA * joint.motion[0])


def friction_that_warms_up(joint: Joint, z: Array) -> Array:
    return -GAMMA * GAMMA * 1e-3 * joint.motion[1] * 0.3 * joint.t


def load_and_delay(joint: Joint, z: Array) -> Array:
    late = 3e-3 * np.gradient(z[:, 3], joint.t)
    load = np.abs(joint.tau_e) * np.tanh(joint.motion[1] / 0.02) * 0.15
    return GAMMA * late - load


MISFITS: Mapping[str, tuple[Callable[[Joint, Array], Array], Mapping[str, float], int]] = {
    "hysteresis": (hysteresis, {}, HYSTERESIS),
    "dead zone": (dead_zone, {}, GAP),
    "powers": (
        powers,
        {"prior.gap": 0.0, "prior.hysteresis": 0.0, "rls.n": 2, "range.phi": 0.1},
        POWERS,
    ),
    "powers of the set-point": (set_powers, {"prior.gap": 0.0, "rls.m": 2}, SET_POWER),
    "knees": (knees, {"prior.gap": 0.0, "prior.hysteresis": 0.0, "range.phi": 0.06}, KNEE),
    "kink": (kink, {"prior.gap": 0.0, "rls.symmetric": 0}, KNEE),
    "encoder of the motor": (ripple_of_the_motor, {}, MOTOR_ENCODER),
    "Stribeck friction": (stribeck, {"regression.memory": 2.0}, 0),
    "cogging": (cogging, {"regression.memory": 2.0}, 0),
    "friction that warms up": (friction_that_warms_up, {}, 0),
    "load friction and delay": (load_and_delay, {}, 0),
}
DRIFTING = ("friction that warms up",)


@pytest.mark.slow("dense matrices in extended precision")
@pytest.mark.parametrize("name", MISFITS)
def test_every_tick_of_a_joint_with_a_misfit(c: Library, name: str) -> None:
    torque, values, group = MISFITS[name]  # flexibility torque beyond the model [N.m]
    z = WIDE.measurements()
    z[:, 3] -= torque(WIDE, z) / GAMMA
    oracle, found = check(c, {**START, **values}, z)
    assert np.max(found["misfit"]) > 1.5
    assert oracle.friction_drifts == (name in DRIFTING)
    assert group == 0 or group in oracle.once_used


@pytest.mark.slow("dense matrices in extended precision")
def test_every_tick_of_a_misfit_that_begins(c: Library) -> None:
    """The older data are forgotten, five times as fast when the new ones agree by themselves."""
    joint = replace(JOINT, duration=12.0, stiffness=lambda t: np.where(t < 3.0, 1.0, 0.95))
    values = {**ONE, **PLAIN, "rls.n": 2}
    z = joint.measurements()
    z[:, 2] = 0.0
    z[:, 3] += (joint.tau_e - 140 * joint.stiffness(joint.t) * joint.motion[3]) / GAMMA
    oracle, found = check(c, {**START, **values}, z)
    assert np.max(found["misfit"]) > 1.4
    assert oracle.changes > 5


@pytest.mark.parametrize("modality", [RESIDUAL, SENSOR])
def test_every_tick_of_a_joint_that_already_moves(c: Library, modality: int) -> None:
    z = FAST.measurements()[5:500]  # 0.6 rad/s
    _, found = check(c, {**START, "modality": modality}, z)
    assert np.all(found["a"][5:30] == 0) == (modality == RESIDUAL)  # the first row shows it


@pytest.mark.slow("dense matrices in extended precision")
def test_every_tick_with_gaps_rest_and_changes_of_the_modality(c: Library) -> None:
    z = np.vstack([JOINT.measurements()[:2000], WIDE.measurements()[2000:3500]])
    z[700:720, 0] = np.nan
    z[1203, 3] = np.nan
    z[1206, 1] = np.inf
    z[1500:1700, :3] = z[1500, :3]  # the joint is held
    modality = np.full(len(z), RESIDUAL)
    modality[2200:2600] = SENSOR
    check(c, {**START, "rls.n": 2, "rls.m": 1}, z, modality)


@pytest.mark.parametrize("tau_e", [0.0, 1.0])
def test_every_tick_with_a_nominal_curve(c: Library, tau_e: float) -> None:
    z = table1_recording().measurements()[:1500]
    p = {**START, "prior.nominal": 0.3, "prior.tau_e": tau_e, "regression.drift": 1e-2, "rls.n": 2}
    p |= {"prior.hysteresis": 0.0, "prior.gap": 0.0, "prior.eccentric": 0.0}
    eta_0 = np.zeros((8, 5))
    eta_0[0][2] = 0.037  # 2 k_s 1e-6, 30 % too high
    eta_0[1][2] = -0.025
    estimator = Estimator(c, {**p, "rls.eta_0": eta_0.tolist()})
    expected = Oracle(c, p, z, eta_0[:2, :3], np.full(len(z), RESIDUAL)).run()
    found = estimator.run(z)
    compare(found, expected)
