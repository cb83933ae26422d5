"""Runs the plant of an experiment of the misfit study; gives measured and true values."""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sigmahat.fmi.instance import Slave, installed
from sigmahat.fmi.sample_loop import Recorder, SampleLoop, step_times
from sigmahat.studies.misfit_experiment import DRIFT_TIME, Control, Experiment, TorqueHold

Array = NDArray[np.float64]

PLANT = "RealJointPlant"
_RECORD = ("theta_measured", "q_measured", "tau_measured", "phi", "sigma")
_LEAD = 0.0025 / (2 * math.pi)  # lead of the ball screw of the AwAS [m/rad]
_RETRACTED = 0.1  # lever arm at theta_c = 0 [m]
_COUNT = 2 * math.pi / 1024  # count of the encoder of theta_c [rad]
_LOW_PASS = 200.0  # low pass of the velocities of a control [rad/s]
_LARGEST_JITTER = 0.49  # of a period
_SHORTEST = 1.0 - 2 * _LARGEST_JITTER  # time between two samples, in periods
_MARGIN = 0.1  # a measured torque may be late or early by at most this time [s]


@dataclass(frozen=True)
class Motion:
    """Samples of a run, each array of shape (N,), at t = k T but for jitter."""

    measured: Mapping[str, Array]  # inputs of StiffnessEstimator by name
    sigma: Array  # true stiffness [N.m/rad]; 0 in the dead zone of the spring
    phi: Array  # true deformation [rad]


def run(experiment: Experiment) -> Motion:
    """Runs the plant. Raises FileNotFoundError without its FMU, FmuError if the FMU refuses."""
    held = experiment.control is not None or experiment.hold is not TorqueHold.LINEAR
    ticks = _ticks(experiment, 0, round(experiment.duration / experiment.T))
    t = _sample_times(experiment, ticks)
    inputs = {"tau": _torque(experiment, ticks if held else t)}
    inputs["tau_ext"] = np.full_like(t, experiment.load)
    if experiment.lever_arm is not None:
        inputs["r"] = experiment.lever_arm(t)
    ramp = np.minimum(t / DRIFT_TIME, 1.0)
    inputs |= {name: change * ramp for name, change in experiment.drift.items()}
    first = 0.0 if held else float(inputs["tau"][0])
    table = np.column_stack(list(inputs.values()))
    with Slave(installed(PLANT), "plant") as plant:
        start = {name: float(values[0]) for name, values in inputs.items()}
        plant.initialize({**_start(experiment), **start, "tau": first})
        control = _controller(experiment.control, ticks, experiment.T)
        columns = _step(plant, list(inputs), table, t, held, control)
    tau = table[:, 0]
    acting = np.concatenate([[first], tau[:-1]]) if held else tau
    gain = experiment.plant.get("sensor.tau_gain", 1.0)
    columns["tau_measured"] += (_read(experiment, t, tau) - acting) / gain
    theta_c = np.zeros(len(t))  # angle of the secondary motor by its encoder
    if "r" in inputs:
        theta_c = _COUNT * np.floor((_RETRACTED - inputs["r"]) / _LEAD / _COUNT + 0.5)
    measured = {name: columns[f"{name}_measured"] for name in ("theta", "q", "tau")}
    return Motion({**measured, "theta_c": theta_c}, columns["sigma"], columns["phi"])


def peak_deformation(experiment: Experiment) -> float:
    """Computes the largest |phi| of the experiment [rad]."""
    return float(np.abs(run(experiment).phi).max())


def _ticks(experiment: Experiment, first: int, end: int) -> Array:
    """k T [s] for k from first to end - 1."""
    return experiment.T * np.arange(first, end, dtype=np.float64)


def _sample_times(experiment: Experiment, ticks: Array) -> Array:
    """Adds jitter to the sample times [s]; jitter is less than half a period, so times increase."""
    rng = np.random.default_rng(experiment.seed)
    off = experiment.jitter * rng.standard_normal(len(ticks))
    off = np.clip(off, -_LARGEST_JITTER, _LARGEST_JITTER)
    off[0] = 0.0
    return ticks + experiment.T * off


