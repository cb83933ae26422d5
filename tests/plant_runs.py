"""Runs of a plant FMU under given torques."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np
from fmpy import fmi2
from numpy.typing import NDArray

import sigmahat
from sigmahat.slave import Fmu, Recorder, Slave

Array = NDArray[np.float64]

INPUTS = ("tau", "tau_c", "tau_ext")
STATES = ("q", "theta", "theta_c", "q_dot", "theta_dot", "theta_c_dot")
QUIET = {"noise.tau_variance": 0.0, "noise.tau_e_variance": 0.0}


def run_awas(
    h: float,
    torques: Array,
    start: Mapping[str, float] | None = None,
    record: Iterable[str] = STATES,
    *,
    held: bool = False,
) -> dict[str, Array]:
    """AwasPlant in communication steps of h [s] under torques [size: steps + 1 x 3].

    Torques are linear from one row to the next, or each is held until the next. Gives each
    recorded variable [size: steps + 1].
    """
    steps = len(torques) - 1
    slopes = np.zeros_like(torques) if held else np.diff(torques, axis=0, append=0.0) / h
    values_c, slopes_c = (
        np.ctypeslib.as_ctypes(np.ascontiguousarray(a)) for a in (torques, slopes)
    )
    orders = (fmi2.fmi2Integer * 3)(1, 1, 1)
    with Fmu(sigmahat.fmu("AwasPlant")) as fmu, Slave(fmu, "plant") as plant:
        references = fmu.references(INPUTS, "input")
        fmi: Any = plant.fmi
        first = dict(zip(INPUTS, torques[0].tolist(), strict=True))
        plant.initialize({**first, **(start or {})})
        recorder = Recorder(plant, record, steps + 1)
        recorder.sample(0)
        for k in range(steps):
            plant.call(fmi.fmi2SetReal, references, 3, values_c[k])
            plant.call(fmi.fmi2SetRealInputDerivatives, references, 3, orders, slopes_c[k])
            plant.call(fmi.fmi2DoStep, k * h, h, fmi2.fmi2True)
            recorder.sample(k + 1)
    return recorder.columns()


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
