"""The AwAS, an actuator with serial adjustable stiffness: (5) with (28)-(33)."""

import casadi as ca

from sigmahat.plants.plant import Plant, encoder

# Coulomb friction is smooth, tau_coulomb tanh(theta_dot / COULOMB_VELOCITY). A stuck motor thus
# creeps, at this speed [rad/s] under 76 % of the friction torque.
COULOMB_VELOCITY = 0.02

plant = Plant("AwasPlant")

tau = plant.input("tau")
tau_c = plant.input("tau_c")
tau_ext = plant.input("tau_ext")

M = plant.parameter("link.M")
D_q = plant.parameter("link.D_q")
mgl = plant.parameter("link.mgl")
B = plant.parameter("motor.B")
D_theta = plant.parameter("motor.D_theta")
gamma = plant.parameter("motor.gamma")
tau_coulomb = plant.parameter("motor.tau_coulomb")
B_c = plant.parameter("motor_c.B")
D_c = plant.parameter("motor_c.D")
gamma_c = plant.parameter("motor_c.gamma")
k_s = plant.parameter("spring.k_s")
r_0 = plant.parameter("spring.r_0")
b = plant.parameter("spring.b")

# A deformation of some 0.01 rad carries the torque, (28). The secondary motor jumps to its
# velocity within 10 us of a change of its torque; how exactly matters less.
q = plant.state("q", plant.parameter("initial.q"), scale=0.01)
theta = plant.state("theta", plant.parameter("initial.theta"), scale=0.01)
theta_c = plant.state("theta_c", plant.parameter("initial.theta_c"), scale=1.0)
q_dot = plant.state("q_dot", plant.parameter("initial.q_dot"), scale=1.0)
theta_dot = plant.state("theta_dot", plant.parameter("initial.theta_dot"), scale=1.0)
theta_c_dot = plant.state("theta_c_dot", plant.parameter("initial.theta_c_dot"), scale=100.0)

phi = q - theta
r = r_0 - b * theta_c  # (30)
tau_e = k_s * r**2 * ca.sin(2 * phi)  # (28)
sigma = 2 * k_s * r**2 * ca.cos(2 * phi)  # (29)
psi_e = -2 * k_s * b * r * ca.sin(phi) ** 2  # (31)
friction = D_theta * gamma * theta_dot + tau_coulomb * ca.tanh(theta_dot / COULOMB_VELOCITY)

# (5), with g(q) = mgl sin q. Torques are the derivatives of the potential k_s r^2 sin^2 phi
# with respect to q, theta and theta_c.
plant.derivative(q, q_dot)
plant.derivative(theta, theta_dot)
plant.derivative(theta_c, theta_c_dot)
plant.derivative(q_dot, (tau_ext - D_q * q_dot - tau_e - mgl * ca.sin(q)) / M)
plant.derivative(theta_dot, (tau - friction + tau_e / gamma) / (B * gamma))
plant.derivative(
    theta_c_dot, (tau_c - D_c * gamma_c * theta_c_dot - psi_e / gamma_c) / (B_c * gamma_c)
)

plant.output("q", q)
plant.output("theta", theta)
plant.output("theta_c", theta_c)
plant.output("q_dot", q_dot)
plant.output("theta_dot", theta_dot)
plant.output("theta_c_dot", theta_c_dot)
plant.output("phi", phi)
plant.output("r", r)
plant.output("tau_e", tau_e)
plant.output("sigma", sigma)
plant.output("q_measured", encoder(q, plant.parameter("encoder.q")))
plant.output("theta_measured", encoder(theta, plant.parameter("encoder.theta")))
plant.output("theta_c_measured", encoder(theta_c, plant.parameter("encoder.theta_c")))
plant.output("tau_measured", tau + plant.noise(plant.parameter("noise.tau_variance")))  # (32)
plant.output("tau_e_measured", tau_e + plant.noise(plant.parameter("noise.tau_e_variance")))  # (33)
