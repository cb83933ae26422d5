"""A link between two motors with nonlinear transmissions, agonist and antagonist (section II).

The motors are of the form (3); the link is (2) with the sum of both flexibility torques. The
transmission is from the qbmove Advanced. Its manual ("qbmove Advanced Kit", qbrobotics,
28 April 2021, section 3.2.2, "Mathematical model") gives the torque of each side, k sinh(a phi), k
and a. The manual has no inertias, gears and friction: the motors are as in the AwAS, the values of
the link are chosen. We found no parameters of the VSA-II, which the paper names.

At the start the springs are not deformed. With torques tau_1 = -tau_2 a pair is at rest at q = 0
for initial.theta_i = asinh(gamma tau_i / k_i) / a_i.
"""

import casadi as ca

from sigmahat.plants.equations import PlantEquations
from sigmahat.plants.parts import add_link, add_motor, add_torque_sensors, position, velocity

SIDES = ("_1", "_2")

plant = PlantEquations("AntagonisticVsaPlant")

tau = {side: plant.input(f"tau{side}") for side in SIDES}

q = position(plant, "q")
theta = {side: position(plant, f"theta{side}") for side in SIDES}
q_dot = velocity(plant, "q_dot")
theta_dot = {side: velocity(plant, f"theta_dot{side}") for side in SIDES}

tau_e, sigma = {}, {}
for side in SIDES:
    k = plant.parameter(f"spring{side}.k")
    a = plant.parameter(f"spring{side}.a")
    phi = q - theta[side]
    tau_e[side] = k * ca.sinh(a * phi)
    sigma[side] = k * a * ca.cosh(a * phi)  # (4)
    add_motor(plant, theta[side], theta_dot[side], tau[side], tau_e[side], side)
    plant.output(f"phi{side}", phi)
    plant.output(f"tau_e{side}", tau_e[side])
    plant.output(f"sigma{side}", sigma[side])

add_link(plant, q, q_dot, tau_e["_1"] + tau_e["_2"])
add_torque_sensors(plant, {side: (tau[side], tau_e[side]) for side in SIDES})

plant.output("sigma", sigma["_1"] + sigma["_2"])
