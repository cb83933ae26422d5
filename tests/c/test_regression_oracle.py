"""FilteredRegression, every output of every tick, against a second implementation.

The second implementation, in helpers/dense_*.py, has dense matrices in extended precision and the
filters of scipy.
Decisions compare a number with a threshold. In these runs, the numbers are far from each threshold,
so that rounding errors change no decision.
"""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from c_library import Array, Estimator, Library
from dense_regression import START, Oracle
from oracle import RESIDUAL, SENSOR
from reference_joints import table1_recording
from regression_joint import GAMMA, PLAIN, Joint

SHORT = Joint(duration=1.5, tau_coulomb=0.02)
JOINT = Joint(duration=3.0, tau_coulomb=0.02)
WIDE = Joint(duration=4.0, tau_coulomb=0.02, deformation=0.05)
FAST = Joint(duration=3.0, frequency=8.0, amplitude=0.05, tau_coulomb=0.02)
CREEPS = Joint(duration=4.0, frequency=0.2, amplitude=0.5, tau_coulomb=0.02)
ONE = {"rls.n": 1, "rls.m": 1}
NO_MOTOR = {**PLAIN, "prior.D_theta": 0.0, "prior.tau_coulomb": 0.0, "prior.B": 0.0}
OTHERS = {
    **{"regression.bandwidth": 200.0, "regression.slow": 0.2},
    **{"range.phi": 0.1, "noise.tau": 0.01},
}
POWERS, SET_POWER, KNEE, HYSTERESIS, MOTOR_ENCODER, GAP = range(1, 7)


def check(
    c: Library, p: Mapping[str, Any], z: Array, modality: Array | None = None
) -> tuple[Oracle, NDArray[np.void]]:
    """Compares a run, in which the modality may change: every output, to 1e-7 of its largest value;
    each coefficient of eta by itself."""
    modalities = np.full(len(z), p["modality"]) if modality is None else modality
    oracle = Oracle(c, p, z, modalities)
    estimator = Estimator(c, p)
    changes = [*(np.flatnonzero(np.diff(modalities)) + 1), len(z)]
    parts, first = [], 0
    for last in changes:
        c.set(estimator.parameters, "modality", int(modalities[first]))
        parts.append(estimator.run(z[first:last]))
        first = last
    found = np.concatenate(parts)
    good = oracle.good
    assert np.array_equal(found["valid"] == 1, good)
    for name, want in oracle.run().items():
        largest = np.max(np.abs(want), axis=0)
        error = np.max(np.abs(found[name][good] - want), axis=0)
        assert np.all(error <= 1e-7 * largest), (name, np.max(error / np.maximum(largest, 1e-300)))
    regression = estimator.state.method.regression
    assert list(regression.refit.used)[1:] == oracle.used[1:]
    assert bool(regression.bank.friction_drifts) == oracle.friction_drifts
    return oracle, found


# The knees are at 5 and 15 mrad, within the range of the deformation.
TWO_KNEES = {"range.phi": 0.025, "range.knee": 0.2, "range.knee_2": 0.6}
GENERAL = {"rls.symmetric": 0, "rls.n": 4, "rls.m": 1}
CASES: Mapping[str, tuple[Joint, Mapping[str, float]]] = {
    "one coefficient": (SHORT, ONE),
    "one coefficient, plain": (JOINT, {**ONE, **PLAIN}),
    "one column": (replace(SHORT, tau_coulomb=0.0), {**ONE, **NO_MOTOR, "regression.drift": 1e-2}),
    "sensor": (SHORT, {**ONE, "modality": SENSOR}),
    "general basis": (SHORT, GENERAL),
    "set-points around their center": (
        SHORT,
        {"rls.n": 2, "rls.m": 3, "range.setPoint": 20.0, "range.setPoint_center": 65.0},
    ),
    "two knees": (SHORT, {**GENERAL, **TWO_KNEES}),
    "symmetric knees": (SHORT, {"rls.m": 1, **TWO_KNEES}),
    "one power less than the most": (SHORT, {"rls.n": 7, "rls.m": 1}),
    "turned round": (replace(FAST, duration=1.5), {**ONE, "motor.gamma": -50.0}),
    "held torque": (SHORT, {**ONE, "torque.held": 1}),
    **{f"{n} samples in a row": (SHORT, {**ONE, "regression.decimation": n}) for n in (1, 2, 5)},
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
    "other parameters": (FAST, OTHERS),
    "limited bandwidth": (JOINT, {"noise.tau": 3e-4}),
    "other encoder of the link": (FAST, {"encoder.q": 10000.0}),
    "coarse encoders": (JOINT, {"encoder.theta": 4000.0, "encoder.q": 4000.0}),
    "no memory": (JOINT, {"regression.memory": 0.0, "motor.B": 3.5e-5}),
}

