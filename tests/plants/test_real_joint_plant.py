"""RealJointPlant.fmu against equations solved by scipy, and its measurements in closed form."""

import math
from collections.abc import Mapping

import numpy as np
import pytest

import reference_joints
from plant_runs import QUIET, Array, relative_error, run_plant, times
from reference_joints import round_to_counts

INPUTS = ("tau", "tau_ext", "r", "D_theta_change", "tau_coulomb_change")
STATES = ("q", "theta", "q_dot", "theta_dot")
LINEAR: Mapping[str, float] = {"spring.k_1": 120.0, "spring.k_3": 5e4}
BASE: Mapping[str, float] = {"motor.tau_coulomb": 0.02}
OF_THE_SPRING: Mapping[str, Mapping[str, float]] = {
    "dead zone": {"spring.gap": 2e-4},
    "hysteresis": {"spring.dahl": 0.3, "spring.dahl_phi": 2e-3},
    "kinematic error": {"gear.kinematic_error": 3e-4, "gear.kinematic_order": 2.0},
    "first knee": {"spring.k_knee_1": 40.0, "spring.knee_1": 1e-3},
    "second knee": {"spring.k_knee_2": 80.0, "spring.knee_2": 2e-3},
    "slow change": {"spring.k_step": -0.5, "spring.step_at": 0.053, "spring.step_for": 0.1},
    "arm": {"spring.k_s": 14220.0},
}
OF_THE_FRICTION: Mapping[str, Mapping[str, float]] = {
    "uneven friction": {"motor.uneven": 0.2},
    "load friction": {"motor.load_friction": 0.2},
    "Stribeck": {"motor.stribeck": 0.5, "motor.v_stribeck": 0.1},
    "bent friction": {"motor.v_bend": 2.0},
    "cogging": {"motor.cogging": 0.02, "motor.cogging_order": 6.0},
    "ripple": {"motor.ripple": 0.1, "motor.ripple_order": 4.0},
    "contact": {"contact.k": 20.0, "contact.d": 0.2},
    "gravity": {"link.mgl": 1.0},
}
OTHERS: Mapping[str, Mapping[str, float]] = {
    "damping": {"spring.damping": 1 / 300},
    "LuGre friction": {"motor.lugre": 0.02, "motor.lugre_theta": 5e-4},
    "LuGre friction by load": {"motor.lugre_load": 0.2},
    "damped bristles": {"motor.lugre_damping": 1e-3},
    "step": {"spring.k_step": 1.0, "spring.step_at": 0.053},
}


def together(misfits: Mapping[str, Mapping[str, float]]) -> dict[str, float]:
    return {name: value for each in misfits.values() for name, value in each.items()}


EVERYTHING = together({**OTHERS, **OF_THE_SPRING, **OF_THE_FRICTION})


def inputs(h: float, duration: float) -> Array:
    """Torques, a lever arm that moves, and friction that drifts."""
    t = times(h, duration)
    return np.column_stack(
        [
            0.3 * np.sin(2 * np.pi * 2 * t),
            np.sin(2 * np.pi * 1.1 * t),
            0.07 + 0.01 * np.sin(3 * t),
            -0.3 * t,
            0.2 * t,
        ]
    )


def run(h: float, given: Array, start: Mapping[str, float], *names: str) -> dict[str, Array]:
    return run_plant("RealJointPlant", INPUTS, h, given, {**BASE, **start}, [*STATES, *names])


def spring(p: Mapping[str, float], x: float, r: float, t: float) -> tuple[float, float]:
    """Elastic torque and stiffness at the deformation x [rad], arm r [m], time t [s]."""
    arm = p["spring.k_s"] * r * r
    torque = p["spring.k_1"] * x + p["spring.k_3"] * x**3 + arm * math.sin(2 * x)
    rising = p["spring.k_1"] + 3 * p["spring.k_3"] * x**2 + 2 * arm * math.cos(2 * x)
    for k, knee in (("k_knee_1", "knee_1"), ("k_knee_2", "knee_2")):
        free = min(max(x, -p[f"spring.{knee}"]), p[f"spring.{knee}"])
        torque += p[f"spring.{k}"] * (x - free)
        rising += p[f"spring.{k}"] * (x != free)
    late, ramp = t - p["spring.step_at"], p["spring.step_for"]
    done = float(late >= 0) if ramp == 0 else min(max(late / ramp, 0.0), 1.0)
    stiffer = 1 + p["spring.k_step"] * done
    return stiffer * torque, stiffer * rising


