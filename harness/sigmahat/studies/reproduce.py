"""The plan of `sigmahat reproduce`: one scenario of the paper over seeds, with its figures."""

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from functools import cached_property, partial
from pathlib import Path

from sigmahat.experiments.job import Job, Outcome
from sigmahat.experiments.metrics import Indices
from sigmahat.experiments.scenario import Scenario
from sigmahat.experiments.simulation import indices_by_comparison, run
from sigmahat.paper.figures import FIGURES
from sigmahat.show.panel import FigureRows
from sigmahat.studies import reproduce_results
from sigmahat.studies.reproduce_results import Reproduced


def reproduced_run(scenario: Scenario, seed: int, with_recording: bool) -> Outcome:
    """Does one run of the plan; the run with a recording also has the variants for the figures.

    Raises what simulate() raises.
    """
    recording = run(scenario, seed, variants=with_recording)
    indices = indices_by_comparison(scenario, recording)
    return Outcome(
        {comparison: asdict(of_comparison) for comparison, of_comparison in indices.items()},
        recording=recording if with_recording else None,
    )


@dataclass(frozen=True)
class Reproduction:
    """The plan: the scenario with each seed of the plant's noise."""

    scenario: Scenario
    seeds: Sequence[int]  # one or more

    name = "reproduce"

    @cached_property
    def jobs(self) -> list[Job]:
        return [
            Job(
                partial(reproduced_run, self.scenario, seed, with_recording=seed == self.seeds[0]),
                fmus=tuple(self.scenario.fmus),
                about=("reproduce", repr(self.scenario), seed),
            )
            for seed in self.seeds
        ]

    def table(self, outcomes: Sequence[Outcome]) -> Reproduced:
        recording = outcomes[0].recording
        assert recording is not None  # an outcome with a recording is in no record
        indices = [
            {comparison: Indices(**numbers) for comparison, numbers in outcome.rows.items()}
            for outcome in outcomes
        ]
        return Reproduced(self.scenario, self.seeds, recording, indices)

    def write(self, table: Reproduced, folder: Path) -> None:
        reproduce_results.write(table, folder)

    def figures(self, table: Reproduced) -> dict[str, FigureRows]:
        return {name: FIGURES[name](table.recording) for name in self.scenario.figures}

    def text(self, table: Reproduced) -> str:
        return reproduce_results.text(table)

    def values(self, table: Reproduced) -> object:
        return reproduce_results.values(table)
