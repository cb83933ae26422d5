"""Runs of many ticks beside the same in higher precision; the long ones are in endurance.py."""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest

import endurance
from c_programs import compiler_with
from endurance import BOUND, Case, Result
from gate import missing


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    if shutil.which("gcc") is None:
        missing("gcc", "apt-get install gcc")
    return tmp_path_factory.mktemp("endurance")


@pytest.fixture(scope="module")
def program(folder: Path) -> Path:
    return endurance.compile_program(folder, "double")


@pytest.fixture(scope="module")
def extended(folder: Path) -> Path:
    if np.finfo(np.longdouble).eps > 1e-18:
        pytest.skip("long double holds no more digits than double here")
    return endurance.compile_program(folder, "long double")


@pytest.mark.parametrize("n,m", [(1, 1), (6, 3)])
@pytest.mark.parametrize("method", endurance.METHODS)
def test_a_million_ticks_are_those_of_long_double(
    program: Path, extended: Path, method: int, n: int, m: int
) -> None:
    result = endurance.compare(Case(method, n, m, 10**6, 10**6), program, extended)
    assert result.run[-1][0] == 10**6
    difference, output = result.difference()
    assert difference < BOUND, output


@pytest.mark.parametrize("method", endurance.METHODS)
def test_long_double_has_digits_to_spare(folder: Path, extended: Path, method: int) -> None:
    # 1e5 ticks are one turn through all phases of the input.
    quad = endurance.compile_program(folder, "quad")
    result = endurance.compare(Case(method, 2, 1, 10**5, 10**5), extended, quad)
    difference, output = result.difference()
    assert difference < BOUND / 1000.0, output


@pytest.mark.parametrize("n,m", [(1, 1), (8, 5)])
@pytest.mark.parametrize("method", endurance.METHODS)
def test_no_undefined_behaviour(folder: Path, method: int, n: int, m: int) -> None:
    flags = ("-fsanitize=address,undefined,float-cast-overflow", "-fno-sanitize-recover=all")
    compiler = compiler_with(flags, folder)
    program = endurance.compile_program(folder, "double", compiler, flags)
    command = [str(program), *(str(number) for number in (method, n, m, 10**5))]
    done = subprocess.run(command, capture_output=True, text=True)
    assert done.returncode == 0 and done.stderr == "", done.stderr


def test_a_difference_is_seen() -> None:
    first = [np.longdouble(number) for number in (10, 1, 2, 3, 4, 5, 6, 7, 8)]
    second = [np.longdouble(13), *first[1:]]
    other = [*second[:3], second[3] * (1 + 1e-6), *second[4:]]
    difference, output = Result([first, second], [first, other]).difference()
    assert output == "sigma_std"
    assert difference == pytest.approx(1e-6, rel=1e-3)
