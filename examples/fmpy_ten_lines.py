import fmpy
import numpy as np

import sigmahat

t = np.arange(0, 5.001, 1e-3)  # a log of yours: positions in rad, motor torque in N.m
theta, q, theta_c, no_sensor = np.sin(t), 1.002 * np.sin(t), 0 * t, 0 * t
# Motor equation (3) of a joint of 1000 N.m/rad, with B = 2.3e-5, D_theta = 1e-3, gamma = 50:
tau = 0.05 * np.cos(t) - 0.00115 * np.sin(t) - 1000 * (q - theta) / 50
names = ["time", "theta", "q", "theta_c", "tau", "tau_e_sensor"]
log = np.rec.fromarrays([t, theta, q, theta_c, tau, no_sensor], [(name, float) for name in names])
fmu = sigmahat.fmu("StiffnessEstimator")
result = fmpy.simulate_fmu(fmu, stop_time=5, output_interval=1e-3, input=log, output=["sigma"])
print(result["sigma"][-1], "N.m/rad")
