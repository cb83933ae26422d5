"""Simulated twins of the runs of an industrial robot: how often the interval holds the stiffness.

    python tests/studies/twins.py NUMBER

A twin has the motion of a run of docs/robot.md (axes 3 and 2), and a stiffness, an inertia, a
friction, a zero and a delay between the encoders that are drawn. What the fitted model of the run
leaves over is added again, with its spectrum but other phases: below 2 Hz to the torque, above to
the deformation. Prints how often the 95 % interval of `sigmahat identify` and `estimate` at the end
of a twin holds its stiffness.
"""

from __future__ import annotations

import sys
import tempfile
from collections.abc import Mapping
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np
import pyarrow.csv

import robot
from sigmahat.fmi.installed import fmu as installed_fmu
from sigmahat.fmi.instance import Fmu, Slave
from sigmahat.identification.identify import identify
from sigmahat.identification.noise import low_pass
from sigmahat.identification.write import write
from sigmahat.logs.configuration import read_configuration
from sigmahat.logs.log import Array, LogInMemory
from sigmahat.logs.replay import parameters, replay
from sigmahat.logs.sampling import sample
from sigmahat.runs.engine import run_all

T = 4e-3  # [s]
LOW = 2.0  # [Hz] above it the deformation of the robot is noise
STIFFNESS = {3: 5e6, 2: 7.5e6}  # [N.m/rad]
D_THETA, V_S = 0.03, 0.01  # viscous friction [N.m.s/rad]; where Coulomb friction reverses [rad/s]
SPREAD = {"stiffness": 0.3, "inertia": 0.03, "friction": 0.3}  # of the logarithms


@dataclass(frozen=True)
class Fitted:
    """The model of a run, and what it leaves over."""

    theta: Array
    """Motion of the motor without noise [rad]."""
    coulomb: float
    """Friction behind the gear [N.m]."""
    tau_e: Array
    """Torque of the spring below 2 Hz, with the sign of the deformation [N.m]."""
    torque: Array
    """What is left of the torque below 2 Hz [N.m]."""
    deformation: Array
    """What is left of the deformation above 2 Hz [rad]."""


def motor_torque(axis: int, theta: Array, B: float, coulomb: float, friction: float) -> Array:
    """Inertia and friction behind the gear [N.m]."""
    gear = robot.GEAR_RATIO[axis]
    v = np.gradient(theta, T)
    of_friction = D_THETA * v * gear**2 + coulomb * np.tanh(v / V_S)
    return B * gear**2 * np.gradient(v, T) + friction * of_friction


def fitted(axis: int, run: str) -> Fitted:
    """Least squares of the motor equation below 2 Hz."""
    table = pyarrow.csv.read_csv(robot.folder() / f"kr300_{run}.csv")
    columns = ("motor_deg", "link_deg", "motor_torque_Nm")
    motor, link, tau = (table[f"a{axis}_{name}"].to_numpy() for name in columns)
    motor, phi = np.radians(motor), np.radians(link - motor)
    theta = low_pass(motor, 25.0, T)
    v = np.gradient(theta, T)
    drive = robot.GEAR_RATIO[axis] * tau - motor_torque(axis, theta, robot.INERTIA[axis], 0.0, 1.0)
    X = low_pass(np.column_stack([np.tanh(v / V_S), v, np.ones_like(v), phi]), LOW, T)
    coulomb, apparent, constant, of_phi = np.linalg.lstsq(X, low_pass(drive, LOW, T), rcond=None)[0]
    # The apparent viscous friction is the delay of the encoders.
    spring = -low_pass(drive - coulomb * np.tanh(v / V_S) - apparent * v - constant, LOW, T)
    return Fitted(theta, coulomb, spring, spring + of_phi * X[:, 3], phi - X[:, 3])


def other_phases(signal: Array, rng: np.random.Generator) -> Array:
    """A signal of the same spectrum."""
    spectrum = np.fft.rfft(signal)
    turned = np.abs(spectrum) * np.exp(2j * np.pi * rng.uniform(size=len(spectrum)))
    return np.fft.irfft(turned, len(signal))


def twin(axis: int, run: str, seed: int) -> tuple[Mapping[str, Array], float]:
    """Columns as in the data, and the true stiffness."""
    rng = np.random.default_rng([axis, ord(run), seed])
    factor = {name: float(np.exp(s * rng.standard_normal())) for name, s in SPREAD.items()}
    of, stiffness = fitted(axis, run), STIFFNESS[axis] * factor["stiffness"]
    B = robot.INERTIA[axis] * factor["inertia"]
    t = T * np.arange(len(of.theta))
    torque = motor_torque(axis, of.theta, B, of.coulomb, factor["friction"]) - of.tau_e
    torque += other_phases(of.torque, rng) + 100.0 * rng.standard_normal(len(t))
    link = of.theta + of.tau_e / stiffness
    late, zero = rng.uniform(2e-3, 3.5e-3), rng.normal(0.0, 1.5e-3)
    q = np.interp(t - late, t, link) + zero + other_phases(of.deformation, rng)
    theta = of.theta + 8e-7 * rng.standard_normal(len(t))
    columns = {
        "time_s": t,
        f"a{axis}_motor_deg": np.degrees(theta),
        f"a{axis}_link_deg": np.degrees(q),
        f"a{axis}_motor_torque_Nm": torque / robot.GEAR_RATIO[axis],
    }
    return columns, stiffness


def judged(number: int) -> tuple[float, float]:
    """Estimate and half of its interval, both over the true stiffness."""
    axis, run = ((3, "a"), (3, "b"), (2, "a"), (2, "b"))[number % 4]
    columns, stiffness = twin(axis, run, number)
    log = LogInMemory(Path("twin"), dict(columns))
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "twin.toml"
        text = robot.CONFIGURATION.format(
            axis=axis, gear=robot.GEAR_RATIO[axis], inertia=robot.INERTIA[axis]
        )
        path.write_text(text)
        write(identify(log, read_configuration(path)), path)
        configuration = read_configuration(path)
    with Fmu(installed_fmu("StiffnessEstimator")) as fmu, Slave(fmu, "twin") as slave:
        samples = sample(log, configuration, T)
        start = parameters(fmu, configuration)
        (found,) = replay(slave, samples, start, len(samples.values))
    sigma, std = (float(found[name][-1]) for name in ("sigma", "sigma_std"))
    return sigma / stiffness, 1.96 * std / stiffness


def main(number: int) -> None:
    """Prints the shares, apart for both axes."""
    results = np.array(run_all([partial(judged, each) for each in range(number)]))
    for axis, first in ((3, 0), (2, 2)):
        of_axis = np.concatenate([results[first::4], results[first + 1 :: 4]])
        value, half = of_axis.T
        print(
            f"axis {axis}: the interval holds the stiffness in {np.sum(abs(value - 1) <= half)} "
            f"of {len(value)}; median error {100 * np.median(abs(value - 1)):.0f} %, "
            f"half width {100 * np.median(half / value):.0f} % of the estimate"
        )


if __name__ == "__main__":
    main(int(sys.argv[1]))
