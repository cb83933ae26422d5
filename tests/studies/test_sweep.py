"""A sweep gives the right results, and neither loses nor repeats a run."""

import csv
import signal
import sqlite3
from contextlib import closing
from pathlib import Path

import numpy as np
import psutil
import pytest
import scipy.stats

from command_line import Shell
from recordings import one_seed
from sigmahat.experiments import engine, job
from sigmahat.experiments.engine import all_outcomes, study
from sigmahat.experiments.job import Job, Outcome
from sigmahat.experiments.metrics import INDICES
from sigmahat.experiments.records import NAME, Records
from sigmahat.studies.sweep import Sweep
from sigmahat.studies.sweep_grid import Grid, Run, read_grid
from sigmahat.studies.sweep_table import read
from sweeps import QUICK, records, start, wait_until, written

OUT = Path("out")
FILES = {
    "distributions.png", "distributions.svg", "parameters.png", "parameters.svg", NAME,
    "summary.csv", "sweep.parquet",
}  # fmt: skip


@pytest.mark.slow("a sweep and a reproduction of the same seed")
def test_the_numbers_are_those_of_reproduce(tmp_path: Path) -> None:
    table = study(Sweep(read_grid(("table1",))), tmp_path).table.to_pylist()
    assert len(table) == 4
    for row in table:
        indices = one_seed("table1").indices[0][row["estimation"]]
        assert row["mse [(N.m/rad)2]"] == indices.mse
        assert row["msrep [%]"] == indices.msrep
        assert row["error_settled [%]"] == indices.error_settled
        assert row["failure"] is None


@pytest.mark.slow("a sweep in processes of its own")
def test_summary_and_errors_of_parameters(shell: Shell) -> None:
    values = ("plant.motor.D_theta=0.8e-3,1e-3", "RESIDUAL.motor.D_theta=0.9e-3")
    options = " ".join(f"--set '{each}'" for each in (*values, "plant.link.M=uniform(0.09,0.11)"))
    printed = shell.json(f"{QUICK} --seeds 3 {options} --out out")
    units = printed["units"]
    assert (units["plant.motor.D_theta"], units["msrep"]) == ("N.m.s/rad", "%")
    assert shell.err == ""
    assert {path.name for path in OUT.iterdir()} == FILES
    table = read(OUT / "sweep.parquet").table.to_pylist()
    assert [row["run"] for row in table] == list(range(6))
    for row in table:
        true = row["plant.motor.D_theta [N.m.s/rad]"]
        assert row["error of motor.D_theta [%]"] == pytest.approx(100 * (0.9e-3 - true) / true)
        assert 0.09 <= row["plant.link.M [kg.m2]"] <= 0.11
    with (OUT / "summary.csv").open() as file:
        rows = list(csv.DictReader(file))
    groups = (table[:3], table[3:])
    for row, setting, group in zip(rows, printed["table"], groups, strict=True):
        x = [r["msrep [%]"] for r in group]
        interval = scipy.stats.t.interval(0.95, 2, np.mean(x), scipy.stats.sem(x))
        half = (interval[1] - interval[0]) / 2
        assert float(row["msrep [%]"]) == pytest.approx(np.mean(x))
        assert float(row["msrep 95 % half width [%]"]) == pytest.approx(half)
        assert setting["msrep"]["mean"] == pytest.approx(np.mean(x))
        assert (row["runs"], row["failed"]) == ("3", "0")


@pytest.mark.slow("several sweeps, each in processes of its own")
def test_killed_and_resumed_is_the_same_file(shell: Shell) -> None:
    command = f"{QUICK} --seeds 8 --set estimator.residual.K_I=200,300"
    # GIVEN a complete sweep without interruption
    shell.run(f"{command} --out whole")
    # WHEN another sweep is killed before its end
    killed = Path("killed")
    process = start(f"{command} --out killed")
    wait_until(lambda: written(killed) >= 2, process)
    workers = psutil.Process(process.pid).children(recursive=True)
    process.send_signal(signal.SIGKILL)
    process.communicate()
    # THEN the worker processes of the killed sweep end, too.
    gone, alive = psutil.wait_procs(workers, timeout=300)
    assert (len(gone), alive) == (len(workers), [])
    before = records(killed)
    assert 2 <= len(before) < 16
    # AND the same command of the sweep only executes the missing runs.
    said = shell.run(f"{command} --out killed")
    assert shell.err == ""
    assert records(killed)[: len(before)] == before
    assert len(records(killed)) == 16
    for name in FILES - {NAME}:
        assert Path("whole", name).read_bytes() == (killed / name).read_bytes()
    # AND a repetition of the command executes no runs.
    complete = (killed / NAME).read_bytes()
    assert shell.run(f"{command} --out killed") == said
    assert (killed / NAME).read_bytes() == complete


