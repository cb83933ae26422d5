"""All scenarios of `sigmahat reproduce`, by name."""

from __future__ import annotations

from sigmahat.fmi.unknown_name import unknown
from sigmahat.paper.awas import experiment, simulation
from sigmahat.paper.transmissions import antagonistic, single
from sigmahat.runs.scenario import Scenario

SCENARIOS = {
    s.name: s
    for s in (
        simulation(
            "table1",
            "AwAS from r(0) = 70 mm for 15 s: the conditions that give Table I",
            duration=15.0,
            retraction=0.030,
            start={},
        ),
        simulation(
            "as-printed",
            "AwAS from r(0) = 130 mm for 20 s, velocity weighting as printed in (11)",
            duration=20.0,
            retraction=-0.030,
            start={"filter.weighting": "AsPrinted"},
        ),
        experiment(),
        *(single(k_3, frequency) for frequency in (0.5, 2.0, 4.0) for k_3 in (0.0, 3000.0)),
        antagonistic(),
    )
}
"""All scenarios by name."""


def scenario(name: str) -> Scenario:
    """Returns the scenario of that name. Raises ValueError if there is none."""
    if name not in SCENARIOS:
        raise ValueError(unknown("scenario", name, SCENARIOS))
    return SCENARIOS[name]
