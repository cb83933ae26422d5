"""Writes a motion as files: CSV, a trajectory for ROS, and C code that computes the motion."""

from pathlib import Path

import numpy as np

from sigmahat.files.escape import yaml_string
from sigmahat.files.output import write_whole
from sigmahat.files.tables import write_csv
from sigmahat.motion.joints_of_log import Multisine

_ROS_PERIOD = 0.01  # [s]
FILES = ("motion.csv", "motion.yaml", "motion.c")  # names of the files


def write(motion: Multisine, joint: str, start: float, T: float, folder: Path) -> None:
    """Writes FILES.

    joint  name of the joint in ROS
    start  start position of the motor at the gear output [rad]
    T      time between the rows of the CSV [s]
    """
    t = motion.times(T)
    position, velocity, acceleration = motion.at(t)
    titles = ["time [s]", "position [rad]", "velocity [rad/s]", "acceleration [rad/s2]"]
    rows = zip(t, start + position, velocity, acceleration, strict=True)
    write_csv(folder / FILES[0], titles, rows)
    write_whole(_ros(motion, joint, start), folder / FILES[1])
    write_whole(_c(motion, start), folder / FILES[2])


def _ros(motion: Multisine, joint: str, start: float) -> str:
    """A trajectory_msgs/JointTrajectory, as `ros2 topic pub` and controllers read it."""
    t, name = motion.times(_ROS_PERIOD), yaml_string(joint)
    lines = ["# trajectory_msgs/msg/JointTrajectory", f"joint_names: [{name}]", "points:"]
    for now, *point in zip(t.tolist(), *(each.tolist() for each in motion.at(t)), strict=True):
        point[0] += start
        values = zip(("positions", "velocities", "accelerations"), point, strict=True)
        text = ", ".join(f"{name}: [{value:.9g}]" for name, value in values)
        seconds, rest = divmod(round(now * 1e9), 10**9)
        lines.append(f"- {{{text}, time_from_start: {{sec: {seconds}, nanosec: {rest}}}}}")
    return "\n".join([*lines, ""])


def _c(motion: Multisine, start: float) -> str:
    """Formats the motion as C99 code with the formulas of Multisine."""
    sines = ", ".join(
        f"{{{A!r}, {2 * np.pi * f!r}, {p!r}}}"
        for A, f, p in zip(motion.amplitudes, motion.frequencies, motion.phases, strict=True)
    )
    return f"""\
/* A motion that shows the stiffness of a joint; it begins and ends at rest. By sigmahat motion. */
#include <math.h>

#define MOTION_DURATION {motion.duration!r} /* [s] */

/*
 * Position [rad], velocity [rad/s] and acceleration [rad/s2] of the motor at its gear
 * output, t seconds after the start. Before 0 and after MOTION_DURATION, the joint is at rest.
 */
void motion(double t, double *position, double *velocity, double *acceleration)
{{
    static const double sines[{len(motion.amplitudes)}][3] = {{ /* amplitude, rad/s, phase */
        {sines}}};
    const double ramp = {motion.ramp!r}, half = MOTION_DURATION / 2.0;
    const double side = t < half ? 1.0 : -1.0;
    const double s = fmin(fmax((t < half ? t : MOTION_DURATION - t) / ramp, 0.0), 1.0);
    const double e = s * s * s * s * (35.0 + s * (-84.0 + s * (70.0 - 20.0 * s)));
    const double u = s * (1.0 - s);
    const double de = 140.0 * u * u * u * side / ramp;
    const double dde = 420.0 * u * u * (1.0 - 2.0 * s) / (ramp * ramp);
    double x = 0.0, v = 0.0, a = 0.0;
    for (int i = 0; i < {len(motion.amplitudes)}; i++) {{
        const double w = sines[i][1], angle = w * t + sines[i][2];
        x += sines[i][0] * sin(angle);
        v += sines[i][0] * w * cos(angle);
        a -= sines[i][0] * w * w * sin(angle);
    }}
    *position = {start!r} + e * x;
    *velocity = de * x + e * v;
    *acceleration = dde * x + 2.0 * de * v + e * a;
}}
"""
