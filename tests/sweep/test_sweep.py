"""Sweeps: the right numbers, and none lost or done twice."""

import csv
import json
import signal
from dataclasses import replace
from pathlib import Path

import numpy as np
import psutil
import pytest
import scipy.stats

from command_line import Shell
from recordings import one_seed
from sigmahat.runs.metrics import INDICES, Indices
from sigmahat.sweep.job import Records, sweep
from sigmahat.sweep.plan import Outcome, Plan, read_plan
from sigmahat.sweep.table import read
from sweeps import QUICK, records, start, wait_until

OUT = Path("out")
FILES = {
    ".runs.jsonl.lock", "distributions.png", "distributions.svg", "parameters.png",
    "parameters.svg", "runs.jsonl", "summary.csv", "sweep.parquet",
}  # fmt: skip


@pytest.mark.slow("a sweep and a reproduction of the same seed")
def test_the_numbers_are_those_of_reproduce(tmp_path: Path) -> None:
    table = sweep(read_plan(None, ("table1",), 1), tmp_path).table.to_pylist()
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
    summary = shell.json(f"{QUICK} --seeds 3 {options} --out out")
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
    for row, printed, group in zip(rows, summary, groups, strict=True):
        x = [r["msrep [%]"] for r in group]
        interval = scipy.stats.t.interval(0.95, 2, np.mean(x), scipy.stats.sem(x))
        half = (interval[1] - interval[0]) / 2
        assert float(row["msrep [%]"]) == pytest.approx(np.mean(x))
        assert float(row["msrep 95 % half width [%]"]) == pytest.approx(half)
        assert printed["msrep [%]"]["mean"] == pytest.approx(np.mean(x))
        assert (row["runs"], row["failed"]) == ("3", "0")


@pytest.mark.slow("several sweeps, each in processes of its own")
def test_killed_and_resumed_is_the_same_file(shell: Shell) -> None:
    command = f"{QUICK} --seeds 8 --set estimator.residual.K_I=200,300"
    # GIVEN a sweep in one go
    shell.run(f"{command} --out whole")
    # WHEN another is killed in the middle, in the middle of a line
    path = Path("killed", "runs.jsonl")
    process = start(f"{command} --out killed")
    wait_until(lambda: len(records(path)) >= 2, process)
    workers = psutil.Process(process.pid).children(recursive=True)
    process.send_signal(signal.SIGKILL)
    process.communicate()
    before = path.read_bytes()
    assert 2 <= len(records(path)) < 16
    path.write_bytes(before + b'{"numb')
    # THEN its workers are gone with it
    gone, alive = psutil.wait_procs(workers, timeout=300)
    assert (len(gone), alive) == (len(workers), [])
    # AND the same command does the rest, and only that
    said = shell.run(f"{command} --out killed")
    assert shell.err == ""
    assert path.read_bytes().startswith(before)
    done_runs = [json.loads(line) for line in records(path)]
    assert sorted((each["setting"], each["seed"]) for each in done_runs) == [
        (setting, seed) for setting in (0, 1) for seed in range(1, 9)
    ]
    for name in FILES - {"runs.jsonl"}:
        assert Path("whole", name).read_bytes() == Path("killed", name).read_bytes()
    # AND once more, nothing is left to do
    complete = path.read_bytes()
    assert shell.run(f"{command} --out killed") == said
    assert path.read_bytes() == complete


def made_up(path: Path, plan: Plan) -> dict[int, Outcome]:
    """Adds an outcome of every run that the records in a file lack; returns all of them."""
    opened = Records(path, plan)
    for each in plan.runs:
        if each.number not in opened.outcomes:
            mse = 10 * float(each.parameters["plant.link.M"]) + each.seed
            opened.add(Outcome(each.number, {"a": Indices(*[mse] * len(INDICES))}, None))
    opened.close()
    return opened.outcomes


def test_more_seeds_wherever_a_sweep_was_killed(tmp_path: Path) -> None:
    plans = [Plan(("table1",), seeds, (), {"plant.link.M": (1, 2, 3)}) for seeds in (1, 2, 4)]
    path, killed = tmp_path / "runs.jsonl", tmp_path / "killed.jsonl"
    expected = made_up(tmp_path / "whole.jsonl", plans[-1])
    for plan in plans[:-1]:
        made_up(path, plan)
    # At the end of each line, and in the middle of the next one: the largest goes on from there.
    lines = path.read_bytes().splitlines(keepends=True)
    for count in range(len(lines)):
        whole = b"".join(lines[:count])
        for cut in (b"", lines[count][:20]):
            killed.write_bytes(whole + cut)
            assert made_up(killed, plans[-1]) == expected
            assert killed.read_bytes().startswith(whole)
    # AND none goes on with fewer seeds, or with other values
    done = killed.read_bytes()
    with pytest.raises(ValueError, match="with 4 seeds; expected as many or more, got 2; choose"):
        Records(killed, plans[1])
    others = [replace(plans[-1], parameters={"plant.link.M": v}) for v in ((1, 2), (1, 2, 4))]
    for other in (*others, replace(others[0], seeds=6)):
        with pytest.raises(ValueError, match="of another sweep, or of other FMUs; choose"):
            Records(killed, other)
    assert killed.read_bytes() == done


@pytest.mark.slow("a sweep in processes of its own")
def test_an_interrupt_keeps_what_is_done_and_another_sweep_is_refused(shell: Shell) -> None:
    command = f"{QUICK} --seeds 2000 --out out"
    process = start(command)
    wait_until(lambda: len(records(OUT / "runs.jsonl")) >= 2, process)
    assert shell.run(command, 2) == ""
    assert "another sweep is writing to out" in shell.err
    process.send_signal(signal.SIGINT)
    output, errors = process.communicate(timeout=300)
    assert (process.returncode, output) == (130, "")
    assert errors.split("\n") == ["", "sigmahat: interrupted", ""]
    assert 2 <= len(records(OUT / "runs.jsonl")) < 2000


def test_records_that_do_not_fit(shell: Shell) -> None:
    command, path = f"{QUICK} --seeds 2 --out out", OUT / "runs.jsonl"
    shell.run(command)
    good = path.read_bytes()
    for damaged, words in (
        (good.replace(b'"seed": 2', b'"seed": 1'), "line"),
        (good + records(path)[0], "line 4: run"),
        (b"\0" + good, "line 1: damaged; delete this file"),
    ):
        path.write_bytes(damaged)
        assert words in shell.refused(command)


def test_runs_that_fail_are_reported(shell: Shell) -> None:
    # GIVEN an inertia that is negative, which the FMU refuses, for some seeds
    inertia = "'estimator.motor.B=normal(2.3e-5,5e-5)'"
    said = shell.run(f"{QUICK} --seeds 6 --set {inertia} --out out")
    assert shell.err == ""
    table = read(OUT / "sweep.parquet").table.to_pylist()
    negative = [row["estimator.motor.B [kg.m2]"] < 0 for row in table]
    assert 0 < sum(negative) < 6
    assert [row["failure"] is not None for row in table] == negative
    assert [bool(np.isnan(row["mse [(N.m/rad)2]"])) for row in table] == negative
    first = next(row["failure"] for row in table if row["failure"])
    assert f"failed, the first with: {first}" in said
