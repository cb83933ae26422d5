"""Simulation runs that several tests use; each run is made once."""

from functools import cache

from sigmahat.paper.reproduction import Result, reproduce
from sigmahat.paper.scenarios import scenario


@cache
def one_seed(name: str) -> Result:
    """A scenario with seed 1."""
    return reproduce(scenario(name), [1])


@cache
def eight_seeds(name: str) -> Result:
    """A scenario with seeds 1 to 8."""
    return reproduce(scenario(name), range(1, 9), processes=2)
