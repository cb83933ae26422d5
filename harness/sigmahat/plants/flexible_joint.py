"""A joint with a single flexible transmission, (2)-(4): a spring that hardens, with (32), (33)."""

from sigmahat.plants.equations import PlantEquations
from sigmahat.plants.parts import add_link, add_motor, add_torque_sensors, position, velocity

plant = PlantEquations("FlexibleJointPlant")

tau = plant.input("tau")

k_1 = plant.parameter("spring.k_1")
k_3 = plant.parameter("spring.k_3")

q = position(plant, "q")
theta = position(plant, "theta")
q_dot = velocity(plant, "q_dot")
theta_dot = velocity(plant, "theta_dot")

phi = q - theta
tau_e = k_1 * phi + k_3 * phi**3
sigma = k_1 + 3 * k_3 * phi**2  # (4)

add_link(plant, q, q_dot, tau_e)
add_motor(plant, theta, theta_dot, tau, tau_e)
add_torque_sensors(plant, {"": (tau, tau_e)})

plant.output("phi", phi)
plant.output("tau_e", tau_e)
plant.output("sigma", sigma)
