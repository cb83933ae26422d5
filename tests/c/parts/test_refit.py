"""refit.c: the next posterior, computed from the triangular matrix of all samples."""

import math
from typing import Any

import numpy as np
import pytest

from c_library import Library
from c_parts import columns, normal_equations, posterior_of_prior

ROWS = ((2.0, 1.0, 0.0, 5.0), (1.0, 1.0, 2.0, 1.0), (4.0, -1.0, 1.0, 3.0))
"""Weight, two columns, y."""
INFORMATION = np.array([[7.0, -2.0], [-2.0, 8.0]])
RIGHT_SIDE = np.array([-1.0, 14.0])
"""The normal equations of ROWS: 2 + 1 + 4, 2 - 4, 4 + 4; 10 + 1 - 12, 2 + 12."""


class Data:
    """Samples with two columns, and a refit that begins with the first `before` ROWS."""

    def __init__(self, c: Library, before: int, variance_factor: float = 1.0) -> None:
        self.c, self.columns = c, columns(c, {"POWER": 1.0, "BIAS": 1.0}, spring=2)
        self.refit, self.samples = c.new("sh_refit"), c.new("sh_samples")
        c.lib.sh_samples_start(self.samples, 2)
        for row in ROWS[:before]:
            self.take(row)
        signals, p = c.new("sh_signals"), c.parameters({})
        c.lib.sh_refit_begin(self.refit, self.columns, signals, self.samples, variance_factor, p)

    def take(self, values: tuple[float, ...]) -> None:
        """As the tick does: the data take the row, and an open refit takes what is left."""
        w, *x, y = values
        row, rest = self.c.new("sh_row", x=[*x, 0.0, y], w=w), self.c.ffi.NULL
        if self.refit.is_open:
            rest = self.c.ffi.addressof(self.refit, "rest")
        self.c.lib.sh_samples_take(self.samples, row, self.refit.unread, rest)
        self.c.lib.sh_refit_take_rest(self.refit, 2)

    def read(self) -> bool:
        data = self.c.ffi.addressof(self.samples, "data")
        return bool(self.c.lib.sh_refit_read(self.refit, data))

    @property
    def normal_equations(self) -> tuple[Any, Any]:
        """Of the new posterior, for y."""
        matrix, right = normal_equations(self.refit.posterior.information)
        return matrix, right[:, 1]


def test_a_refit_is_the_prior_and_all_samples(c: Library) -> None:
    """Each row of the triangular matrix is a sample: 1 + INFORMATION, and b."""
    data = Data(c, 3)
    while data.read():
        pass
    found = data.normal_equations
    assert found[0] == pytest.approx(np.eye(2) + INFORMATION)
    assert found[1] == pytest.approx(RIGHT_SIDE)


def test_a_misfit_makes_all_samples_count_less(c: Library) -> None:
    data = Data(c, 3, variance_factor=2.0)
    while data.read():
        pass
    found = data.normal_equations
    assert found[0] == pytest.approx(np.eye(2) + INFORMATION / 2)
    assert found[1] == pytest.approx(RIGHT_SIDE / 2)


def test_samples_that_come_during_a_refit_are_in_it(c: Library) -> None:
    """One before it, one before any row is read, and one after the first row of two. A sample after
    the end of the refit is only in the data."""
    data = Data(c, 1)
    data.take(ROWS[1])
    assert data.read() and data.refit.unread == 1
    data.take(ROWS[2])
    while data.read():
        pass
    c.lib.sh_refit_close(data.refit)
    data.take(ROWS[0])
    found = data.normal_equations
    assert found[0] == pytest.approx(np.eye(2) + INFORMATION)
    assert found[1] == pytest.approx(RIGHT_SIDE)


MANY = {"POWER": 1.0, "BIAS": 1.0, "HYSTERESIS": 1.0, "INERTIA": 1.0}


@pytest.mark.parametrize(
    ("state", "want"),
    [
        ({}, [1, 0, 3]),
        ({"trial": 4}, [1, 0, 3, 2]),
        ({"used": [0, 0, 0, 0, 1]}, [1, 2, 0, 3]),
    ],
)
def test_the_order_of_the_columns(c: Library, state: dict[str, Any], want: list[int]) -> None:
    """Others, spring, motor from the torque's column on, and the group that is tried."""
    refit, listed = c.new("sh_refit", **state), columns(c, MANY, spring=1)
    samples, signals, p = c.new("sh_samples"), c.new("sh_signals"), c.parameters({})
    c.lib.sh_refit_begin(refit, listed, signals, samples, 1.0, p)
    assert list(refit.posterior.column[0 : refit.posterior.information.size]) == want


