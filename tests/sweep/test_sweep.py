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

from recordings import one_seed
from sigmahat.runs.metrics import INDICES, Indices
from sigmahat.sweep.job import Records, sweep
from sigmahat.sweep.plan import Outcome, Plan, read_plan
from sigmahat.sweep.table import read
from sweeps import QUICK, records, refused, run, start, wait_for_records

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
def test_summary_and_errors_of_parameters(tmp_path: Path) -> None:
    done = run(
        *QUICK, "--seeds", "3", "--set", "plant.motor.D_theta=0.8e-3,1e-3",
        "--set", "RESIDUAL.motor.D_theta=0.9e-3", "--set", "plant.link.M=uniform(0.09,0.11)",
        "--json", "--out", "out", cwd=tmp_path,
    )  # fmt: skip
    assert (done.returncode, done.stderr) == (0, "")
    assert {path.name for path in (tmp_path / "out").iterdir()} == FILES
    table = read(tmp_path / "out" / "sweep.parquet").table.to_pylist()
    assert [row["run"] for row in table] == list(range(6))
    for row in table:
        true = row["plant.motor.D_theta [N.m.s/rad]"]
        assert row["error of motor.D_theta [%]"] == pytest.approx(100 * (0.9e-3 - true) / true)
        assert 0.09 <= row["plant.link.M [kg.m2]"] <= 0.11
    with (tmp_path / "out" / "summary.csv").open() as file:
        rows = list(csv.DictReader(file))
    for row, printed, group in zip(
        rows, json.loads(done.stdout), (table[:3], table[3:]), strict=True
    ):
        x = [r["msrep [%]"] for r in group]
        interval = scipy.stats.t.interval(0.95, 2, np.mean(x), scipy.stats.sem(x))
        half = (interval[1] - interval[0]) / 2
        assert float(row["msrep [%]"]) == pytest.approx(np.mean(x))
        assert float(row["msrep 95 % half width [%]"]) == pytest.approx(half)
        assert printed["msrep [%]"]["mean"] == pytest.approx(np.mean(x))
        assert (row["runs"], row["failed"]) == ("3", "0")


@pytest.mark.slow("several sweeps, each in processes of its own")
def test_killed_and_resumed_is_the_same_file(tmp_path: Path) -> None:
    arguments = [*QUICK, "--seeds", "8", "--set", "estimator.residual.K_I=200,300"]
    # GIVEN a sweep in one go
    assert run(*arguments, "--out", "whole", cwd=tmp_path).returncode == 0
    # WHEN another is killed in the middle, in the middle of a line
    path = tmp_path / "killed" / "runs.jsonl"
    process = start([*arguments, "--out", "killed"], tmp_path)
    wait_for_records(path, 2, process)
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
    done = run(*arguments, "--out", "killed", cwd=tmp_path)
    assert (done.returncode, done.stderr) == (0, "")
    assert path.read_bytes().startswith(before)
    done_runs = [json.loads(line) for line in records(path)]
    assert sorted((each["setting"], each["seed"]) for each in done_runs) == [
        (setting, seed) for setting in (0, 1) for seed in range(1, 9)
    ]
    for name in FILES - {"runs.jsonl"}:
        assert (tmp_path / "whole" / name).read_bytes() == (tmp_path / "killed" / name).read_bytes()
    # AND once more, nothing is left to do
    complete = path.read_bytes()
    assert run(*arguments, "--out", "killed", cwd=tmp_path).stdout == done.stdout
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
def test_an_interrupt_keeps_what_is_done_and_another_sweep_is_refused(tmp_path: Path) -> None:
    arguments = [*QUICK, "--seeds", "200", "--out", "out"]
    process = start(arguments, tmp_path)
    wait_for_records(tmp_path / "out" / "runs.jsonl", 2, process)
    assert "another sweep is writing to out" in refused(*arguments, cwd=tmp_path)
    process.send_signal(signal.SIGINT)
    output, errors = process.communicate(timeout=300)
    assert (process.returncode, output) == (130, "")
    assert errors.split("\n") == ["", "sigmahat: interrupted", ""]
    assert 2 <= len(records(tmp_path / "out" / "runs.jsonl")) < 200


def test_records_that_do_not_fit(tmp_path: Path) -> None:
    arguments = [*QUICK, "--seeds", "2", "--out", "out"]
    assert run(*arguments, cwd=tmp_path).returncode == 0
    path = tmp_path / "out" / "runs.jsonl"
    good = path.read_bytes()
    for damaged, words in (
        (good.replace(b'"seed": 2', b'"seed": 1'), "line"),
        (good + records(path)[0], "line 4: run"),
        (b"\0" + good, "line 1: damaged; delete this file"),
    ):
        path.write_bytes(damaged)
        assert words in refused(*arguments, cwd=tmp_path)
        assert path.read_bytes() == damaged


def test_runs_that_fail_are_reported(tmp_path: Path) -> None:
    # GIVEN an inertia that is negative, which the FMU refuses, for some seeds
    done = run(
        *QUICK, "--seeds", "6", "--set", "estimator.motor.B=normal(2.3e-5,5e-5)", "--out", "out",
        cwd=tmp_path,
    )  # fmt: skip
    assert (done.returncode, done.stderr) == (0, "")
    table = read(tmp_path / "out" / "sweep.parquet").table.to_pylist()
    negative = [row["estimator.motor.B [kg.m2]"] < 0 for row in table]
    assert 0 < sum(negative) < 6
    assert [row["failure"] is not None for row in table] == negative
    assert [bool(np.isnan(row["mse [(N.m/rad)2]"])) for row in table] == negative
    assert f"failed, the first with: {next(r['failure'] for r in table if r['failure'])}" in (
        done.stdout
    )


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--modality", "RESIDUL"], "did you mean 'RESIDUAL'?"),
        (["--set", "plant.motor.D_theta"], "expected NAME=VALUES"),
        (["--seeds", "0"], "--seeds"),
        (["missing.toml"], "cannot read missing.toml"),
        (["--set", "estimator.motor.B=uniform(-2,-1)"], "every run failed"),
        (["--scheduler", "tcp://127.0.0.1:9"], "no Dask scheduler at tcp://127.0.0.1:9"),
        (["--scheduler", "nonsense"], "start one with `dask scheduler`"),
    ],
)
def test_bad_input(arguments: list[str], words: str, tmp_path: Path) -> None:
    assert words in refused(
        *QUICK[: 0 if "--modality" in arguments else 2], *arguments, cwd=tmp_path
    )
    assert list(tmp_path.iterdir()) == []
