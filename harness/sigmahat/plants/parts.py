"""Parts that joints have in common: the link (2), motors (3), friction, encoders, torque sensors.

A plant declares its states and the torque of its transmission; these functions add other parts,
with the names that all plants use. In a joint with several motors, `side` is the suffix of the
names of a motor: "_1" gives `theta_1`, `motor_1.B` and `tau_measured_1`.
"""

from collections.abc import Mapping

import casadi as ca

from sigmahat.plants.equations import PlantEquations, encoder

COULOMB_VELOCITY = 0.02
"""Coulomb friction is smooth: tau_coulomb tanh(velocity / COULOMB_VELOCITY) [rad/s]. So a joint
that would stick creeps instead, at this velocity under 76 % of the friction torque."""


def position(plant: PlantEquations, name: str) -> ca.SX:
    """State `name` [rad] of a link or motor, which starts at the parameter `initial.<name>`.

    The scale of the state is 0.01 rad, because a small deformation may have a large torque.
    """
    return plant.state(name, plant.parameter(f"initial.{name}"), scale=0.01)


def velocity(plant: PlantEquations, name: str) -> ca.SX:
    """State `name` [rad/s] of a link or motor, which starts at the parameter `initial.<name>`."""
    return plant.state(name, plant.parameter(f"initial.{name}"), scale=1.0)


def add_link(
    plant: PlantEquations, q: ca.SX, q_dot: ca.SX, tau_e: ca.SX, at_encoder: ca.SX | None = None
) -> None:
    """Adds the link (2) with g(q) = mgl sin q and Coulomb friction, and its encoder.

    The input `tau_ext` acts on it, and `tau_e`, the sum of the flexibility torques, against it.
    The encoder rounds `at_encoder` [rad], or q if it has no error but rounding.
    """
    tau_ext = plant.input("tau_ext")
    friction = plant.parameter("link.D_q") * q_dot
    friction += _coulomb(plant.parameter("link.tau_coulomb"), q_dot)
    gravity = plant.parameter("link.mgl") * ca.sin(q)
    plant.derivative(q, q_dot)
    plant.derivative(q_dot, (tau_ext - friction - tau_e - gravity) / plant.parameter("link.M"))
    plant.output("q", q)
    plant.output("q_dot", q_dot)
    seen = q if at_encoder is None else at_encoder
    plant.output("q_measured", encoder(seen, plant.parameter("encoder.q")))


def add_motor(
    plant: PlantEquations, theta: ca.SX, theta_dot: ca.SX, tau: ca.SX, tau_e: ca.SX, side: str = ""
) -> None:
    """Adds a motor (3) with Coulomb friction, and its encoder; `tau` is on the motor axis."""
    gamma = plant.parameter(f"motor{side}.gamma")
    friction = plant.parameter(f"motor{side}.D_theta") * gamma * theta_dot
    friction += _coulomb(plant.parameter(f"motor{side}.tau_coulomb"), theta_dot)
    inertia = plant.parameter(f"motor{side}.B") * gamma
    plant.derivative(theta, theta_dot)
    plant.derivative(theta_dot, (tau - friction + tau_e / gamma) / inertia)
    plant.output(f"theta{side}", theta)
    plant.output(f"theta_dot{side}", theta_dot)
    plant.output(f"theta_measured{side}", encoder(theta, plant.parameter(f"encoder.theta{side}")))


def add_torque_sensors(plant: PlantEquations, torques: Mapping[str, tuple[ca.SX, ca.SX]]) -> None:
    """Adds the measured motor torque (32) and flexibility torque (33) of each side, with noise.

    `torques` holds tau and tau_e by side. Variances and the gain of the sensor of tau_e are
    common to all sides.
    """
    tau_variance = plant.parameter("noise.tau_variance")
    tau_e_variance = plant.parameter("noise.tau_e_variance")
    gain = plant.parameter("sensor.gain")
    for side, (tau, tau_e) in torques.items():
        plant.output(f"tau_measured{side}", tau + plant.noise(tau_variance))
        plant.output(f"tau_e_measured{side}", gain * tau_e + plant.noise(tau_e_variance))


def _coulomb(torque: ca.SX, velocity: ca.SX) -> ca.SX:
    return torque * ca.tanh(velocity / COULOMB_VELOCITY)
