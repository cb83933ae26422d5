"""The library against the list of variables: names, start values, ranges, and its table in C."""

import math
from collections.abc import Iterator
from operator import attrgetter
from pathlib import Path
from typing import Any

import fmpy
import pytest

import sigmahat
from c_library import Library
from c_sources import REPOSITORY
from fmi_runs import limits
from sigmahat_build import parameter_table


@pytest.fixture(scope="module")
def listed() -> list[Any]:
    """Parameters and outputs, without those in arrays."""
    fmu = sigmahat.fmu("StiffnessEstimator")
    found: list[Any] = fmpy.read_model_description(str(fmu)).modelVariables
    return [v for v in found if v.causality != "input" and "[" not in v.name]


def test_the_table_in_c_is_made_from_the_list(tmp_path: Path) -> None:
    """If not: cmake --build build --target parameter_table."""
    made, name = tmp_path / "parameters.inc", "StiffnessEstimator.xml"
    parameter_table.write(REPOSITORY / "modelDescription" / name, made)
    assert (REPOSITORY / "c" / "parameters.inc").read_bytes() == made.read_bytes()


def fields(c: Library, struct: Any, prefix: str = "") -> Iterator[str]:
    """Dotted names of the numbers in a struct, with the names of the enclosing structs."""
    for name, field in struct.fields:
        if field.type.kind == "struct":
            yield from fields(c, field.type, f"{prefix}{name}.")
        else:
            yield prefix + name


@pytest.mark.parametrize(
    ("struct", "causality", "array"),
    [("sh_parameters", "parameter", "rls.eta_0"), ("sh_estimate", "output", "eta")],
)
def test_a_struct_has_the_fields_of_the_list(
    struct: str, causality: str, array: str, c: Library, listed: list[Any]
) -> None:
    expected = [array, *(v.name for v in listed if v.causality == causality)]
    assert sorted(fields(c, c.ffi.typeof(struct))) == sorted(expected)


def test_start_values_and_ranges_are_those_of_the_list(c: Library, listed: list[Any]) -> None:
    """The check accepts the limit of each parameter, and rejects values outside the limit."""
    for variable in (v for v in listed if v.causality == "parameter"):
        p: Any = c.parameters({})  # it owns the memory of its parts
        value = attrgetter(variable.name)(p)
        boolean = variable.type == "Boolean"
        start = ("false", "true").index(variable.start) if boolean else float(variable.start)
        assert value == start, variable.name
        kind = float if variable.type == "Real" else int
        edges = [("", 0, -1), ("", 1, 2)] if boolean else list(limits(variable))
        assert len(edges) == 2
        for _, limit, beyond in edges:
            found = c.violation(c.parameters({variable.name: kind(beyond)}))
            assert found is not None and found[:2] == (variable.name, beyond)
            if math.isfinite(limit):
                found = c.violation(c.parameters({variable.name: kind(limit)}))
                assert found is None or "<" in found[2], found  # a limit by other parameters
        if kind is float:
            found = c.violation(c.parameters({variable.name: math.nan}))
            assert found is not None and found[0] == variable.name


@pytest.mark.parametrize("i", range(8))
@pytest.mark.parametrize("j", range(5))
def test_every_initial_coefficient_must_be_finite(c: Library, i: int, j: int) -> None:
    p = c.parameters({})
    p.rls.eta_0[i][j] = math.inf
    assert c.violation(p) == ("rls.eta_0", math.inf, "finite")


@pytest.mark.parametrize("period", [1e-9, 1e-4, 1 / 350, 1 / 320, 0.01, 3.0])
@pytest.mark.parametrize("method", [1, 2])
def test_the_sample_period_alone_is_enough(period: float, method: int, c: Library) -> None:
    """Rates start at most at one per sample; no other start value depends on the period."""
    followed, usual = (c.ffi.new("sh_parameters *") for _ in range(2))
    c.lib.sh_parameters_default_at(followed, period)
    c.lib.sh_parameters_default(usual)
    for name in fields(c, c.ffi.typeof("sh_parameters")):
        start, value = (attrgetter(name)(p) for p in (usual, followed))
        if name == "samplePeriod":
            assert value == pytest.approx(period, rel=1e-6)
        elif name in ("residual.K_I", "regression.bandwidth"):
            assert value == pytest.approx(min(start, 1 / period), rel=1e-6)
        elif name != "rls.eta_0":
            assert value == start
    if period > 1e-6:  # with a shorter one, w T is below 1e-4
        followed.method = method
        assert c.violation(followed) is None
