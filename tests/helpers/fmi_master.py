"""A simple master for AwasPlant and StiffnessEstimator of the scenario table1."""

from collections.abc import Iterable, Mapping

import numpy as np
from numpy.typing import NDArray

import sigmahat
from fmi_instance import OK, Instance
from sigmahat.paper.scenarios import scenario
from sigmahat.runs.scenario import T

_PLANT = scenario("table1").plant
_START = {name: float(value) for name, value in _PLANT.start.items()}
_CONNECTIONS = scenario("table1").estimators["RESIDUAL"].connections


def torques(t: NDArray[np.float64]) -> NDArray[np.float64]:
    """tau and tau_c of the scenario at the times t [s], shape (len(t), 2) [N.m]."""
    return np.column_stack([signal(t) for signal in _PLANT.inputs.values()])


def run(
    torques: NDArray[np.float64],
    times: Iterable[float],
    start: Mapping[str, float] | None = None,
    *,
    zeros_first: bool = False,
) -> dict[str, NDArray[np.float64]]:
    """Stiffness of the plant at each time, and of the estimator after its step from that time.

    `torques` are those at the times, and held over a step. `start` are start values of the plant
    besides those of the scenario. If `zeros_first`, the first inputs of the estimator are 0.
    """
    sigma: dict[str, list[float]] = {"plant.sigma": [], "estimator.sigma": []}
    with (
        Instance(sigmahat.fmu("AwasPlant")) as plant,
        Instance(sigmahat.fmu("StiffnessEstimator")) as estimator,
    ):
        plant.initialise({**_START, **(start or {})})
        estimator.initialise()
        for k, t in enumerate(times):
            sigma["plant.sigma"].append(plant.get("sigma"))
            measured = np.array(plant.get_all(list(_CONNECTIONS.values())))
            measured = 0 * measured if zeros_first and k == 0 else measured
            estimator.set_all(dict(zip(_CONNECTIONS, measured, strict=True)))
            assert estimator.step(t, T) == OK
            sigma["estimator.sigma"].append(estimator.get("sigma"))
            plant.set_all(dict(zip(_PLANT.inputs, torques[k], strict=True)))
            assert plant.step(t, T) == OK
    return {name: np.array(values) for name, values in sigma.items()}
