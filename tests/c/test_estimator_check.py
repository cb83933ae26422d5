"""The check of a state from outside: states of runs pass, damaged states do not."""

from itertools import product
from typing import Any

import numpy as np
import pytest

from c_library import Estimator, Library
from regression_joint import Joint

PAPER2011, FILTERED_REGRESSION = 1, 2
JOINTS: list[dict[str, Any]] = [
    {},
    {"rls.n": 8, "rls.m": 5},
    {"rls.symmetric": 0, "rls.n": 4, "rls.m": 1},
    {"rls.n": 3, "prior.B": 0.1, "regression.drift": 0.01},
    {"rls.n": 2, "prior.tau_coulomb": 0.0, "prior.D_theta": 0.0, "regression.decimation": 1},
]


def passes(e: Estimator) -> bool:
    answer = e.library.lib.sh_estimator_check(e.state, e.parameters)
    assert answer in (0, 1)
    return bool(answer == 0)


@pytest.mark.parametrize("method", [PAPER2011, FILTERED_REGRESSION])
@pytest.mark.parametrize("joint", JOINTS)
def test_every_state_of_a_run_passes(c: Library, method: int, joint: dict[str, Any]) -> None:
    """GIVEN a run with gaps, refused samples, and changes of the modality and of the noise, THEN
    each of its 1500 states passes. The spacing of the rows depends on the noise at the start."""
    rng = np.random.default_rng(1)
    e = Estimator(c, {"method": method, **joint})
    assert passes(e)
    for row in Joint(duration=1.5).measurements():
        chance = rng.random()
        if chance < 0.004:
            row[:] = np.nan
        elif chance < 0.006:
            row[0] = 1e12
        elif chance < 0.008:
            e.parameters.modality = int(rng.integers(1, 4))
        elif chance < 0.01:
            e.parameters.noise.tau = 10.0 ** rng.uniform(-5, -2)
        e.tick(row)
        assert passes(e)


CONFIGURED = {"method": FILTERED_REGRESSION, "rls.n": 3, "prior.B": 0.1}
SIZE = 33  # number of columns with these parameters
LIMITS: dict[str, tuple[int, int]] = {
    "modality": (1, 3),
    **dict.fromkeys(("bank.friction_drifts", "feedback.stiffness_known", "signals.begun"), (0, 1)),
    **dict.fromkeys(("refit.used", "bank.following", "refit.is_open"), (0, 1)),
    "refit.unread": (0, SIZE),
    "schedule.block_job": (0, 4),
    "schedule.refit_job": (0, 15),
    "schedule.interrupted": (0, 1),
    **dict.fromkeys(("refit.trial", "refit.last_trial"), (0, 6)),
    **dict.fromkeys(("samples.data.size", "columns.size"), (SIZE, SIZE)),
    **{f"bank.{one}.size": (SIZE, SIZE) for one in ("constant", "friction", "spring")},
    **{f"{one}.information.size": (1, SIZE) for one in ("posterior", "refit.posterior")},
    **{f"{one}.column": (0, SIZE - 1) for one in ("posterior", "refit.posterior")},
    "columns.has_nominal": (0, 0),
}
"""Ranges of integers in a state of FilteredRegression."""
COUNTS = {
    "change_age": (-1, 10**9),
    **dict.fromkeys(("gate.samples", "gate.skipped", "gate.signal.refused"), (0, 10**9)),
}
"""Ranges of numbers of ticks."""
OTHERS = (
    *("columns.spring", "columns.knees", "columns.filtered", "columns.friction"),
    *("columns.inertia", "columns.column.kind", "columns.column.i", "columns.column.j"),
    *("bank.widened", "signals.decimation", "mean.samples", "schedule.tick"),
)
"""Other integers of this state, none of which can be below 0 or above 64."""


def damage(part: Any, member: str, place: int, value: int) -> None:
    """Sets a member by its dotted name; of an array, the element at `place`."""
    *groups, last = member.split(".")
    for group in groups:
        part = getattr(part, group)
        if group in ("column", "signal"):
            part = part[place]
    if last in ("used", "column"):
        getattr(part, last)[place] = value
    else:
        setattr(part, last, value)


@pytest.mark.parametrize("member", [*LIMITS, *OTHERS])
def test_a_damaged_member_is_found(c: Library, member: str) -> None:
    """GIVEN an integer outside its range, at any place of the state, THEN the check fails."""
    for place, value in product(range(6), (-(2**15), -2, 65, 2**15 - 1)):
        e = Estimator(c, CONFIGURED)
        damage(e.state.method.regression, member, place, value)
        assert not passes(e)


@pytest.mark.parametrize("member", [*LIMITS, *COUNTS])
def test_the_limits_are_exact(c: Library, member: str) -> None:
    least, largest = {**LIMITS, **COUNTS}[member]
    for value in (least - 1, least, largest, largest + 1):
        e = Estimator(c, CONFIGURED)
        damage(e.state.method.regression, member, 1, value)
        assert passes(e) == (least <= value <= largest)


@pytest.mark.parametrize(
    ("member", "value"),
    [
        *(("state.method.paper2011.rls.P.size", n) for n in (-(2**31), 0, 8, 10, 9 + 2**16)),
        *(("state.started", value) for value in (-1, 2)),
        *(("state.skipped", value) for value in (-1, 10**9 + 1)),
        *(("parameters.method", value) for value in (-(2**31), -1, 0, 3, 2**31 - 1)),
    ],
)
def test_another_size_count_or_method_is_found(c: Library, member: str, value: int) -> None:
    """Of nine parameters, of samples, or one that does not exist."""
    e = Estimator(c, {"method": PAPER2011, "rls.n": 3, "rls.m": 3})
    damage(e, member, 0, value)
    assert not passes(e)