@pytest.mark.parametrize(
    ("D", "z", "N", "before", "used"),
    [
        (1.0, 3.0, 29.0, 0, 1),  # 4.5 > 3 + 0.05 N
        (1.0, 3.0, 31.0, 0, 0),
        (math.exp(4), 3.0 / math.exp(2), 29.0, 0, 0),  # (9 - 4) / 2: its prior is too wide
        (1.0, 3.0, 179.0, 1, 1),  # 4.5 > 0.025 N
        (1.0, 3.0, 181.0, 1, 0),
    ],
)
def test_a_group_is_used_by_its_evidence(
    c: Library, D: float, z: float, N: float, before: int, used: int
) -> None:
    """(D z^2 - ln D) / 2 for a column of the information D and the estimate z."""
    listed, refit = columns(c, {"HYSTERESIS": 1.0}), c.new("sh_refit", trial=4)
    refit.posterior = posterior_of_prior(c, 1)[0]
    refit.used[4] = before
    last = c.new("sh_last_row", D=D, z=[0.0, z])
    c.lib.sh_information_set_last(c.ffi.addressof(refit.posterior, "information"), last)
    c.lib.sh_refit_decide_about_group(refit, listed, N)
    assert refit.used[4] == used


def test_every_second_refit_is_a_trial_from_fifteen_blocks_on(c: Library) -> None:
    """Hysteresis is group 4, the only one that has columns; a known knee belongs to no group."""
    refit, listed = c.new("sh_refit"), columns(c, MANY | {"KNEE": 1.0})
    signals, p = c.new("sh_signals"), c.parameters({})
    trials = []
    for N in (14.9, 15.0, 15.0, 15.0):
        c.lib.sh_refit_end(refit, listed, signals, N, p)
        trials.append(refit.trial)
    assert trials == [0, 4, 0, 4]


def test_a_refit_waits_for_a_hundredth_of_the_blocks(c: Library) -> None:
    """1.01 % of 100 blocks of 0.2 s are 0.202 s. With few blocks, 0.2 s."""
    refit, listed = c.new("sh_refit"), columns(c, MANY)
    c.lib.sh_refit_wait(refit, 0.1)
    c.lib.sh_refit_wait(refit, 0.101)
    assert c.lib.sh_refit_is_due(refit, 14.0, 0.2) == 1
    assert c.lib.sh_refit_is_due(refit, 100.0, 0.2) == 0
    c.lib.sh_refit_wait(refit, 0.002)
    assert c.lib.sh_refit_is_due(refit, 100.0, 0.2) == 1
    c.lib.sh_refit_end(refit, listed, c.new("sh_signals"), 100.0, c.parameters({}))
    assert c.lib.sh_refit_is_due(refit, 14.0, 0.2) == 0


def test_noise_is_removed_from_inertia_and_torque(c: Library) -> None:
    """Rounding: 1 of the 1 + 4 of the inertia. Torque: 4 of the 1 + 8 of its column are noise
    without uncertainty, which leaves 1 + 4 / 2, as 4 and 4 are I^2 / (I + N) = 2."""
    refit, listed = c.new("sh_refit"), columns(c, {"DRIVE": 1.0, "INERTIA": 1.0})
    refit.posterior = posterior_of_prior(c, 2)[0]
    posterior = c.ffi.addressof(refit, "posterior")
    c.lib.sh_posterior_take(posterior, [1.0, 0.0, 0.0, 0.0], 2, 8.0)
    c.lib.sh_posterior_take(posterior, [0.0, 1.0, 0.0, 0.0], 2, 4.0)
    c.lib.sh_posterior_count_noise(posterior, 1.0, 0.0)
    noise = c.new("sh_column_noise", information=4.0)
    c.lib.sh_refit_remove_noise(refit, listed, noise, c.parameters({"prior.B": 0.1}))
    matrix, _ = normal_equations(refit.posterior.information)
    assert matrix == pytest.approx(np.diag([3.0, 4.0]))