slow = pytest.mark.slow("dense matrices in extended precision")


@pytest.mark.parametrize(
    ("joint", "values"),
    [
        *(pytest.param(*case, id=name) for name, case in CASES.items()),
        *(pytest.param(*case, id=name, marks=slow) for name, case in LONG_CASES.items()),
    ],
)
def test_every_tick(c: Library, joint: Joint, values: Mapping[str, float]) -> None:
    p = {**START, **values}
    z = replace(joint, counts=p["encoder.theta"]).measurements()
    z[:, 3] *= np.sign(p["motor.gamma"])
    check(c, p, z)


@slow
def test_every_tick_of_table1(c: Library) -> None:
    check(c, START, table1_recording().measurements()[:3000])


THETA, THETA_DOT, THETA_DDOT, PHI, LEVER = WIDE.motion
GEAR_ANGLE, GEAR_VELOCITY = GAMMA * THETA, GAMMA * THETA_DOT
NO_GAP = {"prior.gap": 0.0}
NO_HYSTERESIS = {**NO_GAP, "prior.hysteresis": 0.0}
# Only the column of the widest dead zone, 16 % of the range, is taken out.
NARROW = {"prior.power": 0.0, "prior.hysteresis": 0.0, "range.phi": 0.06}


def ripple_of_the_motor() -> Array:
    first, second = GEAR_VELOCITY * np.cos(GEAR_ANGLE), GAMMA * THETA_DDOT * np.cos(GEAR_ANGLE)
    second = second - GEAR_VELOCITY**2 * np.sin(GEAR_ANGLE)
    return 3e-4 * (GAMMA**2 * (1e-3 * first + 2.3e-5 * second) + 140.0 * np.sin(GEAR_ANGLE))


# Flexibility torque beyond the model [N.m], or misfits of the joint; parameters; and the group
# that is then used.
MISFITS: Mapping[str, tuple[Array | Mapping[str, Any], Mapping[str, float], int]] = {
    "hysteresis": ({"hysteresis": 2.0, "hysteresis_width": 0.006}, {}, HYSTERESIS),
    "dead zone": (-140.0 * np.clip(PHI, -0.012, 0.012), {}, GAP),
    "wide dead zone": (-140.0 * np.clip(PHI, -0.0096, 0.0096), NARROW, GAP),
    "soft middle": (-70.0 * np.clip(PHI, -0.0096, 0.0096), NARROW, GAP),
    "powers": (3e5 * PHI**5, {**NO_HYSTERESIS, "rls.n": 2, "range.phi": 0.1}, POWERS),
    "set-point": (PHI * 3e6 * (LEVER - 0.07) ** 3, {**NO_GAP, "rls.m": 2}, SET_POWER),
    "knees": (
        100.0 * np.sign(PHI) * np.maximum(np.abs(PHI) - 0.021, 0.0),
        {**NO_HYSTERESIS, "range.phi": 0.06},
        KNEE,
    ),
    "kink": (60.0 * np.abs(PHI), {**NO_GAP, "rls.symmetric": 0}, KNEE),
    "encoder of the motor": (ripple_of_the_motor(), {}, MOTOR_ENCODER),
    "Stribeck friction": (
        -GAMMA * 0.08 * np.exp(-np.abs(THETA_DOT)) * np.sign(THETA_DOT),
        {"regression.memory": 2.0},
        0,
    ),
    "cogging": (-GAMMA * 0.03 * np.sin(6 * GEAR_ANGLE), {"regression.memory": 2.0}, 0),
    # With a short memory, the past is forgotten before the drift is noticed.
    "friction that warms up": (
        -(GAMMA**2) * 1e-3 * THETA_DOT * 0.3 * WIDE.t,
        {"regression.memory": 200.0},
        0,
    ),
    "load friction and delay": ({"load_friction": 0.15, "delay": 3e-3}, {}, 0),
}
# Effects that look like friction that drifts, or like friction that changes.
DRIFTING = ("set-point", "encoder of the motor")
OTHER_FRICTION = ("friction that warms up", "cogging")


