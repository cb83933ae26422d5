"""The plan of `sigmahat sweep`: scenarios over seeds and parameters, a Monte Carlo study."""

from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace
from functools import cached_property, partial
from pathlib import Path

from sigmahat.experiments.job import Job, Outcome
from sigmahat.experiments.simulation import indices_by_comparison
from sigmahat.experiments.simulation import run as run_scenario
from sigmahat.fmi.instance import Slave, installed
from sigmahat.fmi.model import FmuError
from sigmahat.paper.scenarios import scenario
from sigmahat.show.panel import FigureRows
from sigmahat.studies import sweep_summary
from sigmahat.studies.sweep_grid import Grid, Run
from sigmahat.studies.sweep_panels import against_parameters, distributions
from sigmahat.studies.sweep_scenario import models, prepare
from sigmahat.studies.sweep_table import SweepTable, of_outcomes, write


def check(grid: Grid) -> None:
    """Initialises the FMUs of each scenario with each listed value, and first other values.

    Raises ValueError for a name or value that does not fit, FmuError if an FMU refuses a value.
    """
    for run in grid.samples():
        # A drawn value may be out of range in some runs: then the run fails, not the sweep.
        listed = {name: run.parameters[name] for name in grid.listed}
        starts = models(prepare(replace(run, parameters=listed)))
        for name, model in models(prepare(run)).items():
            fmu = installed(model.fmu)
            for parameter, value in model.start.items():
                fmu.variable(parameter, "parameter")
                fmu.number(parameter, value)
            with Slave(fmu, name) as slave:
                slave.initialize(starts[name].start)


def swept_run(run: Run) -> Outcome:
    """Does one run of the plan; it fails if an FMU refuses a value or an estimate is not finite."""
    chosen = prepare(run)
    try:
        indices = indices_by_comparison(chosen, run_scenario(chosen, run.seed))
    except (FmuError, ValueError) as error:
        reason = " ".join(str(error).split())
        return Outcome({}, {comparison.name: reason for comparison in chosen.comparisons})
    return Outcome({name: asdict(of_comparison) for name, of_comparison in indices.items()})


@dataclass(frozen=True)
class Sweep:
    """The plan: each run of a grid."""

    grid: Grid

    name = "sweep"

    @cached_property
    def jobs(self) -> list[Job]:
        chosen = {name: scenario(name) for name in self.grid.scenarios}
        return [
            Job(
                partial(swept_run, run),
                fmus=tuple(chosen[run.scenario].fmus),
                about=("sweep", run.scenario, run.modalities, run.seed, run.parameters),
                effort=chosen[run.scenario].duration,
            )
            for run in self.grid.runs
        ]

    def table(self, outcomes: Sequence[Outcome]) -> SweepTable:
        return of_outcomes(self.grid, outcomes)

    def write(self, table: SweepTable, folder: Path) -> None:
        write(table, folder / "sweep.parquet")
        sweep_summary.write(table, folder / "summary.csv")

    def figures(self, table: SweepTable) -> dict[str, FigureRows]:
        figures = {
            "distributions": distributions(table),
            "parameters": list(against_parameters(table)),
        }
        return {name: [[panel] for panel in panels] for name, panels in figures.items() if panels}

    def text(self, table: SweepTable) -> str:
        return f"{sweep_summary.conditions(self.grid)}\n\n{sweep_summary.summary(table)}"

    def values(self, table: SweepTable) -> object:
        return sweep_summary.values(table)
