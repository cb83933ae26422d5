"""Runs of many ticks, compared with the same in higher precision. Longer ones: endurance.py."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import endurance
from c_programs import compiler_with
from endurance import BOUND, Case
from gate import need

INPUT_CYCLE = 10**5  # ticks; they contain all phases of the input


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    need("gcc")
    return tmp_path_factory.mktemp("endurance")


@pytest.fixture(scope="module")
def program(folder: Path) -> Path:
    return endurance.compile_program(folder, "double")


@pytest.fixture(scope="module")
def extended(folder: Path) -> Path:
    if np.finfo(np.longdouble).eps > 1e-18:
        pytest.skip("long double holds no more digits than double here")
    return endurance.compile_program(folder, "long double")


@pytest.mark.slow("a million ticks, in double and in the slower long double")
@pytest.mark.parametrize(
    "method,n,m,torque", [(1, 1, 1, 1e6), (1, 6, 3, 1e6), (2, 1, 1, 1e3), (2, 3, 3, 1e3)]
)
def test_a_million_ticks_agree_with_those_in_long_double(
    folder: Path, program: Path, extended: Path, method: int, n: int, m: int, torque: float
) -> None:
    case = Case(method, n, m, torque, 10**6, 10**6)
    largest, output = endurance.compare(case, program, extended, folder)
    assert largest < BOUND, output


@pytest.mark.slow("quadruple precision is computed in software")
@pytest.mark.parametrize("method", endurance.METHODS)
def test_long_double_is_much_more_precise_than_the_bound(
    folder: Path, extended: Path, method: int
) -> None:
    quad = endurance.compile_program(folder, "quad")
    case = Case(method, 2, 1, 1e3, INPUT_CYCLE, INPUT_CYCLE)
    largest, output = endurance.compare(case, extended, quad, folder)
    assert largest < BOUND / 1000.0, output


@pytest.mark.slow("the library is compiled with sanitizers, and runs slower with them")
@pytest.mark.parametrize("n,m", [(1, 1), (8, 5)])
@pytest.mark.parametrize("method", endurance.METHODS)
def test_sanitizers_find_no_undefined_behaviour(folder: Path, method: int, n: int, m: int) -> None:
    flags = ("-fsanitize=address,undefined,float-cast-overflow", "-fno-sanitize-recover=all")
    compiler = compiler_with(flags, folder)
    program = endurance.compile_program(folder, "double", compiler, flags)
    checkpoints = endurance.run(
        program, Case(method, n, m, 1e6, 0, 0), INPUT_CYCLE, folder / f"{method}_{n}"
    )
    assert checkpoints[-1][0] == INPUT_CYCLE
