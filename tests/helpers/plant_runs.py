"""Runs of a plant FMU under given torques."""

from collections.abc import Iterable, Mapping, Sequence
from functools import partial

import numpy as np
from numpy.typing import NDArray

from sigmahat.fmi.master import Plant, Signal, simulate

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
) -> dict[str, Array]:
    """A plant in communication steps of h [s] under torques [size: steps + 1 x inputs].

    Torques are linear from one row to the next. Gives each recorded variable [size: steps + 1].
    """
    given: list[Signal] = [partial(_at, column) for column in torques.T]
    signals = dict(zip(inputs, given, strict=True))
    plant = Plant(name, start or {}, signals, list(record))
    return dict(simulate(plant, {}, h, len(torques) - 1).plant.values)


def _at(column: Array, t: Array) -> Array:
    return column


def run_awas(
    h: float,
    torques: Array,
    start: Mapping[str, float] | None = None,
    record: Iterable[str] = STATES,
) -> dict[str, Array]:
    """AwasPlant as in `run_plant`, torques in the order of INPUTS."""
    return run_plant("AwasPlant", INPUTS, h, torques, start, record)


def times(h: float, duration: float) -> Array:
    """0, h, 2 h, ..., duration [size: duration / h + 1]."""
    return h * np.arange(round(duration / h) + 1, dtype=np.float64)


def sinusoids(
    t: Array,
    tau: tuple[float, float],
    tau_c: tuple[float, float],
    tau_ext: tuple[float, float],
) -> Array:
    """Torques [size: p x 3] at times t, each given by its amplitude [N.m] and frequency [Hz]."""
    return np.column_stack([A * np.sin(2 * np.pi * f * t) for A, f in (tau, tau_c, tau_ext)])


def relative_error(run: Mapping[str, Array], reference: Array) -> Array:
    """Largest error of each state over its range.

    The run has the states of the reference [size: p x states] first, in the same order.
    """
    states = np.column_stack(list(run.values())[: reference.shape[1]])
    error: Array = np.abs(states - reference).max(axis=0) / np.ptp(reference, axis=0)
    return error
