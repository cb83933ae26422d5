"""bank.c: what predicts a block better, the joint as before or another spring?"""

import numpy as np
import pytest

from c_library import Library
from c_parts import columns, normal_equations

KNOWN = 1e18
"""Number of blocks that were judged: one more does not change what is usual."""


SPRING_ALONE = 400 / 101
"""Squared error over variance of y = 20 with the prior alone: 20^2 / (1 + 10^2)."""


class Bank:
    """A bank of one column, the spring, which knows beta = 1 with the information 100."""

    def __init__(self, c: Library, past: float = 40.0) -> None:
        self.c, self.bank = c, c.new("sh_bank")
        self.columns = columns(c, {"POWER": 1.0}, spring=1, friction=1, inertia=1)
        c.lib.sh_bank_start(self.bank, 1)
        c.lib.sh_bank_count(self.bank, past)
        self.take(10.0)  # the hypothesis of another spring begins behind this block
        last = c.new("sh_last_row", D=100.0, z=[0.0, 1.0])
        for a in (self.bank.constant, self.bank.friction):
            c.lib.sh_information_set_last(c.ffi.addressof(a), last)

    def take(
        self, y: float, memory: float = 10.0, usual: float = 1.0, judged: float = KNOWN
    ) -> int:
        """Takes a block y = 10 beta of the variance 1. Returns what was found."""
        lib, bank, p = self.c.lib, self.bank, self.c.parameters({"regression.memory": memory})
        mean = self.c.new("sh_block_mean", x=[10.0, 0.0, y], w=1.0, count=1.0)
        lib.sh_bank_take_for_spring(bank, self.columns, [0.0], mean)
        lib.sh_bank_take_as_before(bank, mean)
        lib.sh_bank_take_for_friction(bank, mean)
        lib.sh_bank_count(bank, 1.0)
        found: int = lib.sh_bank_judge(bank, self.columns, [0.0], judged, usual, p)
        return found

    def knows(self) -> tuple[float, float]:
        """Information and right-hand side of the joint as before."""
        information, right = normal_equations(self.c.lib.sh_bank_present(self.bank))
        return information[0, 0], right[0, 1]


def test_blocks_of_the_same_spring_are_no_evidence(c: Library) -> None:
    """Each has the information 10^2 about beta = 1."""
    bank = Bank(c)
    for y in (10.0, 10.0):
        assert bank.take(y) == c.lib.SH_FOUND_NOTHING
        assert bank.bank.evidence == 0.0
    assert bank.knows() == pytest.approx((300.0, 300.0))


def test_three_blocks_of_a_doubled_spring(c: Library) -> None:
    """Each block adds z_0 - 2 z_1 - 2 to the evidence. The joint as before predicts 10, 15, 50/3:
    its errors 10, 5, 10/3 have the variances 1 + 100/100, 1 + 100/200, 1 + 100/300. The changed
    spring only predicts its first block; in the third, its error is 20/101 of 1 + 100/101."""
    bank, evidence = Bank(c), 0.0
    z_0 = (100 / 2, 25 / 1.5, (100 / 9) / (4 / 3))
    z_1 = (SPRING_ALONE, SPRING_ALONE, (20 / 101) ** 2 / (201 / 101))
    for before, changed in zip(z_0, z_1, strict=True):
        assert bank.take(20.0) == c.lib.SH_FOUND_NOTHING
        evidence += before - 2 * changed - 2
        assert bank.bank.evidence == pytest.approx(evidence)


def test_a_change_is_adopted(c: Library) -> None:
    """Three blocks of a tripled spring have the evidence 91. The joint is then the prior and the
    last two of them: 1 + 2 * 10^2, and 2 * 10 * 30."""
    bank = Bank(c)
    nothing, spring = c.lib.SH_FOUND_NOTHING, c.lib.SH_FOUND_SPRING
    assert [bank.take(30.0) for _ in range(3)] == [nothing, nothing, spring]
    c.lib.sh_bank_adopt(bank.bank, bank.columns, [0.0], spring)
    assert bank.knows() == pytest.approx((201.0, 600.0))
    assert (bank.bank.evidence, bank.bank.following) == (0.0, 1)
    c.lib.sh_bank_followed(bank.bank)
    assert bank.bank.following == 0


