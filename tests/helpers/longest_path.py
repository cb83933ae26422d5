"""The largest number of instructions that a function of a program can execute.

This is the method of implicit path enumeration (Li and Malik 1995): how often each edge of the
control flow graph is taken is an unknown of a linear program. What enters a block leaves it, a loop
makes no more rounds than its bound, and the sum of all instructions becomes as large as possible.
Counts need not be whole numbers in it, which can only make the result larger.

The functions of c/ are put into the place of their calls, so that a bound can hold for several of
them together. Those of other libraries count with their own largest number.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np
from scipy.optimize import linprog
from scipy.sparse import csr_array

import c_loops
from arm_code import Instruction, Program
from control_flow import Graph, NaturalLoop, read_graph
from flow_facts import Facts, Sizes

Sum = dict[int, float]
"""Coefficients of unknowns."""


@dataclass
class Call:
    """One place where a function runs, and the unknowns that count its edges."""

    graph: Graph
    caller: Call | None
    block: int
    """Block of the caller; 0 if there is none."""
    edges: dict[tuple[int, int], int] = field(default_factory=dict)
    entry: int = 0

    def count(self, block: int) -> Sum:
        """How often a block is executed."""
        into = {i: 1.0 for (_, to), i in self.edges.items() if to == block}
        return into | ({self.entry: 1.0} if block == self.graph.begin else {})

    def rounds(self, loop: NaturalLoop) -> Sum:
        """How often a loop goes back to its begin."""
        return {self.edges[edge]: 1.0 for edge in loop.back}

    def entries(self, loop: NaturalLoop) -> Sum:
        """How often a loop begins."""
        back = self.rounds(loop)
        return {i: 1.0 for i in self.count(loop.header) if i not in back}


@dataclass
class LongestPath:
    """The longest paths of the functions of a program, for estimators of some size."""

    program: Program
    facts: Facts
    sizes: Sizes
    real: str
    without: frozenset[str] = frozenset()
    """Functions that are known not to be called."""
    graphs: dict[int, Graph] = field(default_factory=dict)
    names: dict[tuple[int, int], str] = field(default_factory=dict)
    known: dict[tuple[int, int], float] = field(default_factory=dict)

    def graph(self, address: int) -> Graph:
        """Control flow graph of a function."""
        if address not in self.graphs:
            self.graphs[address] = read_graph(self.program, address)
        return self.graphs[address]

    def name(self, address: int) -> str:
        """Name of a function; what the compiler appends to it is left out."""
        return self.program.names.get(address, f"at {address:x}").partition(".")[0]

    def of_function(self, address: int, copied: int = 0) -> float:
        """Largest number of instructions of a call.

        copied  number of bytes, for memcpy, memmove and memset
        """
        if (address, copied) not in self.known:
            self.known[address, copied] = _Program(self, address, copied).solve()
        return self.known[address, copied]

    def name_of(self, graph: Graph, loop: NaturalLoop) -> str:
        """Which loop of the source a loop of the machine code is."""
        key = (graph.begin, loop.header)
        if key not in self.names:
            self.names[key] = self.facts.name_of(graph, loop)
        return self.names[key]

    def callees(self, graph: Graph) -> Iterator[tuple[int, Instruction, int]]:
        """The calls in a function: block, instruction, address of the other function."""
        for name, block in graph.blocks.items():
            for instruction in block.instructions:
                called = instruction.calls
                if called is not None and self.name(called) not in self.without:
                    yield name, instruction, called
                if instruction.calls_pointer:
                    target = self.facts.pointers[self.name(graph.begin)]
                    yield name, instruction, self.program.address(target)

    def is_own(self, address: int) -> bool:
        """Whether a function is one of c/."""
        places = self.program.instructions[address].places
        return bool(places) and c_loops.function_at(places[-1].file, places[-1].line) is not None

    def has_loops(self, address: int) -> bool:
        """Whether there is a loop in a function of c/ or in one that it calls."""
        graph = self.graph(address)
        return self.is_own(address) and (
            bool(graph.loops) or any(self.has_loops(it) for _, _, it in self.callees(graph))
        )


class _Program:
    """The linear program of one function."""

    def __init__(self, paths: LongestPath, address: int, copied: int) -> None:
        self.paths, self.copied = paths, copied
        self.gain: list[float] = []
        self.equal: list[tuple[Sum, float]] = []
        self.at_most: list[Sum] = []
        self.calls: list[Call] = []
        self._add(address, None, 0)
        self.equal.append(({self.calls[0].entry: 1.0}, 1.0))
        for call in self.calls:
            for loop in call.graph.loops:
                self._bound(call, loop)
        self._total()
        self._limit()

    def solve(self) -> float:
        """The largest number."""
        size = len(self.gain)
        result = linprog(
            -np.array(self.gain),
            A_ub=_matrix(self.at_most, size),
            b_ub=np.zeros(len(self.at_most)),
            A_eq=_matrix([row for row, _ in self.equal], size),
            b_eq=[right for _, right in self.equal],
            method="highs",
        )
        assert result.status == 0, result.message
        return float(-result.fun)

    def _new(self) -> int:
        self.gain.append(0.0)
        return len(self.gain) - 1

    def _add(self, address: int, caller: Call | None, block: int) -> None:
        """Adds a call with all that it calls."""
        call = Call(self.paths.graph(address), caller, block)
        self.calls.append(call)
        call.entry = self._new()
        if caller is not None:
            count = caller.count(block)
            self.equal.append(({i: -it for i, it in count.items()} | {call.entry: 1.0}, 0.0))
        for name, it in call.graph.blocks.items():
            for after in it.following:
                call.edges[name, after] = self._new()
        for name, it in call.graph.blocks.items():
            if it.following:
                out = {call.edges[name, after]: -1.0 for after in it.following}
                count = call.count(name)
                both = set(out) | set(count)
                flow = {i: out.get(i, 0.0) + count.get(i, 0.0) for i in both}
                self.equal.append((flow, 0.0))
            self._gain(call, name, len(it.instructions))
        for name, instruction, callee in list(self.paths.callees(call.graph)):
            if self.paths.has_loops(callee):
                self._add(callee, call, name)
            else:
                copied = self.paths.facts.copied(instruction, self.paths.name(callee), self.paths)
                self._gain(call, name, self.paths.of_function(callee, copied))

    def _gain(self, call: Call, block: int, instructions: float) -> None:
        for i in call.count(block):
            self.gain[i] += instructions

    def _bound(self, call: Call, loop: NaturalLoop) -> None:
        facts, sizes = self.paths.facts, self.paths.sizes
        name = self.paths.name_of(call.graph, loop)
        most = facts.rounds(name, sizes, self.copied)
        # The compiler may have made two loops of one, which have its rounds together.
        same = [
            inner
            for inner in call.graph.loops
            if inner.blocks <= loop.blocks and self.paths.name_of(call.graph, inner) == name
        ]
        rounds: Sum = {}
        for inner in same:
            rounds |= call.rounds(inner)
        self._at_most(rounds, most, call.entries(loop))

    def _total(self) -> None:
        """Rounds of all loops that were made of one, in all rounds of one around them."""
        facts = self.paths.facts
        for total in facts.totals:
            sums: dict[tuple[int, ...], tuple[Sum, Sum]] = {}
            for call in self.calls:
                for loop in call.graph.loops:
                    if self.paths.name_of(call.graph, loop) == total.loop:
                        outer = self._around(call, loop, total.over)
                        if outer is not None:
                            rounds, _ = sums.setdefault(tuple(outer), ({}, outer))
                            rounds |= call.rounds(loop)
            for rounds, outer in sums.values():
                self._at_most(rounds, facts.value(total.most, self.paths.sizes), outer)

    def _around(self, call: Call, loop: NaturalLoop | None, name: str, block: int = 0) -> Sum | None:
        """How often the loop, or function, of this name begins that is around a loop, or block."""
        here: Call | None = call
        inside = loop.blocks if loop is not None else frozenset({block})
        while here is not None:
            found = [
                it
                for it in here.graph.loops
                if inside <= it.blocks and self.paths.name_of(here.graph, it) == name
            ]
            if found:
                return here.entries(found[-1])
            if self.paths.name(here.graph.begin) == name:
                return {here.entry: 1.0}
            inside, here = frozenset({here.block}), here.caller
        return None

    def _limit(self) -> None:
        """Functions that run only a few times in all rounds of a loop."""
        facts, suffix = self.paths.facts, "f" if self.paths.real == "float" else ""
        for limit in facts.limits:
            sums: dict[tuple[str, tuple[int, ...]], tuple[Sum, Sum]] = {}
            for what, count, outer in self._executions(limit.function, suffix, limit.over):
                total, _ = sums.setdefault((what, tuple(outer)), ({}, outer))
                for i, it in count.items():
                    total[i] = total.get(i, 0.0) + it
            for total, outer in sums.values():
                self._at_most(total, facts.value(limit.most, self.paths.sizes), outer)

    def _executions(self, function: str, suffix: str, over: str) -> Iterator[tuple[str, Sum, Sum]]:
        """Calls of a function, and begins of its loops, where it was put into another one."""
        for call in self.calls:
            for block, _, callee in self.paths.callees(call.graph):
                outer = self._around(call, None, over, block)
                if self.paths.name(callee) in (function, function + suffix) and outer:
                    yield "", call.count(block), outer
            for loop in call.graph.loops:
                name = self.paths.name_of(call.graph, loop)
                outer = self._around(call, loop, over)
                inner = any(
                    loop.blocks < it.blocks
                    and self.paths.name_of(call.graph, it).startswith(f"{function}: ")
                    for it in call.graph.loops
                )
                if name.startswith(f"{function}: ") and outer and not inner:
                    yield name, call.entries(loop), outer

    def _at_most(self, rounds: Sum, most: float, entries: Sum) -> None:
        row = dict(rounds)
        for i in entries:
            row[i] = row.get(i, 0.0) - most
        self.at_most.append(row)


def _matrix(rows: list[Sum], size: int) -> csr_array:
    values = [it for row in rows for it in row.values()]
    columns = [i for row in rows for i in row]
    lines = [line for line, row in enumerate(rows) for _ in row]
    return csr_array((values, (lines, columns)), shape=(len(rows), size))
