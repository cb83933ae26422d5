"""The library on controllers in QEMU, in double and in single precision."""

import os
import re
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from c_library import type_of_estimate
from c_sources import REPOSITORY
from controllers import HOST, TARGETS, Target, cross_build, replay, run
from gate import need
from reference_joints import table1_recording

PAPER, REGRESSION = "abcdef", "ghi"
"""Configurations of replay.c, by method."""
ROUNDING = {"double": 1e-10, "float": 1e-5}
"""Tolerance relative to the largest value: exp and sin of two C libraries may differ in their last
digit."""
MEMORY = {"double": 149 * 1024, "float": 75 * 1024}
"""Largest permitted memory of an instance of the largest size [bytes]."""
STACK = {"double": 5 * 1024, "float": 2.5 * 1024}
"""Largest permitted depth of the stack [bytes]."""

each_real = pytest.mark.parametrize("real", ["double", "float"])


@pytest.fixture(scope="session")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("controllers")


@cache
def cost(tree: Path) -> str:
    """Cost of a build of examples/controller: memory, stack, and instructions of a tick."""
    return run("cmake", "--build", str(tree), "--target", "cost")


@pytest.mark.parametrize("target", TARGETS.values(), ids=TARGETS)
@each_real
@pytest.mark.parametrize("configuration", PAPER + REGRESSION)
def test_a_processor_computes_what_the_host_computes(
    target: Target, real: str, configuration: str, build: Path, folder: Path, tmp_path: Path
) -> None:
    z = table1_recording().measurements()[:800].copy()
    z[550:570, 1] = np.nan  # lost
    z[433, 0] = 1e20  # too large
    estimate = type_of_estimate(build, real)
    here, there = (
        replay(cross_build("tests/replay", t, real, folder), z, configuration, tmp_path, estimate)
        for t in (HOST, target)
    )
    assert 0 < np.count_nonzero(here["valid"] == 0) < 30
    # Torque and stiffness of FilteredRegression are sums of up to 44 terms that nearly cancel.
    # These sums and their coefficients are therefore less exact than the other outputs.
    terms = 10 if configuration in REGRESSION else 1
    for name in here.dtype.names or ():
        factor = 2 * terms if name in ("eta", "tau_e", "sigma") else terms
        atol = factor * ROUNDING[real] * np.abs(here[name]).max()
        np.testing.assert_allclose(there[name], here[name], rtol=0, atol=atol, err_msg=name)


@pytest.mark.parametrize("configuration", "abcdeghi")  # not f: noise dominates it, also in double
def test_single_precision_gives_the_stiffness_of_table1(
    configuration: str, build: Path, folder: Path, tmp_path: Path
) -> None:
    z = table1_recording().measurements()
    single, double = (
        replay(
            cross_build("tests/replay", HOST, real, folder),
            *(z, configuration, tmp_path, type_of_estimate(build, real)),
        )
        for real in ("float", "double")
    )
    assert single["valid"].all()
    deviation = np.abs(single["sigma"][1000:] / double["sigma"][1000:] - 1).max()
    assert deviation < (1e-3 if configuration in PAPER else 3e-3)


# Without a unit for double, a tick of FilteredRegression takes longer than a millisecond.
@pytest.mark.parametrize(
    ("name", "real"), [("Cortex-M4F", "float"), ("Cortex-M7", "float"), ("Cortex-M7", "double")]
)
def test_the_example_estimates_its_stiffness_at_1_khz(name: str, real: str, folder: Path) -> None:
    tree = cross_build("examples/controller", TARGETS[name], real, folder)
    text = run("cmake", "--build", str(tree), "--target", "run")
    pattern = r"sigma = (\S+) N.m/rad, standard deviation (\S+)\n(\d+) ticks, (\d+) missed"
    printed = re.search(pattern, text)
    assert printed, text
    sigma, sigma_std = float(printed[1]), float(printed[2])
    assert abs(sigma - 150.0) < 1.96 * sigma_std < 0.1 * 150.0
    assert (int(printed[3]), int(printed[4])) == (3000, 0)