def _torque(experiment: Experiment, t: Array) -> Array:
    """Computes the torque command at t [N.m], linear between the sample times k T."""
    if experiment.control is not None:
        return np.zeros_like(t)
    around = math.ceil(_MARGIN / experiment.T)
    steps = round(experiment.duration / experiment.T)
    nodes = _ticks(experiment, -around, steps + around)
    command = experiment.torque(nodes - experiment.rest) * (nodes >= experiment.rest)
    return np.interp(t, nodes, command)


def _start(experiment: Experiment) -> dict[str, float | int]:
    """Computes start values: at rest, with the spring deformed by load and weight."""
    control = experiment.control
    theta = float(control.reference(np.zeros(1))[0]) if control else 0.0
    weight = experiment.plant.get("link.mgl", 0.0) * math.sin(theta)
    return {
        **experiment.plant,
        "initial.theta": theta,
        "initial.q": theta + (experiment.load - weight) / experiment.stiffness,
        "noise.seed": experiment.seed,
        # With jitter, two samples may fall into one period; each sample has its own noise.
        "noise.samplePeriod": experiment.T * (_SHORTEST if experiment.jitter else 1.0),
    }


def _step(
    plant: Slave,
    names: list[str],
    table: Array,
    t: Array,
    held: bool,
    control: Callable[[int, float, float], float] | None,
) -> dict[str, Array]:
    """Steps the plant to all times t [s] under the inputs of the table, torque first.

    The inputs are linear from row to row, but the torque is held if `held`. A control writes its
    torque into the table. Returns the recorded columns.
    """
    inputs = plant.fmu.references(names, "input")
    h = np.diff(t)
    slopes = np.diff(table, axis=0) / h[:, None]
    if held:
        slopes[:, 0] = 0.0
    recorder, angles = Recorder(plant, _RECORD, len(t)), np.empty(2)
    read, step = SampleLoop(), SampleLoop()
    recorder.add_to(read)
    read.get(plant, "Real", plant.fmu.references(_RECORD[:2], "output"), angles)
    step.set_real(plant, inputs, table)
    step.set_slopes(plant, inputs, slopes)
    step.step(plant, step_times(t[:-1], h))
    if control is None:
        SampleLoop(read, step).run(0, len(h))
    else:
        for k in range(len(h)):
            read.run(k, k + 1)
            table[k, 0] = control(k, *angles.tolist())
            step.run(k, k + 1)
    read.run(len(h), len(t))
    if control is not None:
        table[-1, 0] = control(len(h), *angles.tolist())
    return recorder.columns()


def _controller(
    control: Control | None, ticks: Array, T: float
) -> Callable[[int, float, float], float] | None:
    """The torque [N.m] of a control for sample k, from the measured theta and q [rad]."""
    if control is None:
        return None
    wanted: list[float] = control.reference(ticks).tolist()
    share = -math.expm1(-_LOW_PASS * T)
    before: list[float] = []
    velocity = [0.0, 0.0]

    def torque(k: int, theta: float, q: float) -> float:
        for i, angle in enumerate((theta, q)):
            if before:
                velocity[i] += share * ((angle - before[i]) / T - velocity[i])
        before[:] = theta, q
        feedback = control.kd * velocity[0] + control.kq * velocity[1]
        return control.kp * (wanted[k] - theta) - feedback

    return torque


def _read(experiment: Experiment, t: Array, tau: Array) -> Array:
    """The torque that the drive reports at the times t [N.m]: without gain, bias and noise.

    tau  torque at the samples; a held torque acts from each sample on
    """
    if experiment.hold is TorqueHold.LINEAR:
        return _torque(experiment, t - experiment.late)
    if experiment.hold is TorqueHold.HELD:
        return tau
    mean: Array = (tau + np.concatenate([[0.0], tau[:-1]])) / 2
    return mean
