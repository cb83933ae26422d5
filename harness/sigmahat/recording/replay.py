"""Replays the samples of a log through the estimator, tick by tick."""

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sigmahat.estimator.estimator import Estimator
from sigmahat.recording.configuration import INPUTS, Configuration
from sigmahat.recording.estimator_parameters import parameters
from sigmahat.recording.log import LogError
from sigmahat.recording.sampling import Samples

OUTPUTS = (
    *("sigma", "tau_e", "tau_e_residual", "theta_dot", "phi", "setPoint", "a", "rho", "epsilon"),
    *("sigma_std", "tau_e_std", "D_theta_hat", "B_hat", "tau_coulomb_hat", "misfit", "bias_hat"),
    *("damping_hat", "load_friction_hat", "eccentric_hat", "delay_hat", "hysteresis_hat"),
    *("change_age", "sigma_per_gain"),
)
"""Real outputs of the estimator that are recorded."""
FLAGS = ("confident", "valid")  # Boolean outputs that are recorded
RECORDED = (*OUTPUTS, "doubt", *FLAGS)
"""All outputs that are recorded: Reals, an enumeration, Booleans."""


def estimator_for(configuration: Configuration, record: Sequence[str] = RECORDED) -> Estimator:
    """Starts an estimator with the parameters of a configuration; `record` as for Estimator.

    The estimator does not warn of range.phi, which `sigmahat check` compares with the log.

    Raises LogError for a parameter that does not exist, or is out of its range.
    """
    given = parameters(configuration)
    try:
        return Estimator(given, record, warn_of_range=False)
    except ValueError as error:
        raise LogError(f"{configuration.path}: {error}") from error


def play(
    estimator: Estimator, samples: Samples, chunk: int
) -> Iterator[Mapping[str, NDArray[Any]]]:
    """Yields the recorded outputs of an estimator by name, for one chunk of ticks at a time.

    Ports without a configuration are 0.
    """
    for first in range(0, len(samples.values), chunk):
        values = samples.values[first : first + chunk]
        columns = dict(zip(samples.names, values.T, strict=True))
        missing = np.zeros(len(values))
        yield estimator.run(**{name: columns.get(name, missing) for name in INPUTS}).values
