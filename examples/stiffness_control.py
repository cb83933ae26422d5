"""Stiffness control of the AwAS: its second motor moves the lever arm until the estimated stiffness
is the one wanted.

The springs of this AwAS are 15 % softer than their data sheet says. Once the loop is closed with
the estimate, once with the stiffness (29) after the data sheet. While the estimate is not
confident, the last confident correction of the data sheet is used instead of it.

Usage: python stiffness_control.py [FOLDER]     writes stiffness_control.png there
"""

import math
import sys
from pathlib import Path
from typing import Any

import fmpy
import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

import sigmahat

T, DURATION = 1e-3, 45.0  # [s]
K_S, R_0, LEAD = 14220.0, 0.1, 0.0025 / (2 * math.pi)  # data sheet [N/m, m, m/rad]
MOTION = {"signal.tau.amplitude": 0.3, "signal.tau.frequency": 0.5}  # without it no estimate
START = 2.0  # until then the lever arm rests and the estimate settles [s]
GAIN = 20.0  # tau_c for an error of one in the square root of the stiffness
LARGEST = 8.0  # largest tau_c, as in the paper [N.m]: 50 N.m/rad in a second


def wanted(t: float) -> float:
    """Stiffness that is wanted [N.m/rad]."""
    if t < 20:
        return (200.0, 320.0, 150.0)[min(int(t / 7), 2)]
    return 235.0 + 85.0 * math.sin(2 * math.pi * 0.05 * (t - 20))


def run(with_estimate: bool) -> NDArray[np.float64]:
    """One run. Columns: t [s]; commanded, true and estimated stiffness [N.m/rad]; tau_c [N.m]."""
    plant: Any = sigmahat.fmu("AwasPlant")
    references = {
        v.name: v.valueReference for v in fmpy.read_model_description(plant).modelVariables
    }
    inputs = ("theta_measured", "q_measured", "tau_measured", "theta_c_measured")
    measured = [references[name] for name in (*inputs, "sigma")]
    # The torque is exact here, but for noise: no gain error.
    estimator = sigmahat.Estimator(
        {"method": "FilteredRegression", "rls.n": 3, "prior.torque_gain": 0.0}
    )
    correction = 1.0  # factor for the data sheet, from the last confident estimate
    rows = []

    def control(t: float, recorder: Any) -> bool:
        """After each step of the plant: estimates, and sets the torque for the next one."""
        nonlocal correction
        theta, q, tau, theta_c, true = recorder.fmu.getReal(measured)
        found = estimator.tick(theta, q, tau, theta_c)
        nominal = 2 * K_S * (R_0 - LEAD * theta_c) ** 2 * math.cos(2 * (q - theta))  # (29)
        if found["confident"]:
            correction = found["sigma"] / nominal
        used = correction * nominal if with_estimate else nominal
        # The square root of the stiffness is linear in the lever arm, and the velocity of the
        # motor nearly in its torque: with a proportional controller the error decays like
        # exp(-4 t), wherever the lever arm is. A positive torque shortens it.
        tau_c = 0.0
        if t >= START:
            error = math.sqrt(wanted(t)) - math.sqrt(max(used, 0.0))
            tau_c = min(max(-GAIN * error, -LARGEST), LARGEST)
        recorder.fmu.setReal([references["tau_c"]], [tau_c])
        rows.append((t, wanted(t), true, found["sigma"], tau_c))
        return True

    start = {"spring.k_s": 0.85 * K_S, "initial.theta_c": 0.0, **MOTION}
    clock = {"stop_time": DURATION, "output_interval": T}
    fmpy.simulate_fmu(plant, start_values=start, output=["sigma"], step_finished=control, **clock)
    return np.array(rows)


def main(folder: Path) -> None:
    """Both runs, the error of each over the last period of the sine, and the picture."""
    figure = Figure(figsize=(8, 7), layout="constrained")
    above, middle, below = figure.subplots(3, 1, sharex=True, height_ratios=(2, 2, 1))
    for axes, title, with_estimate, color in (
        (above, "controlled with the estimate", True, "#0072B2"),
        (middle, "controlled with the data sheet, springs 15 % softer", False, "#D55E00"),
    ):
        t, reference, true, estimated, tau_c = run(with_estimate).T
        late = t >= DURATION - 20
        error = np.mean(np.abs(true - reference)[late] / reference[late])
        print(f"{title}: mean error of the true stiffness in the last 20 s {100 * error:.1f} %")
        axes.plot(t, reference, color="black", linewidth=0.8, linestyle=(0, (5, 2)), label="wanted")
        axes.plot(t, true, color="#aaaaaa", linewidth=3, label="true")
        axes.plot(t, estimated, color=color, linewidth=1, label="estimated")
        axes.axvspan(0, START, color="#eeeeee", zorder=0)
        axes.set(title=title, ylabel="stiffness [N·m/rad]", ylim=(0, 420))
        axes.legend(ncols=3, loc="lower right")
        below.plot(t, tau_c, color=color, linewidth=0.8)
    below.set(ylabel="torque $\\tau_c$ [N·m]", xlabel="time [s]")
    for axes in (above, middle, below):
        axes.grid(color="#dddddd")
    figure.savefig(folder / "stiffness_control.png", dpi=150)


if __name__ == "__main__":
    main(Path(sys.argv[1] if len(sys.argv) > 1 else "."))
