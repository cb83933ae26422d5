"""Ranges of parameters that are arrays."""

from __future__ import annotations

import math
from pathlib import Path

import pytest

from c_library import Library, load


@pytest.fixture(scope="module")
def c(build: Path) -> Library:
    return load(build)


@pytest.mark.parametrize("i", range(8))
@pytest.mark.parametrize("j", range(5))
def test_every_initial_coefficient_must_be_finite(c: Library, i: int, j: int) -> None:
    p = c.parameters({})
    p.rls.eta_0[i][j] = math.inf
    assert c.violation(p) == ("rls.eta_0", math.inf, "finite")