def test_a_run_is_not_repeated_in_any_plan(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    done: list[tuple[int, float]] = []

    def execute(each: Job, _: str) -> Outcome:
        (run,) = each.run.args
        assert isinstance(run, Run)
        mass = float(run.parameters["plant.link.M"])
        done.append((run.seed, mass))
        return Outcome({"a": dict.fromkeys(INDICES, 10 * mass + run.seed)})

    def outcomes(seeds: int, *masses: float) -> list[Outcome]:
        """Outcomes of all runs of a plan; the list `done` then contains the executed runs."""
        plan = Sweep(Grid(("table1",), seeds, (), {"plant.link.M": masses}))
        done.clear()
        with closing(Records(tmp_path / NAME)) as opened:
            return all_outcomes(plan.jobs, records=opened)

    monkeypatch.setattr(engine, "execute", execute)
    monkeypatch.setattr(engine, "spread", lambda jobs, _: (x for x in enumerate(j() for j in jobs)))
    assert len(outcomes(1, 1.0, 2.0)) == len(done) == 2
    # WHEN there are more seeds, only new runs are executed, and outcomes follow the plan's order.
    found = outcomes(2, 1.0, 2.0)
    assert done == [(2, 1.0), (2, 2.0)]
    assert [each.rows["a"]["mse"] for each in found] == [11, 12, 21, 22]
    # WHEN there are fewer seeds and a new value, only the run with this value is executed.
    assert [each.rows["a"]["mse"] for each in outcomes(1, 2.0, 3.0)] == [21, 31]
    assert done == [(1, 3.0)]
    # WHEN the FMUs differ, all runs are executed again.
    monkeypatch.setattr(job, "_digest_of_fmus", lambda names: "other")
    assert len(outcomes(1, 1.0, 2.0)) == len(done) == 2
    # WHEN the plan differs, too.
    monkeypatch.setattr(job, "_digest_of_plan", lambda function: "other")
    assert len(outcomes(1, 1.0, 2.0)) == len(done) == 2


@pytest.mark.slow("a sweep in processes of its own")
def test_an_interrupt_keeps_what_is_done_and_another_sweep_is_refused(shell: Shell) -> None:
    command = f"{QUICK} --seeds 2000 --out out"
    process = start(command)
    wait_until(lambda: written(OUT) >= 2, process)
    assert shell.run(command, 2) == ""
    assert "database is locked; another sweep writes to this folder" in shell.err
    process.send_signal(signal.SIGINT)
    output, errors = process.communicate(timeout=300)
    assert (process.returncode, output) == (130, "")
    assert errors.split("\n") == ["", "sigmahat: interrupted", ""]
    assert 2 <= len(records(OUT)) < 2000


def test_a_file_of_runs_that_is_in_use_or_damaged(shell: Shell) -> None:
    OUT.mkdir()
    with closing(Records(OUT / NAME)), pytest.raises(sqlite3.OperationalError, match="is locked"):
        Records(OUT / NAME)
    (OUT / NAME).write_bytes(b"no database" * 100)
    assert "or the file is damaged; choose another folder" in shell.refused(f"{QUICK} --out out")


def test_runs_that_fail_are_reported(shell: Shell) -> None:
    # GIVEN a random inertia, which is negative for some seeds, so that the FMU refuses the value
    inertia = "'estimator.motor.B=normal(2.3e-5,5e-5)'"
    said = shell.run(f"{QUICK} --seeds 6 --set {inertia} --out out")
    assert shell.err == ""
    table = read(OUT / "sweep.parquet").table.to_pylist()
    negative = [row["estimator.motor.B [kg.m2]"] < 0 for row in table]
    assert 0 < sum(negative) < 6
    assert [row["failure"] is not None for row in table] == negative
    assert [bool(np.isnan(row["mse [(N.m/rad)2]"])) for row in table] == negative
    first = next(row["failure"] for row in table if row["failure"])
    assert f"failed; message of the first: {first}" in said