@pytest.mark.parametrize(("usual", "evidence"), [(1.0, 48.0), (1.25, 38.0), (4.0, 23.0)])
def test_one_block_alone_is_no_change(c: Library, usual: float, evidence: float) -> None:
    """Its evidence is at most max(50 / m, 25) - 2 with the usual misfit m. It also contradicts the
    changed spring, which then begins in this block, and is not in doubt."""
    bank = Bank(c)
    assert bank.take(1000.0, usual=usual) == c.lib.SH_FOUND_NOTHING
    assert bank.bank.evidence == pytest.approx(evidence)


def test_errors_count_in_usual_errors(c: Library) -> None:
    """A mean square of 4 is usual."""
    bank = Bank(c)
    bank.bank.level = 4.0
    bank.take(20.0)
    assert bank.bank.evidence == pytest.approx(50 / 4 - 2 * SPRING_ALONE / 4 - 2)


def test_the_usual_error_is_a_mean(c: Library) -> None:
    """The second of two blocks has the squared error 50, of which 9 * 4 count: 4 + (36 - 4) / 2."""
    bank = Bank(c)
    bank.bank.level = 4.0
    bank.take(20.0, judged=2.0)
    assert bank.bank.level == pytest.approx(20.0)


def test_the_hypothesis_of_another_spring_begins_anew_after_eighty_blocks(c: Library) -> None:
    bank = Bank(c)
    bank.bank.blocks = 79.0
    bank.take(20.0)
    assert (bank.bank.evidence, bank.bank.blocks) == (0.0, 0.0)


def test_no_change_is_looked_for_in_few_blocks(c: Library) -> None:
    """Up to 40, with the block that Bank takes."""
    for past, is_looked_for in ((37.9, False), (38.1, True)):
        bank = Bank(c, past)
        bank.take(20.0)
        assert (bank.bank.evidence > 0) == is_looked_for


def test_no_change_is_looked_for_without_memory(c: Library) -> None:
    bank = Bank(c)
    bank.take(20.0, memory=0.0)
    assert bank.bank.evidence == 0.0


def test_forgetting_halves_the_weights_of_blocks_and_prior(c: Library) -> None:
    bank = Bank(c)
    c.lib.sh_bank_forget(bank.bank, 0.5)
    assert bank.knows() == pytest.approx((50.0, 50.0))
    assert (bank.bank.count, bank.bank.prior) == (20.5, 0.5)


def test_at_most_two_thousand_blocks_are_kept(c: Library) -> None:
    """41 blocks and 4959 more are 5000: 2/5 of each are kept."""
    bank = Bank(c)
    c.lib.sh_bank_count(bank.bank, 4959.0)
    assert bank.bank.count == pytest.approx(2000.0)
    assert bank.knows() == pytest.approx((40.0, 40.0))


def test_a_curve_that_drifts_gets_less_certain(c: Library) -> None:
    """The variance 1/100 becomes 2/100."""
    bank = Bank(c)
    c.lib.sh_bank_drift(bank.bank, [1.0], 0.01)
    assert bank.knows() == pytest.approx((50.0, 50.0))


def test_the_torque_at_the_zero_of_the_encoders_may_change_with_the_spring(c: Library) -> None:
    """GIVEN 9 blocks that say bias 0.5, whose information with the prior is 10, and a bias of 0.4.
    Of another spring only the prior is known, and the bias has the variance 1/10 + 0.4^2 around
    9 * 0.5 / 10."""
    bank, mean = c.new("sh_bank"), c.new("sh_block_mean", x=[0.0, 1.0, 0.0, 0.5], w=9.0, count=9.0)
    listed = columns(c, {"POWER": 1.0, "BIAS": 1.0}, spring=1, friction=2, inertia=2)
    c.lib.sh_bank_start(bank, 2)
    c.lib.sh_bank_take_as_before(bank, mean)
    c.lib.sh_bank_count(bank, 41.0)
    bank.blocks = 80.0  # the hypothesis begins anew
    c.lib.sh_bank_judge(bank, listed, [0.0, 0.4], KNOWN, 1.0, c.parameters({}))
    information, right = normal_equations(bank.spring)
    widened = 1 / (1 / 10 + 0.4**2)
    np.testing.assert_allclose(information, np.diag([1.0, widened]), rtol=1e-12)
    np.testing.assert_allclose(right[:, 1], [0.0, widened * 0.45], rtol=1e-12)