def equations(start: Mapping[str, float]) -> reference_joints.Derivative:
    """d/dt of q, theta, q_dot, theta_dot, the torque of the hysteresis, bristles [rad] and time."""
    none = {name: 0.0 for name in EVERYTHING} | {"spring.k_3": 0.0}
    p = {**none, "spring.dahl_phi": 1e-3, "motor.v_stribeck": 0.1, "motor.lugre_theta": 1e-4}
    p |= {**BASE, **start}
    M, D_q, B, D, gamma = 0.1, 0.15, 2.3e-5, 1e-3, 50.0

    def derivative(state: Array, tau: float, tau_ext: float, r: float, d: float, c: float) -> Array:
        q, theta, v_q, v, z, bent, t = state
        shown = p["gear.kinematic_error"] * math.sin(p["gear.kinematic_order"] * gamma * theta)
        x = q - theta + shown
        inside = abs(x) <= p["spring.gap"] > 0
        x = 0.0 if inside else x - math.copysign(p["spring.gap"], x)
        tau_e, rising = spring(p, x, r, t)
        if not inside:
            tau_e += p["spring.damping"] * rising * (v_q - v)
        tau_e += z
        bend = 1.0 + (v / p["motor.v_bend"]) ** 2 if p["motor.v_bend"] else 1.0
        sign = math.tanh(v / 0.02)
        peak = 1 + p["motor.stribeck"] * math.exp(-((v / p["motor.v_stribeck"]) ** 2))
        friction = D * (1 + d) * gamma * v / math.sqrt(bend)
        friction += p["motor.tau_coulomb"] * (1 + c) * (peak * sign + p["motor.uneven"])
        friction += p["motor.load_friction"] * abs(tau_e) / gamma * sign
        cogging = p["motor.cogging"] * math.sin(p["motor.cogging_order"] * gamma * theta)
        # C. Canudas de Wit: z' = v - |v| z / g(v) and F = sigma_0 z + sigma_1 z'
        g = p["motor.lugre_theta"] * peak
        bending = v - abs(v) * bent / g
        sigma_0 = p["motor.lugre"] + p["motor.lugre_load"] * abs(tau_e) / gamma
        sigma_0 /= p["motor.lugre_theta"]
        friction += sigma_0 * (bent + p["motor.lugre_damping"] * bending)
        against = tau_e + D_q * v_q + p["link.mgl"] * math.sin(q)
        against += p["contact.k"] * q + p["contact.d"] * v_q
        rippled = p["motor.ripple"] * math.sin(p["motor.ripple_order"] * gamma * theta)
        relative = v_q - v
        return np.array(
            [
                v_q,
                v,
                (tau_ext - against) / M,
                (tau * (1 + rippled) - friction + cogging + tau_e / gamma) / (B * gamma),
                (p["spring.dahl"] * relative - abs(relative) * z) / p["spring.dahl_phi"],
                bending,
                1.0,
            ]
        )

    return derivative


@pytest.mark.slow("a Radau solution with tight tolerances, of equations with kinks")
def test_with_every_misfit_the_motion_is_the_solution_of_the_equations() -> None:
    h, start = 1e-2, {**LINEAR, **EVERYTHING}
    given = inputs(h, 0.5)
    reference = reference_joints.solve(equations(start), h, given, np.zeros(7))[:, :4]
    assert relative_error(run(h, given, start), reference).max() < 1e-7


@pytest.mark.parametrize("misfits", [OF_THE_SPRING, OF_THE_FRICTION, OTHERS])
def test_each_misfit_enters_as_in_the_equations(misfits: Mapping[str, Mapping[str, float]]) -> None:
    h, start = 1e-2, {**LINEAR, **together(misfits)}
    given = inputs(h, 0.2)
    reference = reference_joints.solve(equations(start), h, given, np.zeros(7))[:, :4]
    assert relative_error(run(h, given, start), reference).max() < 1e-7
    for name in misfits:  # each has an effect
        others = together({n: each for n, each in misfits.items() if n != name})
        error = relative_error(run(h, given, {**LINEAR, **others}), reference)
        assert error.max() > 1e-4, name


