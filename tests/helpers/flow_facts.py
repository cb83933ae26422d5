"""What is known about the loops of the library: the file tests/proof/bounds.toml."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import tomlkit

import c_loops
from arm_code import Instruction
from control_flow import Graph, NaturalLoop

BOUNDS = Path(__file__).resolve().parents[1] / "proof" / "bounds.toml"


@dataclass(frozen=True)
class Sizes:
    """The names that a bound may contain."""

    N: int
    """SH_MAX_N."""
    M: int
    """SH_MAX_M."""
    n: int
    """rls.n."""
    m: int
    """rls.m."""
    columns: int
    """Columns of FilteredRegression."""
    real: int
    """Bytes of a number."""


@dataclass(frozen=True)
class Total:
    """Rounds of a loop in all rounds of another one that is around it, or in a function."""

    loop: str
    over: str
    most: str


@dataclass(frozen=True)
class Limit:
    """How often a function runs in all rounds of a loop."""

    function: str
    over: str
    most: str


@dataclass(frozen=True)
class Facts:
    """The contents of the file. Bounds are formulas of Sizes."""

    loops: dict[str, str]
    """Rounds by loop, as c_loops names it."""
    totals: tuple[Total, ...]
    limits: tuple[Limit, ...]
    copies: dict[str, str]
    """Bytes that memcpy, memmove or memset treats, by the function of c/ that calls it."""
    library: dict[str, str]
    """Rounds of the loops of the C library and of the compiler's functions: by file and line."""
    pointers: dict[str, str]
    """Function that is called through a pointer, by the one that does it."""

    def value(self, formula: str, sizes: Sizes, copied: int = 0) -> float:
        """Value of a formula."""
        names: dict[str, Any] = {**asdict(sizes), "copied": copied}
        names |= {"sum": sum, "range": range, "max": max, "min": min}
        value = eval(formula, {"__builtins__": {}} | names)
        assert isinstance(value, int) and value >= 0, f"{formula} = {value}"
        return float(value)

    def name_of(self, graph: Graph, loop: NaturalLoop) -> str:
        """Which loop of the source a loop of the machine code is; in other libraries file and line.

        It is the one whose condition ends the loop. If there are several, it is that of no inner
        loop, and evaluated in each round. (It need not be if there is one: the compiler leaves out
        what is known to be true.)
        """
        inner = frozenset[int]().union(
            *(it.blocks for it in graph.loops if it.blocks < loop.blocks)
        )
        ends = {it for it in loop.blocks if not loop.blocks.issuperset(graph.blocks[it].following)}
        tests: dict[str, set[int]] = {}
        for block in ends - inner or ends:
            tests.setdefault(_condition(graph, block), set()).add(block)
        found = tests.keys() & (self.loops.keys() | self.library.keys())
        if len(found) > 1:
            found = {name for name in found if not graph.goes_round(loop, tests[name])}
        if len(found) > 1:
            inner_loops = [it for it in graph.loops if it.blocks < loop.blocks]
            found -= {self.name_of(graph, it) for it in inner_loops}
        where = f"{loop.header:x} in {graph.begin:x}"
        assert found, f"no bound is known for the loop at {where}, with the conditions {set(tests)}"
        if found <= self.library.keys():  # one of them is right: which one does not matter
            return max(found, key=lambda name: (self.library[name].zfill(9), name))
        assert len(found) == 1, f"the loop at {where} has several conditions: {found}"
        # Two loops that begin at one instruction would be one here, with the bound of the outer.
        deciding = {block for block, _ in loop.back if len(graph.blocks[block].following) > 1}
        again = {_condition(graph, block) for block in deciding} & self.loops.keys()
        assert len(loop.back) == 1 or again <= found, f"several loops begin at {where}: {again}"
        return found.pop()

    def rounds(self, name: str, sizes: Sizes, copied: int) -> float:
        """Largest number of rounds of a loop."""
        return self.value({**self.library, **self.loops}[name], sizes, copied)

    def copied(self, call: Instruction, callee: str, sizes: Sizes) -> int:
        """Number of bytes that a call of memcpy, memmove or memset treats; 0 for other calls."""
        if callee not in ("memcpy", "memmove", "memset"):
            return 0
        function = c_loops.function_at(call.places[0].file, call.places[0].line)
        assert function is not None, f"{callee} is called outside of c/: {call}"
        return int(self.value(self.copies[function.name], sizes))


def _condition(graph: Graph, block: int) -> str:
    """The loop whose head is the line of the last instruction of a block; else file and line."""
    place = graph.blocks[block].instructions[-1].places[0]
    own = c_loops.loop_at(place.file, place.line)
    return own.name if own else f"{place.file}:{place.line}"


def read_facts(method: str) -> Facts:
    """Reads the file, for an estimator of this method: "paper2011" or "filtered_regression"."""
    data = tomlkit.parse(BOUNDS.read_text(encoding="utf-8")).unwrap()
    return Facts(
        data["loops"],
        tuple(Total(**it) for it in data["totals"]),
        tuple(Limit(**it) for it in data["limits"]),
        data["copies"],
        data["library"],
        {caller: targets[method] for caller, targets in data["pointers"].items()},
    )
