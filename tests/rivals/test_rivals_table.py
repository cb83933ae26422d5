"""Tables of results, and what becomes of a method that fails."""

from __future__ import annotations

import csv
from pathlib import Path

import pytest

from closed_form_joint import closed_form_log
from rivals.records import Estimate, JointLog, none_found
from rivals.score import Result, Score, judge, write_results
from rivals.table import best, page


def of(method: str, seed: int, interval_score: float, wrong: float = 0.0) -> Result:
    found = Score(2.0 * seed, 5.0, 90.0, interval_score, 100.0, wrong)
    return Result("arm", seed, method, 0.5, found, "")


FAILED = Result("arm", 2, "idim_iv", 0.1, None, "not converged")
RESULTS = [
    of("FilteredRegression", 1, 8.0),
    of("kalman", 1, 9.0),
    of("FilteredRegression", 2, 6.0),
    of("kalman", 2, 4.0, wrong=25.0),
    of("idim_iv", 1, float("nan")),
    FAILED,
]


def cells(line: str) -> list[str]:
    return [cell.strip() for cell in line.strip("|").split("|")]


def test_the_best_of_a_log_has_the_lowest_interval_score() -> None:
    assert best(RESULTS) == {("arm", 1): "FilteredRegression", ("arm", 2): "kalman"}


def test_a_row_has_medians_and_means_over_the_logs() -> None:
    lines = page(RESULTS).splitlines()
    row = next(line for line in lines if line.startswith("| FilteredRegression"))
    assert cells(row) == [
        *("FilteredRegression", "2 of 2", "3.0", "5.0", "90", "7.0", "50 %", "0.50", "100", "0.0"),
    ]
    row = next(line for line in lines if line.startswith("| IDIM-IV | 1"))
    assert cells(row)[:6] == ["IDIM-IV", "1 of 2", "2.0", "5.0", "90", "-"]
    assert "### Arm under gravity with contact" in lines


def test_what_was_confident_and_wrong_and_what_has_no_estimate_is_listed() -> None:
    lines = page(RESULTS).splitlines()
    wrong = lines.index("### Confident and over 20 % wrong")
    row = ["arm", "2", "extended Kalman filter", "25.0", "4.0", "5.0"]
    assert cells(lines[wrong + 4]) == row
    none = lines.index("### No estimate")
    assert cells(lines[none + 4]) == ["IDIM-IV", "arm", "2", "not converged"]


def test_without_failures_the_page_says_so() -> None:
    text = page(RESULTS[:1])
    assert text.count("None.") == 2


def test_results_are_written_with_all_digits(tmp_path: Path) -> None:
    path = tmp_path / "rivals.csv"
    write_results(path, [of("kalman", 1, 1 / 3), FAILED])
    with path.open(encoding="utf-8") as file:
        first, second = csv.DictReader(file)
    assert float(first["interval_score"]) == 1 / 3
    assert (first["kind"], first["seed"], first["remark"]) == ("arm", "1", "")
    assert (second["error"], second["remark"]) == ("", "not converged")


def test_a_method_that_fails_has_a_row_with_its_reason() -> None:
    log = closed_form_log("series_elastic")

    def raises(log: JointLog) -> Estimate:
        raise ZeroDivisionError("no motion")

    result = judge("kalman", raises, log)
    assert (result.score, result.remark) == (None, "ZeroDivisionError: no motion")
    assert (result.kind, result.seed) == (log.kind, log.seed)
    result = judge("kalman", lambda log: none_found(log, 0.5, "diverged"), log)
    assert (result.score, result.remark, result.seconds) == (None, "diverged", 0.5)


@pytest.mark.parametrize("value", [12345.0, 123.4, 1.234, 0.01234, 0.0])
def test_numbers_have_two_digits_or_all_before_the_point(value: float) -> None:
    found = Score(value, 5.0, 90.0, 1.0, 100.0, 0.0)
    text = page([Result("arm", 1, "kalman", 0.5, found, "")])
    row = next(line for line in text.splitlines() if line.startswith("| extended"))
    expected = {12345.0: "1.2e+04", 123.4: "123", 1.234: "1.2", 0.01234: "0.012", 0.0: "0"}
    assert cells(row)[2] == expected[value]
