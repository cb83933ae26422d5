"""Runs of a plant FMU under given torques."""

from collections.abc import Iterable, Mapping, Sequence
from functools import partial

import numpy as np
from numpy.typing import NDArray

import sigmahat
from sigmahat.fmi.instance import Fmu, Slave
from sigmahat.fmi.sample_loop import Recorder, SampleLoop, step_times

Array = NDArray[np.float64]

INPUTS = ("tau", "tau_c", "tau_ext")
STATES = ("q", "theta", "theta_c", "q_dot", "theta_dot", "theta_c_dot")
QUIET = {"noise.tau_variance": 0.0, "noise.tau_e_variance": 0.0}


def run_plant(
    name: str,
    inputs: Sequence[str],
    h: float,
    torques: Array,
    start: Mapping[str, float] | None = None,
    record: Iterable[str] = (),
    *,
    held: bool = False,
    t: Array | None = None,
) -> dict[str, Array]:
    """A plant in communication steps of h [s] under torques [size: steps + 1 x inputs].

    Torques are linear from one row to the next, or each is held until the next. The steps begin at
    multiples of h, or at the times t of the rows. Returns each recorded variable [size: steps + 1].
    """
    steps = len(torques) - 1
    slopes = np.zeros_like(torques) if held else np.diff(torques, axis=0, append=0.0) / h
    t = times(h, steps * h) if t is None else t
    with Fmu(sigmahat.fmu(name)) as fmu, Slave(fmu, "plant") as plant:
        references = fmu.references(inputs, "input")
        first = dict(zip(inputs, torques[0].tolist(), strict=True))
        plant.initialize({**first, **(start or {})})
        recorder = Recorder(plant, record, steps + 1)
        outputs = SampleLoop()
        recorder.add_to(outputs)
        loop = SampleLoop(outputs)
        loop.set_real(plant, references, np.ascontiguousarray(torques))
        loop.set_slopes(plant, references, np.ascontiguousarray(slopes))
        loop.step(plant, step_times(t, h))
        loop.run(0, steps)
        outputs.run(steps, steps + 1)
    return recorder.columns()


run_awas = partial(run_plant, "AwasPlant", INPUTS)


def times(h: float, duration: float) -> Array:
    """0, h, 2 h, ..., duration [size: duration / h + 1]."""
    return h * np.arange(round(duration / h) + 1, dtype=np.float64)


def sinusoids(
    t: Array, tau: tuple[float, float], tau_c: tuple[float, float], tau_ext: tuple[float, float]
) -> Array:
    """Torques [size: p x 3] at times t, each given by its amplitude [N.m] and frequency [Hz]."""
    return np.column_stack([A * np.sin(2 * np.pi * f * t) for A, f in (tau, tau_c, tau_ext)])


def relative_error(run: Mapping[str, Array], reference: Array) -> Array:
    """Returns the largest error of each state, relative to the range of the state.

    The run has the states of the reference [size: p x states] first, in the same order.
    """
    states = np.column_stack(list(run.values())[: reference.shape[1]])
    error: Array = np.abs(states - reference).max(axis=0) / np.ptp(reference, axis=0)
    return error