@pytest.mark.slow("a Cortex-M4F computes double in software")
@pytest.mark.parametrize("name", ["Cortex-M4F", "Cortex-M7"])
@each_real
def test_memory_and_stack_are_within_their_limits(name: str, real: str, folder: Path) -> None:
    text = cost(cross_build("examples/controller", TARGETS[name], real, folder))
    stacks = [int(value) for value in re.findall(r"stack (\d+) bytes", text)]
    (memory,) = re.findall(r"RAM: (\d+) bytes", text)
    assert len(stacks) == 3
    assert max(stacks) <= STACK[real], text
    assert int(memory) <= MEMORY[real], text


@pytest.mark.parametrize(
    ("n", "m", "columns", "row"),
    [
        (6, 3, 1, "Paper2011"),
        pytest.param(2, 1, 21, "FilteredRegression, all columns", marks=pytest.mark.complete),
        (3, 1, 6, "FilteredRegression, few columns"),
    ],
)
def test_smaller_sizes_cost_what_the_page_says(
    n: int, m: int, columns: int, row: str, folder: Path
) -> None:
    """The table of seven joints in docs/controller-cost.md. Another compiler may differ a little.

    The library rejects parameters that need more memory than it has.
    """
    sizes = (f"SH_MAX_N={n}", f"SH_MAX_M={m}", f"SH_MAX_COLUMNS={columns}")
    tree = cross_build("examples/controller", TARGETS["Cortex-M4F"], "float", folder, sizes)
    text = cost(tree)
    counted = re.search(rf"{row}: (\d+) instructions per tick, at most (\d+)", text)
    memory = re.search(r"RAM: (\d+) bytes", text)
    assert counted and memory, text
    page = (REPOSITORY / "docs" / "controller-cost.md").read_text(encoding="utf-8")
    (line,) = re.findall(rf"^\| {row} \| {n} x {m}, {columns} \|(.*)\|$", page, re.M)
    cells = [float(cell.strip(" %")) for cell in line.split("|")]
    mean, longest, joints = int(counted[1]), int(counted[2]), 7
    shares = (100 * joints * count / 168e3 for count in (mean, longest))
    expected = [mean, longest, *shares, joints * int(memory[1])]
    assert cells == pytest.approx(expected, rel=0.1)
    if columns == 6:
        assert re.search("all columns: .* compiled for at most 6 columns", text)


@each_real
def test_the_library_needs_only_memory_and_math_functions(real: str, folder: Path) -> None:
    """In single precision it also calls no function of the compiler for double."""
    tree = cross_build("tests/replay", TARGETS["Cortex-M4F"], real, folder)
    (library,) = tree.rglob("libsigmahat.a")
    symbols = run(need("arm-none-eabi-nm"), str(library))
    assert not re.findall(r" [DdBbCSs] \w+", symbols)  # no globals
    needed = set(re.findall(r" U (\w+)", symbols))
    own = set(re.findall(r" [TtRr] (\w+)", symbols))
    suffix = "f" if real == "float" else ""
    names = ("exp", "log", "sin", "cos", "floor", "sqrt", "fmin", "fmax")
    functions = {name + suffix for name in names}
    helpers = {f for f in needed if f.startswith("__aeabi_")} if real == "double" else set()
    assert needed - own - helpers <= functions | {"memcpy", "memmove", "memset"}


def test_the_commands_of_the_page_work(build: Path, tmp_path: Path) -> None:
    """Runs commands of docs/controller.md in a new folder, with our build tool."""
    for tool in TARGETS["Cortex-M4F"].tools:
        need(tool)
    for name in ("c", "cmake", "examples", "pyproject.toml"):
        (tmp_path / name).symlink_to(REPOSITORY / name)
    page = (REPOSITORY / "docs" / "controller.md").read_text(encoding="utf-8")
    blocks = re.findall(r"^```sh\n(.*?)^```$", page, re.M | re.S)
    assert len(blocks) == 2
    printed = run(
        *("sh", "-e", "-c", "".join(blocks)),
        cwd=tmp_path,
        environment={
            "CMAKE_GENERATOR": "Ninja",
            "PATH": f"{build / 'venv' / 'bin'}{os.pathsep}{os.environ['PATH']}",
            "PREFIX": str(tmp_path / "installed"),
        },
    )
    assert "sigma = " in printed
    assert "instructions per tick" in printed
    assert list((tmp_path / "installed").rglob("sigmahatConfig.cmake"))
