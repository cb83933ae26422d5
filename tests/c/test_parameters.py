"""Defaults against the start values of the FMU, and the ranges of the coefficients eta_0."""

from __future__ import annotations

import math
from pathlib import Path

import fmpy
import pytest

from c_library import Library, load


@pytest.fixture(scope="module")
def c(build: Path) -> Library:
    return load(build)


def test_defaults_are_the_start_values_of_the_fmu(c: Library, estimator_fmu: Path) -> None:
    p = c.parameters({})
    variables = fmpy.read_model_description(str(estimator_fmu)).modelVariables
    compared = 0
    for variable in variables:
        if variable.causality != "parameter" or "[" in variable.name:
            continue
        value = p
        for name in variable.name.split("."):
            value = getattr(value, name)
        switch = {"true": 1.0, "false": 0.0}
        start = switch[variable.start] if variable.start in switch else float(variable.start)
        assert value == pytest.approx(start, rel=1e-12, abs=0.0), variable.name
        compared += 1
    assert compared > 40


@pytest.mark.parametrize("i", range(8))
@pytest.mark.parametrize("j", range(5))
def test_every_initial_coefficient_must_be_finite(c: Library, i: int, j: int) -> None:
    p = c.parameters({})
    p.rls.eta_0[i][j] = math.inf
    assert c.violation(p) == ("rls.eta_0", math.inf, "finite")
