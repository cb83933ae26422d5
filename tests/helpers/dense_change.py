"""The hypotheses of a change in numpy; C code: c/filtered_regression/bank.c."""

from copy import deepcopy
from typing import TYPE_CHECKING

import numpy as np

from oracle import solve

if TYPE_CHECKING:
    from dense_regression import Blocks, Information, Long


def squared_error(sums: "Information", row: "Long", variance: float) -> float:
    """Squared prediction error of y in a row, divided by the variance of this error."""
    n = sums.size
    A, x = sums.matrix[:n, :n], row[:n]
    error = row[-1] - x @ solve(A, sums.matrix[:n, -1:])[:, 0]
    return float(error**2 / (variance + x @ solve(A, x[:, None])[:, 0]))


class Change:
    """Whether the spring, or friction, has changed: never in the runs of the oracle."""

    def __init__(self, sums: "Information", spring: int, bias: int | None, friction: slice) -> None:
        """spring, bias, friction  columns: the number of the first ones, and the others"""
        self.changed, self.spring, self.friction = deepcopy(sums), spring, friction
        self.bias = bias
        self.level, self.usual_misfit, self.judged = 1.0, 1.0, 0
        self.evidence, self.blocks = 0.0, 80
        self.friction_blocks, self.preference = 0, 0.0
        self.left = 0  # columns of friction that do not have the variance of their prior yet
        self.was_tested = False  # whether other friction has ever been a hypothesis
        self.before = self.of_spring = self.of_friction = 0.0  # squared errors

    def begin(self, blocks: "Blocks", friction_drifts: bool, beta: "Long") -> None:
        self.changed = deepcopy(blocks.walking if friction_drifts else blocks.all)
        self.changed.restart(self.spring, blocks.prior)
        if self.bias is not None:
            unit = np.eye(self.changed.size, dtype=np.longdouble)[self.bias]
            self.changed.walk(unit, float(beta[self.bias] ** 2))
        self.evidence, self.blocks = 0.0, 0

    def take(
        self,
        row: "Long",
        variance: float,
        blocks: "Blocks",
        friction_drifts: bool,
        beta: "Long",
    ) -> None:
        """Updates this hypothesis by a block that the other hypotheses have not taken yet."""
        before = squared_error(blocks.all, row, variance)
        self.of_friction = squared_error(blocks.walking, row, variance)
        self.before = self.of_friction if friction_drifts else before
        self.of_spring = squared_error(self.changed, row, variance)
        if self.blocks > 0:
            self.changed.take(row, 1 / variance)
        if self.of_spring > 12.5 * self.level and self.evidence <= 50:
            self.begin(blocks, friction_drifts, beta)
            self.of_spring = 0.0

    def judge(
        self, misfit: float, blocks: "Blocks", friction_drifts: bool, measured: bool, beta: "Long"
    ) -> bool:
        """Returns whether the hypothesis of other friction begins: friction then drifts no more."""
        level = self.level
        self.judged = min(self.judged + 1, 400)
        self.level = max(1, level + (min(self.before, 9 * level) - level) / self.judged)
        most = min(misfit, 1.7 * self.usual_misfit)
        self.usual_misfit += (most - self.usual_misfit) / self.judged
        if blocks.past < 40:
            return False
        if self.friction_blocks > 1 and self.blocks > 0:
            self.preference += min(self.of_friction / level, 50) - min(self.of_spring / level, 50)
        self.friction_blocks += self.friction_blocks > 0
        self.blocks += 1
        against = min(self.before / level, max(50 / self.usual_misfit, 25))
        gain = against - 2 * min(self.of_spring / level, 12.5) - 2
        self.evidence = max(self.evidence + gain, 0.0)
        assert self.evidence <= 75 * np.sqrt(level), "a change: the oracle does not follow it"
        if self.evidence <= 0 or self.blocks >= 80:
            if self.friction_blocks > 0 and self.preference >= -25:
                blocks.walking = deepcopy(blocks.all)
            self.friction_blocks = self.left = 0
            self.begin(blocks, friction_drifts, beta)
        elif self.evidence > 20 and self.friction_blocks == 0 and not measured:
            if friction_drifts:
                blocks.all = deepcopy(blocks.walking)
            columns = range(self.friction.start, self.friction.stop)
            for unit in np.eye(blocks.walking.size)[columns]:
                blocks.walking.walk(unit.astype(np.longdouble), 1.0)
            self.friction_blocks, self.preference, self.was_tested = 1, 0.0, True
            self.left = len(columns)
            return True
        return False
