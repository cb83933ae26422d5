"""Simulation runs that several tests use; each run is made once."""

from functools import cache

from sigmahat.experiments.engine import computed_table
from sigmahat.paper.scenarios import scenario
from sigmahat.studies.reproduce import Reproduction
from sigmahat.studies.reproduce_results import Reproduced


@cache
def one_seed(name: str) -> Reproduced:
    """A scenario with seed 1."""
    return computed_table(Reproduction(scenario(name), [1]))


@cache
def eight_seeds(name: str) -> Reproduced:
    """A scenario with seeds 1 to 8."""
    return computed_table(Reproduction(scenario(name), range(1, 9)), processes=2)
