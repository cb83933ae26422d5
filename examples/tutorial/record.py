"""Records knee.csv, the log of the tutorial: a knee with a series elastic actuator, simulated.

The spring hardens with its deformation, and the motor has Coulomb friction. The log has 20 s at 250
Hz. The motor encoder is a counter of 16 bits, the link is in degrees, the current in amperes.

Usage: python record.py [FOLDER]     writes knee.csv there, always the same bytes
"""

import math
import sys
from pathlib import Path

import numpy as np

import sigmahat

COUNTS, GEAR_RATIO, TORQUE_CONSTANT = 4096, 100, 0.1  # counts per turn of the motor; [N.m/A]
LINK_COUNTS = 2**18
WRAP = 2**16
T = 0.004  # [s]
JOINT = {
    "motor.B": 5e-5,
    "motor.D_theta": 8e-4,
    "motor.gamma": float(GEAR_RATIO),
    "motor.tau_coulomb": 0.03,
    "link.M": 0.25,
    "link.D_q": 1.0,
    "link.mgl": 8.0,
    "spring.k_1": 300.0,  # tau_e = k_1 phi + k_3 phi^3
    "spring.k_3": 25000.0,
    "encoder.theta": float(COUNTS * GEAR_RATIO),
    "encoder.q": float(LINK_COUNTS),
    "noise.tau_variance": 0.004**2,
    "noise.samplePeriod": T,
}


def record(path: Path) -> sigmahat.Recording:
    """Writes the log. Returns the recording with the true stiffness and deformation."""
    torque = [sigmahat.Sine(0.16, 0.4), sigmahat.Sine(0.14, 1.3), sigmahat.Sine(0.12, 4.1)]
    plant = sigmahat.Plant(
        fmu="RealJointPlant",
        start=JOINT,
        inputs={"tau": sigmahat.Sines(0.0, torque)},
        record=["theta_measured", "q_measured", "tau_measured", "phi", "sigma"],
    )
    joint = sigmahat.simulate(plant, {}, T=T, steps=round(20 / T))
    counts = np.rint(joint.plant["theta_measured"] / (2 * math.pi) * COUNTS * GEAR_RATIO)
    columns = {
        "time_s": (joint.t, "%.3f"),
        "motor_counts": (np.mod(counts, WRAP), "%d"),
        "link_deg": (np.degrees(joint.plant["q_measured"]), "%.4f"),
        "current_A": (joint.plant["tau_measured"] / TORQUE_CONSTANT, "%.3f"),
    }
    table = np.column_stack([values for values, _ in columns.values()])
    formats = [digits for _, digits in columns.values()]
    np.savetxt(path, table, formats, ",", header=",".join(columns), comments="")
    return joint


if __name__ == "__main__":
    record(Path(sys.argv[1] if len(sys.argv) > 1 else ".") / "knee.csv")
