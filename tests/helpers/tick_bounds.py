"""Bounds of a tick on a controller: what tests/proof/test_bounds.py and the page compare."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

from arm_code import Program, read_program
from arm_stack import Stack
from control_flow import Graph
from controllers import TARGETS, cross_build, run
from flow_facts import Sizes, read_facts
from longest_path import LongestPath
from program_functions import Functions

METHODS = {"paper2011": "Paper2011", "filtered_regression": "FilteredRegression"}
REDUCTION = {"float": "__kernel_rem_pio2f", "double": "__kernel_rem_pio2"}
"""The function of newlib that sin and cos call for angles above 201 rad, in double 823549 rad."""
N, M, COLUMNS = 8, 5, 64
"""SH_MAX_N, SH_MAX_M and SH_MAX_COLUMNS, if nothing else is given to the compiler."""
DEFAULT = {"paper2011": (6, 3, 0), "filtered_regression": (6, 3, 40)}
"""Orders and columns of the start values."""
LARGEST = {"paper2011": (N, M, 0), "filtered_regression": (N, M, COLUMNS)}
"""Those of the largest estimator; with 8 x 5 there are 61 columns, with every prior above 0."""


@dataclass(frozen=True)
class Bounds:
    """What a tick can need at most."""

    instructions: int
    instructions_small: int
    """If sin and cos get no large angle."""
    stack: int
    """With all that is called [bytes]."""
    stack_small: int


def build_ticks(target: str, real: str, ninja: Path, folder: Path) -> Path:
    """Builds tests/proof/ticks as the library is built for a release, with debug information."""
    flags = "CMAKE_C_FLAGS_RELEASE=-O3 -DNDEBUG -g -fstack-usage"
    return cross_build("tests/proof/ticks", TARGETS[target], real, ninja, folder, (flags,))


def frames(tree: Path) -> dict[str, int]:
    """Stack of each function alone, as the compiler reports it [bytes]."""
    found = {}
    for file in tree.rglob("*.su"):
        for line in file.read_text().splitlines():
            where, size, kind = line.split("\t")
            assert kind == "static", line  # and not known at run time only
            found[where.rpartition(":")[2]] = int(size)
    return found


@dataclass
class Analysis:
    """A program, whose bounds can be computed for estimators of any size."""

    program: Program
    real: str
    graphs: dict[int, Graph] = field(default_factory=dict)
    names: dict[tuple[int, int], str] = field(default_factory=dict)

    @classmethod
    def of(cls, tree: Path, real: str) -> Analysis:
        """Analysis of a build of tests/proof/ticks."""
        return cls(read_program(tree / "ticks"), real)

    def functions(self, method: str, size: tuple[int, int, int], *, small: bool) -> Functions:
        """The functions, for n, m and the number of columns."""
        n, m, columns = size
        sizes = Sizes(N, M, n, m, columns, real=4 if self.real == "float" else 8)
        without = frozenset({REDUCTION[self.real]} if small else ())
        facts = read_facts(method)
        known = (self.graphs, self.names)
        return Functions(self.program, facts, sizes, self.real, without, *known)

    def bounds(self, method: str, size: tuple[int, int, int]) -> Bounds:
        """Bounds of a tick."""
        tick = self.program.address("sh_estimator_tick")
        instructions, stacks = [], []
        for small in (False, True):
            functions = self.functions(method, size, small=small)
            instructions.append(round(LongestPath(functions).of(tick)))
            stacks.append(Stack(functions).depth(tick)[1])
        return Bounds(*instructions, *stacks)


def longest_measured(tree: Path) -> dict[tuple[str, int], int]:
    """Runs a build of tests/proof/ticks: instructions of the longest tick, by method and rls.n."""
    command = [part for part in (tree / "emulator.txt").read_text().split(";") if part]
    text = run(*command, str(tree / "ticks"))
    lines = re.findall(r"^(\w+) (\d+) (\d+) (\d+) (\d+)$", text, re.M)
    assert len(lines) == 4, text
    for method, n, m, columns, _ in lines:
        expected = DEFAULT[method] if int(n) < N else (N, M, 61 if int(columns) else 0)
        assert (int(n), int(m), int(columns)) == expected, text
    return {(method, int(n)): int(longest) for method, n, _, _, longest in lines}


def rows(analysis: Analysis, measured: dict[tuple[str, int], int] | None) -> Iterator[list[str]]:
    """The rows of the table of the page for one processor, as label, quantity and number."""
    for configuration in (DEFAULT, LARGEST):
        for method, size in configuration.items():
            n, m, columns = size
            label = f"{METHODS[method]}, {n} x {m}" + (f", {columns} columns" if columns else "")
            bounds = analysis.bounds(method, size)
            yield [label, "at most", str(bounds.instructions)]
            yield [label, "at most, small angles", str(bounds.instructions_small)]
            if measured is not None:
                yield [label, "longest measured", str(measured[method, n])]
            if configuration is LARGEST:
                yield [f"stack, {METHODS[method]}", "at most", str(bounds.stack)]
                yield [
                    f"stack, {METHODS[method]}",
                    "at most, small angles",
                    str(bounds.stack_small),
                ]
