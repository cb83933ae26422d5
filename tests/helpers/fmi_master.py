"""A simple master for AwasPlant and StiffnessEstimator of the scenario table1.

The differences between masters are arguments of `run`; the FMI calls are the same.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping

import numpy as np
from fmpy import fmi2
from numpy.typing import NDArray

import sigmahat
from sigmahat.fmi.instance import Fmu, Slave
from sigmahat.paper.scenarios import scenario
from sigmahat.runs.scenario import T

_TABLE1 = scenario("table1")
_RESIDUAL = _TABLE1.estimators["RESIDUAL"]


def torques(t: NDArray[np.float64]) -> NDArray[np.float64]:
    """tau and tau_c of the scenario at the times t [s], shape (len(t), 2) [N.m]."""
    return np.column_stack([signal(t) for signal in _TABLE1.plant.inputs.values()])


def run(
    torques: NDArray[np.float64],
    *,
    linear: bool,
    times: Iterable[float],
    start: Mapping[str, float] | None = None,
    zeros_first: bool = False,
) -> dict[str, NDArray[np.float64]]:
    """Stiffness of the plant at each time, and of the estimator after its step from that time.

    `torques` are those at the times; if `linear`, they are linear over a step, else held. `start`
    are start values of the plant besides those of the scenario. If `zeros_first`, every value is
    passed along a connection at the end of a step, and the first inputs of the estimator are 0.
    """
    times = list(times)
    sigma: dict[str, list[float]] = {"plant.sigma": [], "estimator.sigma": []}
    with (
        Fmu(sigmahat.fmu("AwasPlant")) as of_plant,
        Fmu(sigmahat.fmu("StiffnessEstimator")) as of_estimator,
        Slave(of_plant, "plant") as plant,
        Slave(of_estimator, "estimator") as estimator,
    ):
        plant.initialize({**_TABLE1.plant.start, **(start or {})})
        estimator.initialize(_RESIDUAL.start)
        for k, t in enumerate(times):
            *measured, truth = _get(plant, [*_RESIDUAL.connections.values(), "sigma"])
            _set(
                estimator,
                _RESIDUAL.connections,
                np.multiply(measured, not (zeros_first and k == 0)),
            )
            _step(estimator, t)
            sigma["estimator.sigma"] += _get(estimator, ["sigma"])
            sigma["plant.sigma"].append(truth)
            _set(plant, _TABLE1.plant.inputs, torques[k])
            if linear and k + 1 < len(times):
                slopes = (torques[k + 1] - torques[k]) / (times[k + 1] - t)
                _set_slopes(plant, _TABLE1.plant.inputs, slopes)
            _step(plant, t)
    return {name: np.array(values) for name, values in sigma.items()}


def _get(slave: Slave, names: list[str]) -> list[float]:
    values = (fmi2.fmi2Real * len(names))()
    slave.call(slave.fmi.fmi2GetReal, slave.fmu.references(names), len(names), values)
    return list(values)


def _set(slave: Slave, names: Iterable[str], values: NDArray[np.float64]) -> None:
    array = (fmi2.fmi2Real * len(values))(*values)
    slave.call(slave.fmi.fmi2SetReal, slave.fmu.references(names), len(values), array)


def _set_slopes(slave: Slave, names: Iterable[str], slopes: NDArray[np.float64]) -> None:
    count = len(slopes)
    orders, array = (fmi2.fmi2Integer * count)(*[1] * count), (fmi2.fmi2Real * count)(*slopes)
    references = slave.fmu.references(names)
    slave.call(slave.fmi.fmi2SetRealInputDerivatives, references, count, orders, array)


def _step(slave: Slave, t: float) -> None:
    slave.call(slave.fmi.fmi2DoStep, t, T, fmi2.fmi2True)
