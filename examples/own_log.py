"""A log of your own joint: the motor identified, the stiffness estimated, from Python.

It does the same as `sigmahat identify` and `sigmahat estimate`. The log comes from a simulation of
the AwAS, in units of a robot: motor encoder in counts, link in degrees, current in amperes.

Usage: python own_log.py [FOLDER]     writes knee.csv, knee.toml and the folder knee there
"""

import math
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np

import sigmahat

CONFIGURATION = """\
time.column = "time_s"
[ports]  # theta: principal motor, its encoder before the gear; q: link; theta_c: sets the stiffness
theta = {column = "motor_counts", unit = "counts", counts_per_turn = 800, gear_ratio = 50}
q = {column = "link_deg", unit = "deg"}
theta_c = {column = "lever_rad"}
tau = {column = "current_A", unit = "A", torque_constant = 0.05}  # of the principal motor [N.m/A]
[parameters]  # the motor as its data sheet says, 20 % off
samplePeriod = 0.001
motor = {B = 1.84e-5, D_theta = 1.2e-3, gamma = 50}
"""


def record(path: Path) -> sigmahat.Recording:
    """Writes a log of the AwAS: 15 s at 1 kHz. Returns it with the true stiffness."""
    lead = 0.0025 / (2 * math.pi)  # of the ball screw [m/rad]
    plant = sigmahat.Plant(
        fmu="AwasPlant",
        start={"initial.theta_c": 0.030 / lead},
        # The slow sine determines D_theta and the springs, the fast one B.
        inputs={
            "tau": sigmahat.Sines(0.0, [sigmahat.Sine(0.3, 0.5), sigmahat.Sine(0.2, 3.0)]),
            "tau_c": sigmahat.Sine(8.0, 0.1),
        },
        record=["theta_measured", "q_measured", "theta_c_measured", "tau_measured", "sigma"],
    )
    joint = sigmahat.simulate(plant, {}, T=1e-3, steps=15_000)
    columns = {
        "time_s": joint.t,
        "motor_counts": np.rint(joint.plant["theta_measured"] / (2 * math.pi) * 50 * 800),
        "link_deg": np.degrees(joint.plant["q_measured"]),
        "lever_rad": joint.plant["theta_c_measured"],
        "current_A": joint.plant["tau_measured"] / 0.05,
    }
    table = np.column_stack(list(columns.values()))
    np.savetxt(path, table, "%.10g", ",", header=",".join(columns), comments="")
    return joint


def main(folder: Path) -> None:
    """Writes log and configuration, then does what you would do with yours."""
    joint = record(folder / "knee.csv")
    (folder / "knee.toml").write_text(CONFIGURATION, encoding="utf-8")

    log = sigmahat.open_log(folder / "knee.csv")
    configuration = sigmahat.read_configuration(folder / "knee.toml")
    motor = sigmahat.identify(log, configuration)
    parameters = dict(configuration.parameters)
    for name in ("B", "D_theta"):
        found = motor.quantities[name]
        if found.determined:
            print(f"{name}: {found.value:.4g} +- {found.half_width:.1g}")
            parameters[f"motor.{name}"] = found.value
        else:
            print(f"{name}: cannot tell")
    configuration = replace(configuration, parameters=parameters)
    (folder / "knee").mkdir(exist_ok=True)
    result = sigmahat.estimate(log, configuration, folder / "knee")
    low, high = result.sigma_range
    print(f"stiffness in the second half: {low:.1f} to {high:.1f} N.m/rad, see {folder / 'knee'}")
    true = joint.plant["sigma"][len(joint.t) // 2 :]
    print(f"the true one: {true.min():.1f} to {true.max():.1f} N.m/rad")


if __name__ == "__main__":
    main(Path(sys.argv[1] if len(sys.argv) > 1 else "."))