def test_a_jump_of_the_torque_is_stepped_over() -> None:
    """At the edge of the dead zone the damping begins, which is more than all other torques."""
    h = 1e-3
    start = {"spring.gap": 1e-3, "spring.damping": 0.1}
    begin = {"initial.q": 2.0, "initial.theta": 2.0, "initial.q_dot": 1.0}
    given = np.zeros((21, 5))
    moving = np.array([2.0, 2.0, 1.0, 0.0, 0.0, 0.0, 0.0])
    reference = reference_joints.solve(equations({"spring.k_1": 150.0, **start}), h, given, moving)
    assert relative_error(run(h, given, {**start, **begin}), reference[:, :4]).max() < 1e-7


def test_without_misfits_it_is_the_flexible_joint() -> None:
    h, outputs = 1e-3, [*STATES, "q_measured", "theta_measured", "tau_measured", "tau_e", "sigma"]
    given = inputs(h, 0.5) * [1.0, 1.0, 1.0, 0.0, 0.0]
    start = {**BASE, **LINEAR}
    plain = run_plant("FlexibleJointPlant", INPUTS[:2], h, given[:, :2], start, outputs)
    real = run_plant("RealJointPlant", INPUTS, h, given, start, outputs)
    for name in outputs:
        np.testing.assert_allclose(real[name], plain[name], rtol=1e-9, atol=1e-12, err_msg=name)


def test_encoders_are_eccentric_have_another_zero_and_are_read_late() -> None:
    start = {
        "encoder.q_eccentricity": 3e-4,
        "encoder.q_offset": 2e-3,
        "encoder.q_delay": 2e-3,
        "encoder.theta_eccentricity": 8e-5,
    }
    given = inputs(1e-3, 0.5)
    record = ("q_measured", "theta_measured")
    exact = {**start, "encoder.q": 0.0, "encoder.theta": 0.0}
    out = run(1e-3, given, exact, *record)
    q = out["q"] + 3e-4 * np.sin(out["q"] + 0.4) + 2e-3 + 2e-3 * out["q_dot"]
    theta = out["theta"] + 8e-5 * np.sin(50 * out["theta"] + 0.7)
    np.testing.assert_allclose(out["q_measured"], q, rtol=0, atol=1e-14)
    np.testing.assert_allclose(out["theta_measured"], theta, rtol=0, atol=1e-14)
    rounded = run(1e-3, given, start, *record)  # what the encoder sees is rounded
    np.testing.assert_allclose(rounded["q_measured"], round_to_counts(q, 40000), rtol=0, atol=1e-12)


def test_the_measured_torque_has_a_gain_and_a_bias() -> None:
    given = inputs(1e-3, 0.1)
    start = {**QUIET, "sensor.tau_gain": 0.9, "sensor.tau_bias": 0.01}
    out = run(1e-3, given, start, "tau_measured")
    np.testing.assert_allclose(out["tau_measured"], (given[:, 0] - 0.01) / 0.9, rtol=0, atol=1e-15)


def test_stiffness_is_the_slope_of_the_torque_and_0_in_the_dead_zone() -> None:
    start = {**LINEAR, "spring.k_s": 1000.0, "spring.gap": 1e-3, "spring.k_step": 0.5}
    start |= {"spring.k_knee_1": 40.0, "spring.k_knee_2": -30.0}

    def at(phi: float) -> tuple[float, float]:
        """Torque and stiffness."""
        out = run(1e-3, np.zeros((2, 5)), {**start, "initial.theta": -phi}, "tau_e", "sigma")
        return float(out["tau_e"][0]), float(out["sigma"][0])

    for phi in (-0.02, -8e-3, -1.2e-3, 1.2e-3, 8e-3, 0.02):
        (below, _), (above, _), (_, stiffness) = at(phi - 1e-4), at(phi + 1e-4), at(phi)
        assert stiffness == pytest.approx((above - below) / 2e-4, rel=1e-5)
    assert at(4e-4) == at(6e-4) == (0.0, 0.0)
