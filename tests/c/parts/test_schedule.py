"""schedule.c: the ticks until the next row share the jobs of the last row."""

from typing import Any

import pytest

from c_library import Estimator, Library
from c_parts import SENSOR
from regression_joint import PLAIN

TWO_COLUMNS = {
    **{"method": 2, "modality": SENSOR, "rls.n": 1, "rls.m": 1, **PLAIN, "prior.bias": 0.1},
    **{f"prior.{name}": 0.0 for name in ("B", "D_theta", "tau_coulomb")},
}


class Ticks:
    """A started estimator, whose rows are given."""

    def __init__(self, c: Library, T: float, K: int) -> None:
        values = {"samplePeriod": T, "regression.decimation": K, "regression.bandwidth": 100.0}
        self.c, self.estimator = c, Estimator(c, {**TWO_COLUMNS, **values})
        self.state = self.estimator.state.method.regression

    def begin_row(self) -> None:
        """The row (1, 1) of the weight 1 comes, and the refit has read all rows of the data."""
        self.state.row.x[0:2], self.state.row.w, self.state.row.lasting = [1.0, 1.0], 1.0, 1.0
        self.state.refit.unread = 0
        self.c.lib.sh_schedule_row(self.c.ffi.addressof(self.state.schedule))

    def interrupt(self) -> None:
        self.c.lib.sh_schedule_interrupt(self.c.ffi.addressof(self.state.schedule))

    def advance(self) -> list[str]:
        """Makes the jobs of a tick. Returns what they have changed."""
        before, state = self._numbers(), self.c.ffi.addressof(self.state)
        news = self.c.lib.sh_schedule_advance(state, self.estimator.parameters)
        after = self._numbers()
        changed = [name for name in before if before[name] != after[name]]
        if news & self.c.lib.SH_NEW_VARIANCES:
            changed.insert(0, "variances")
        if news & self.c.lib.SH_NEW_COEFFICIENTS:
            changed.insert(0, "coefficients")
        return changed

    def _numbers(self) -> dict[str, Any]:
        state = self.state
        return {
            "data": state.samples.data.D[0],
            "new posterior": state.refit.posterior.information.D[0],
            "refit": state.schedule.refit_job,
            "posterior": state.posterior.information.D[0],
        }


ALONE = [
    *(["coefficients"], ["variances"], ["data"], ["new posterior"]),
    *(["refit"], ["refit", "posterior"], ["coefficients", "refit"]),
]
"""The seven jobs of a row. The last three are steps of the refit: it ends, and is then used."""


@pytest.mark.parametrize(
    ("K", "jobs"),
    [(8, [1] * 7), (4, [3, 2, 2]), (2, [7]), (1, [7])],
)
def test_ticks_share_seven_jobs(c: Library, K: int, jobs: list[int]) -> None:
    """All jobs are done in the K - 1 ticks before the last one, or in the tick of the row."""
    ticks = Ticks(c, 1e-3, K)
    assert ticks.advance() == []  # there is no row
    ticks.begin_row()
    done = [sorted(ticks.advance()) for _ in jobs]
    each = iter(ALONE)
    want = [sorted({name for _ in range(n) for name in next(each)}) for n in jobs]
    assert done == want
    assert ticks.advance() == []


@pytest.mark.parametrize(("T", "steps"), [(1e-3, 1), (1.7e-3, 2), (3.3e-3, 4)])
def test_a_refit_makes_more_steps_in_long_rows(c: Library, T: float, steps: int) -> None:
    """One for each 6.5 ms: rows of 8, 13.6 and 26.4 ms."""
    ticks = Ticks(c, T, 8)
    ticks.begin_row()
    for _ in range(5):
        ticks.advance()
    assert ticks.state.schedule.refit_job == steps


def block_ticks(c: Library) -> Ticks:
    """Rows of 12.5 ms, of which four are a block, with all jobs in one tick."""
    ticks = Ticks(c, 12.5e-3, 1)
    assert ticks.state.block.length == 4.0
    return ticks


def test_a_full_block_has_its_jobs_before_those_of_the_refit(c: Library) -> None:
    """The fourth row fills a block. Three of its jobs follow at once. The last one, which counts
    the block, comes with the next row. Meanwhile, the refit waits."""
    ticks = block_ticks(c)
    rows, blocks, refits = [], [], []
    for _ in range(5):
        ticks.begin_row()
        refits.append("refit" in ticks.advance())
        rows.append(ticks.state.block.rows)
        blocks.append(ticks.state.bank.count)
    assert rows == [1.0, 2.0, 3.0, 0.0, 1.0]
    assert blocks == [0.0, 0.0, 0.0, 0.0, 1.0]
    assert refits == [True, True, True, False, True]


def test_a_row_with_a_gap_behind_it_is_in_no_block(c: Library) -> None:
    ticks = block_ticks(c)
    rows = []
    for gap in (False, False, True, False):
        ticks.begin_row()
        if gap:
            ticks.interrupt()
        ticks.advance()
        rows.append(ticks.state.block.rows)
    assert rows == [1.0, 2.0, 2.0, 3.0]