@slow
@pytest.mark.parametrize("name", MISFITS)
def test_every_tick_of_a_joint_with_a_misfit(c: Library, name: str) -> None:
    misfit, values, group = MISFITS[name]
    if isinstance(misfit, Mapping):
        z = replace(WIDE, **misfit).measurements()
    else:
        z = WIDE.measurements()
        z[:, 3] -= misfit / GAMMA
    oracle, found = check(c, {**START, **values}, z)
    assert np.max(found["misfit"]) > 1.5
    assert oracle.friction_drifts == (name in DRIFTING)
    assert oracle.change.was_tested == (name in OTHER_FRICTION)
    assert group == 0 or group in oracle.once_used


@slow
def test_every_tick_of_a_misfit_that_begins(c: Library) -> None:
    """Data that contradict the model are forgotten: fewer than the 240 blocks of the run count."""
    joint = replace(JOINT, duration=12.0, seed=3, stiffness=lambda t: np.where(t < 3.0, 1.0, 0.95))
    values = {**ONE, **PLAIN, "rls.n": 2}
    z = joint.measurements()
    z[:, 2] = 0.0
    z[:, 3] += (joint.tau_e - 140 * joint.stiffness(joint.t) * joint.motion[3]) / GAMMA
    oracle, found = check(c, {**START, **values}, z)
    assert np.max(found["misfit"]) > 1.4
    assert oracle.blocks.count < 200


@pytest.mark.parametrize("modality", [RESIDUAL, SENSOR])
@pytest.mark.parametrize(("frequency", "begin", "sample"), [(8.0, 6, 2), (2.0, 20, 8)])
def test_every_tick_of_a_joint_that_already_moves(
    c: Library, frequency: float, begin: int, sample: int, modality: int
) -> None:
    """The third sample shows a fast motion, a later one a slower motion."""
    z = replace(FAST, frequency=frequency).measurements()[begin:500]
    _, found = check(c, {**START, "modality": modality}, z)
    assert np.flatnonzero(found["a"] == 0)[:1].tolist() == (
        [sample] if modality == RESIDUAL else []
    )


@slow
def test_every_tick_with_gaps_rest_and_changes_of_the_modality(c: Library) -> None:
    z = np.vstack([JOINT.measurements()[:2000], WIDE.measurements()[2000:3500]])
    z[700:720, 0] = np.nan
    z[1203, 3] = np.nan
    z[1206, 1] = np.inf
    z[1500:1700, :3] = z[1500, :3]  # the joint is held
    modality = np.full(len(z), RESIDUAL)
    modality[2200:2600] = SENSOR
    check(c, {**START, "rls.n": 2, "rls.m": 1}, z, modality)


def test_every_tick_with_bad_samples(c: Library) -> None:
    """Some alone, some in a row, and a torque that stays."""
    z = replace(SHORT, duration=2.5).measurements()
    z[0, 3] = 30.0
    z[400, 3], z[500, 0], z[600, 1] = 9.0, 0.5, -0.3
    z[601, 3] = np.nan
    z[700:750, 1] += 0.1
    z[752, 1] = np.nan
    z[1000:1300:40, 3] += 5.0
    z[1500:, 3] += 1.4
    z[1900:1920, 3] = 1e6
    z[2000, 2] += 1000.0
    oracle, found = check(c, {**START, "rls.n": 2, "rls.m": 2, "range.setPoint": 20.0}, z)
    assert 200 < np.count_nonzero(found["doubt"] == c.lib.SH_DOUBT_OUTLIER) < 400
    assert np.all(oracle.good[1700:1900])


@pytest.mark.parametrize("tau_e", [0.0, 1.0])
def test_every_tick_with_a_nominal_curve(c: Library, tau_e: float) -> None:
    z = table1_recording().measurements()[:1500]
    p = {**START, "prior.nominal": 0.3, "prior.tau_e": tau_e, "regression.drift": 1e-2, "rls.n": 2}
    p |= {"prior.hysteresis": 0.0, "prior.gap": 0.0, "prior.eccentric": 0.0}
    eta_0 = np.zeros((8, 5))
    eta_0[0][2] = 0.037  # 2 k_s 1e-6, 30 % too high
    eta_0[1][2] = -0.025
    check(c, {**p, "rls.eta_0": eta_0.tolist()}, z)
