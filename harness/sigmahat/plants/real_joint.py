"""A joint with misfits: effects of real joints that the models of the estimators do not have.

The link (2), the motor (3) and the torque sensors (32), (33) are as in the other plants. Each
effect is a parameter, which starts at the value for "none". The spring is linear and cubic, or
the AwAS (28) with its lever arm as an input, or a sum of both.
"""

import casadi as ca

from sigmahat.plants.equations import PlantEquations, encoder
from sigmahat.plants.parts import (
    COULOMB_VELOCITY,
    add_link,
    add_torque_sensors,
    position,
    velocity,
)

PHASE_Q, PHASE_THETA = 0.4, 0.7  # of encoder eccentricity, link and motor [rad]

plant = PlantEquations("RealJointPlant")

tau = plant.input("tau")
r = plant.input("r")
D_theta_change = plant.input("D_theta_change")
tau_coulomb_change = plant.input("tau_coulomb_change")

gamma = plant.parameter("motor.gamma")

q = position(plant, "q")
theta = position(plant, "theta")
q_dot = velocity(plant, "q_dot")
theta_dot = velocity(plant, "theta_dot")
tau_dahl = plant.state("tau_dahl", start=0.0, scale=1.0)
bristle = plant.state("bristle", start=0.0, scale=1.0)  # relative to the deflection during sliding
clock = plant.state("clock", start=0.0, scale=1e12)  # integrated exactly: it needs no small steps

# The gear has a kinematic error, once or several times per turn of the motor.
phi = q - theta
phi_dot = q_dot - theta_dot
turns = plant.parameter("gear.kinematic_order") * gamma * theta
deformation = phi + plant.parameter("gear.kinematic_error") * ca.sin(turns)

# After the dead zone, the spring is deformed by x.
gap = plant.parameter("spring.gap")
x = ca.fmax(deformation - gap, 0) + ca.fmin(deformation + gap, 0)
engaged = ca.logic_or(ca.fabs(deformation) > gap, gap <= 0)

k_1 = plant.parameter("spring.k_1")
k_3 = plant.parameter("spring.k_3")
k_awas = plant.parameter("spring.k_s") * r**2
elastic = k_1 * x + k_3 * x**3 + k_awas * ca.sin(2 * x)  # (28)
slope = k_1 + 3 * k_3 * x**2 + 2 * k_awas * ca.cos(2 * x)  # (4), (29)

# Beyond each knee the torque has another slope, as in a harmonic drive.
for knee in (1, 2):
    beyond = ca.fabs(x) - plant.parameter(f"spring.knee_{knee}")
    change = plant.parameter(f"spring.k_knee_{knee}")
    elastic += change * ca.sign(x) * ca.fmax(beyond, 0)
    slope += ca.if_else(beyond > 0, change, 0)

# The stiffness changes at a time since the start, at once or in a ramp.
k_step = plant.parameter("spring.k_step")
since = clock - plant.parameter("spring.step_at")
step_for = plant.parameter("spring.step_for")
ramp = ca.fmin(ca.fmax(since, 0) / ca.if_else(step_for > 0, step_for, 1), 1)
changed = 1 + k_step * ca.if_else(step_for > 0, ramp, since >= 0)
plant.derivative(clock, ca.SX(1))
elastic *= changed
sigma = ca.if_else(engaged, slope * changed, 0)

# Hysteresis: P. Dahl, "A solid friction model", 1968, with the exponent 1.
dahl = plant.parameter("spring.dahl") * phi_dot - ca.fabs(phi_dot) * tau_dahl
plant.derivative(tau_dahl, dahl / plant.parameter("spring.dahl_phi"))

tau_e = elastic + plant.parameter("spring.damping") * sigma * phi_dot + tau_dahl

# Friction of the motor, on its axis.
sign = ca.tanh(theta_dot / COULOMB_VELOCITY)
v_bend = plant.parameter("motor.v_bend")
bend = ca.if_else(v_bend > 0, theta_dot / ca.if_else(v_bend > 0, v_bend, 1), 0)
viscous = plant.parameter("motor.D_theta") * (1 + D_theta_change) * gamma * theta_dot
viscous /= ca.sqrt(1 + bend**2)
stribeck = plant.parameter("motor.stribeck")
stribeck *= ca.exp(-((theta_dot / plant.parameter("motor.v_stribeck")) ** 2))
coulomb = plant.parameter("motor.tau_coulomb") * (1 + tau_coulomb_change)
coulomb *= (1 + stribeck) * sign + plant.parameter("motor.uneven")
of_load = plant.parameter("motor.load_friction") * ca.fabs(tau_e) / gamma * sign
cogging = ca.sin(plant.parameter("motor.cogging_order") * gamma * theta)
cogging *= plant.parameter("motor.cogging")
ripple = ca.sin(plant.parameter("motor.ripple_order") * gamma * theta)
ripple *= plant.parameter("motor.ripple") * tau

# LuGre friction, C. Canudas de Wit et al., IEEE Transactions on Automatic Control 40(3), 1995. The
# load presses more bristles together, so the whole torque is proportional to the level.
lugre, lugre_load = plant.parameter("motor.lugre"), plant.parameter("motor.lugre_load")
level = lugre + lugre_load * ca.fabs(tau_e) / gamma
slip = theta_dot - ca.fabs(theta_dot) * bristle / (1 + stribeck)
slip /= plant.parameter("motor.lugre_theta")
plant.derivative(bristle, ca.if_else(lugre + lugre_load > 0, slip, 0))
sliding = level * (bristle + plant.parameter("motor.lugre_damping") * slip)

on_motor = tau + ripple + cogging - viscous - coulomb - of_load - sliding + tau_e / gamma
plant.derivative(theta, theta_dot)
plant.derivative(theta_dot, on_motor / (plant.parameter("motor.B") * gamma))
plant.output("theta", theta)
plant.output("theta_dot", theta_dot)
at_encoder = theta + plant.parameter("encoder.theta_eccentricity") * ca.sin(
    gamma * theta + PHASE_THETA
)
plant.output("theta_measured", encoder(at_encoder, plant.parameter("encoder.theta")))

contact = plant.parameter("contact.k") * q + plant.parameter("contact.d") * q_dot
q_at_encoder = q + plant.parameter("encoder.q_eccentricity") * ca.sin(q + PHASE_Q)
q_at_encoder += plant.parameter("encoder.q_offset") + plant.parameter("encoder.q_delay") * q_dot
add_link(plant, q, q_dot, tau_e + contact, q_at_encoder)

tau_read = (tau - plant.parameter("sensor.tau_bias")) / plant.parameter("sensor.tau_gain")
add_torque_sensors(plant, {"": (tau_read, tau_e)})

plant.output("phi", phi)
plant.output("tau_e", tau_e)
plant.output("sigma", sigma)
