"""The table of results, and what becomes of a method that fails."""

from __future__ import annotations

from closed_form_joint import closed_form_log
from rivals.records import Estimate, JointLog
from rivals.score import Result, Score, judge
from rivals.table import best, page


def of(method: str, seed: int, interval_score: float, wrong: float = 0.0) -> Result:
    found = Score(2.0 * seed, 5.0, 90.0, interval_score, 100.0, wrong)
    return Result("arm", seed, method, 0.5, found, "")


FAILED = Result("arm", 2, "least_squares", 0.1, None, "not converged")
RESULTS = [
    of("FilteredRegression", 1, 8.0),
    of("Paper2011", 1, 9.0),
    of("FilteredRegression", 2, 6.0),
    of("Paper2011", 2, 4.0, wrong=25.0),
    of("least_squares", 1, float("nan")),
    FAILED,
]


def cells(line: str) -> list[str]:
    return [cell.strip() for cell in line.strip("|").split("|")]


def test_the_best_of_a_log_has_the_lowest_interval_score() -> None:
    assert best(RESULTS) == {("arm", 1): "FilteredRegression", ("arm", 2): "Paper2011"}


def test_a_row_has_medians_and_means_over_the_logs() -> None:
    lines = page(RESULTS).splitlines()
    row = next(line for line in lines if line.startswith("| arm | FilteredRegression"))
    assert cells(row)[2:] == ["2 of 2", "3", "5", "90", "7", "50", "0.5", "100", "0"]
    row = next(line for line in lines if line.startswith("| arm | least_squares"))
    assert cells(row)[2:7] == ["1 of 2", "2", "5", "90", "-"]
    row = next(line for line in lines if line.startswith("| arm | Paper2011"))
    assert cells(row)[-1] == "12.5"


def test_a_method_that_fails_has_a_row_with_its_reason() -> None:
    log = closed_form_log("series_elastic")

    def raises(log: JointLog) -> Estimate:
        raise ZeroDivisionError("no motion")

    result = judge("Paper2011", raises, log)
    assert (result.score, result.remark) == (None, "ZeroDivisionError: no motion")
    assert (result.kind, result.seed) == (log.kind, log.seed)
