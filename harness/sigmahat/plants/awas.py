"""The AwAS, an actuator with serial adjustable stiffness: (5) with (28)-(33)."""

import casadi as ca

from sigmahat.plants.equations import PlantEquations, encoder
from sigmahat.plants.parts import add_link, add_motor, add_torque_sensors, position, velocity

plant = PlantEquations("AwasPlant")

tau = plant.input("tau")
tau_c = plant.input("tau_c")

B_c = plant.parameter("motor_c.B")
D_c = plant.parameter("motor_c.D")
gamma_c = plant.parameter("motor_c.gamma")
k_s = plant.parameter("spring.k_s")
r_0 = plant.parameter("spring.r_0")
b = plant.parameter("spring.b")

# The secondary motor reaches its velocity within 10 us of a change of its torque. This transient is
# not of interest, so the scales of its states are large.
q = position(plant, "q")
theta = position(plant, "theta")
theta_c = plant.state("theta_c", plant.parameter("initial.theta_c"), scale=1.0)
q_dot = velocity(plant, "q_dot")
theta_dot = velocity(plant, "theta_dot")
theta_c_dot = plant.state("theta_c_dot", plant.parameter("initial.theta_c_dot"), scale=100.0)

# Torques are the derivatives of the potential k_s r^2 sin^2 phi with respect to q, theta and
# theta_c.
phi = q - theta
r = r_0 - b * theta_c  # (30)
tau_e = k_s * r**2 * ca.sin(2 * phi)  # (28)
sigma = 2 * k_s * r**2 * ca.cos(2 * phi)  # (29)
psi_e = -2 * k_s * b * r * ca.sin(phi) ** 2  # (31)

add_link(plant, q, q_dot, tau_e)
add_motor(plant, theta, theta_dot, tau, tau_e)
add_torque_sensors(plant, {"": (tau, tau_e)})

# The secondary motor, third line of (5).
plant.derivative(theta_c, theta_c_dot)
plant.derivative(
    theta_c_dot, (tau_c - D_c * gamma_c * theta_c_dot - psi_e / gamma_c) / (B_c * gamma_c)
)
plant.output("theta_c", theta_c)
plant.output("theta_c_dot", theta_c_dot)
plant.output("theta_c_measured", encoder(theta_c, plant.parameter("encoder.theta_c")))

plant.output("phi", phi)
plant.output("r", r)
plant.output("tau_e", tau_e)
plant.output("sigma", sigma)
