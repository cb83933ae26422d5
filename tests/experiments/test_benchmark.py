"""Tests of the benchmark: logs that a method gets, and the score of its tables."""

from collections.abc import Mapping
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet
import pytest
from numpy.typing import NDArray

from command_line import Shell
from sigmahat.experiments import benchmark
from sigmahat.experiments.benchmark import LogWithTruth, score_tables
from sigmahat.experiments.scores import Score, score
from sigmahat.files.tables import write_csv
from sigmahat.fmi.model import Value
from sigmahat.studies.misfit_experiment import AWAS, SEA_1K
from sigmahat.studies.misfits import CONDITIONS, estimate_score, simulated_log, write_logs

Array = NDArray[np.float64]


def constant_log() -> LogWithTruth:
    """A log of 4 s without motion, whose stiffness is 100 N.m/rad, but 0 at the end."""
    zero, stiffness = np.zeros(8), np.full(8, 100.0)
    stiffness[-1] = 0.0
    measured = {"theta": zero, "q": zero, "tau": zero, "theta_c": zero}
    parameters: dict[str, Value] = {
        "samplePeriod": 0.5,
        "method": "FilteredRegression",
        "motor.gamma": 50.0,
    }
    return LogWithTruth("constant", "constant", 1, 0.5, measured, stiffness, parameters)


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A benchmark with one log, and an empty folder "mine" for estimates."""
    benchmark.write([constant_log], tmp_path / "benchmark")
    (tmp_path / "mine").mkdir()
    return tmp_path


def estimates(**changed: Array) -> Mapping[str, Array]:
    """A table of estimates, 10 % too stiff; changed or further columns."""
    std, t = np.full(8, 10.0), 0.5 * np.arange(8)
    return {"t": t, "stiffness": np.full(8, 110.0), "std": std, "confident": np.ones(8), **changed}


def written(table: Mapping[str, Array], folder: Path) -> Path:
    rows = zip(*(column.tolist() for column in table.values()), strict=True)
    write_csv(folder / "mine" / "constant.csv", list(table), rows)
    return folder / "mine"


def test_a_log_is_read_as_it_was_written(folder: Path) -> None:
    (log,) = benchmark.read(folder / "benchmark")
    expected = constant_log()
    assert (log.name, log.kind, log.seed, log.judged_from) == ("constant", "constant", 1, 2.0)
    assert log.parameters == expected.parameters
    np.testing.assert_array_equal(log.stiffness, expected.stiffness)
    assert {name: x.tolist() for name, x in log.measured.items()} == {
        name: x.tolist() for name, x in expected.measured.items()
    }


def test_the_score_of_a_table(folder: Path) -> None:
    mine = written(estimates(), folder)
    figures = score_tables(folder / "benchmark", mine)["constant"].figures
    assert figures["error"] == pytest.approx(10)
    assert figures["width"] == pytest.approx(2 * 1.96 * 10)
    assert (figures["coverage"], figures["confident"], figures["wrong"]) == (100, 100, 0)
    text = benchmark.table(score_tables(folder / "benchmark", mine))
    assert "constant" in text and "all logs" in text and "interval_score [%]" in text


def test_an_interval_need_not_be_symmetric(folder: Path) -> None:
    ends = {"low": np.full(8, 102.0), "high": np.full(8, 140.0)}
    table = {k: x for k, x in estimates(**ends).items() if k not in ("std", "confident")}
    pa.parquet.write_table(pa.table(table), folder / "mine" / "constant.parquet")
    figures = score_tables(folder / "benchmark", folder / "mine")["constant"].figures
    assert (figures["coverage"], figures["confident"]) == (0, 0)
    assert figures["width"] == pytest.approx(38)
    assert figures["interval_score"] == pytest.approx(38 + 40 * 2)


def test_a_method_without_intervals_has_an_error_alone(folder: Path) -> None:
    table = {name: x for name, x in estimates().items() if name in ("t", "stiffness")}
    figures = score_tables(folder / "benchmark", written(table, folder))["constant"].figures
    assert figures["error"] == pytest.approx(10)
    assert all(np.isnan(figures[name]) for name in ("width", "coverage", "interval_score"))


@pytest.mark.parametrize(
    ("changed", "words"),
    [
        ({"t": np.arange(8.0)}, "expected the 8 times t of the log"),
        ({"stiffness": np.full(8, np.nan)}, "not finite at 3 instants"),
        ({"stiffness": None}, "expected columns t and stiffness, got t, std, confident"),
    ],
)
def test_a_table_that_does_not_fit(
    changed: Mapping[str, Array | None], words: str, folder: Path
) -> None:
    columns = {**estimates(), **changed}
    table = {name: values for name, values in columns.items() if values is not None}
    with pytest.raises(ValueError, match=words):
        score_tables(folder / "benchmark", written(table, folder))


def test_no_table(folder: Path) -> None:
    with pytest.raises(ValueError, match="expected a table named as a log of"):
        score_tables(folder / "benchmark", folder / "mine")


def test_an_estimate_that_is_empty_has_no_figures() -> None:
    empty = np.zeros(0)
    assert score(empty, empty, np.zeros(0, np.bool_), empty) == Score()


@pytest.mark.slow("two joints of 20 s are simulated and estimated")
def test_logs_of_the_misfit_study_give_its_score_and_can_be_estimated(
    tmp_path: Path, shell: Shell
) -> None:
    write_logs(tmp_path, [1], CONDITIONS[:1], [AWAS, SEA_1K], processes=2)
    logs = list(benchmark.read(tmp_path))
    assert [log.kind for log in logs] == ["none, AwAS", "none, SEA1k"]
    for log, kind in zip(logs, (AWAS, SEA_1K), strict=True):
        assert estimate_score(log) == estimate_score(simulated_log("none", kind.name, 1))
    name = tmp_path / logs[1].name
    printed = shell.run(f"estimate {name}.csv --config {name}.toml --out out")
    assert "N.m/rad" in printed
