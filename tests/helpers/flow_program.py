"""How often the parts of a function run at most: implicit path enumeration (Li and Malik 1995).

How often each edge of the control flow graph is taken is an unknown of a linear program. What
enters a block leaves it, a loop makes no more rounds than its bound, and the sum of all
instructions becomes as large as possible. Counts need not be whole numbers, which can only make it
larger.

The functions of c/ are put into the place of their calls, so that a bound can hold for several of
them together. Those of other libraries count with their own largest number.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field

import numpy as np
from scipy.optimize import linprog
from scipy.sparse import csr_array

from arm_code import Place
from control_flow import Graph, NaturalLoop
from program_functions import Functions

Cost = Callable[[int, int], float]
"""Instructions of a call: address of the function, number of bytes that it copies."""
Places = tuple[Place, ...]
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


class FlowProgram:
    """The linear program of one function."""

    def __init__(self, functions: Functions, address: int, copied: int, of_call: Cost) -> None:
        self.functions, self.copied, self.of_call = functions, copied, of_call
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
        call = Call(self.functions.graph(address), caller, block)
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
        for name, instruction, callee in list(self.functions.callees(call.graph)):
            if self.functions.has_loops(callee):
                self._add(callee, call, name)
            else:
                copied = self.functions.facts.copied(
                    instruction, self.functions.name(callee), self.functions.sizes
                )
                self._gain(call, name, self.of_call(callee, copied))

    def _gain(self, call: Call, block: int, instructions: float) -> None:
        for i in call.count(block):
            self.gain[i] += instructions

    def _bound(self, call: Call, loop: NaturalLoop) -> None:
        facts, sizes = self.functions.facts, self.functions.sizes
        name = self.functions.name_of(call.graph, loop)
        most = facts.rounds(name, sizes, self.copied)
        # The compiler may have made two loops of one, which have its rounds together.
        same = [
            inner
            for inner in call.graph.loops
            if inner.blocks <= loop.blocks and self.functions.name_of(call.graph, inner) == name
        ]
        rounds: Sum = {}
        for inner in same:
            rounds |= call.rounds(inner)
        self._at_most(rounds, most, call.entries(loop))

    def _total(self) -> None:
        """Rounds of all loops that were made of one, in all rounds of one around them."""
        facts = self.functions.facts
        for total in facts.totals:
            sums: dict[tuple[int, ...], tuple[Sum, Sum]] = {}
            for call in self.calls:
                for loop in call.graph.loops:
                    if self.functions.name_of(call.graph, loop) == total.loop:
                        outer = self._around(call, loop, total.over)
                        if outer is not None:
                            rounds, _ = sums.setdefault(tuple(outer), ({}, outer))
                            rounds |= call.rounds(loop)
            for rounds, outer in sums.values():
                self._at_most(rounds, facts.value(total.most, self.functions.sizes), outer)

    def _around(
        self, call: Call, loop: NaturalLoop | None, name: str, block: int = 0
    ) -> Sum | None:
        """How often the loop, or function, of this name begins that is around a loop, or block."""
        here: Call | None = call
        inside = loop.blocks if loop is not None else frozenset({block})
        while here is not None:
            found = [
                it
                for it in here.graph.loops
                if inside <= it.blocks and self.functions.name_of(here.graph, it) == name
            ]
            if found:
                return here.entries(found[-1])
            if self.functions.name(here.graph.begin) == name:
                return {here.entry: 1.0}
            inside, here = frozenset({here.block}), here.caller
        return None

    def _limit(self) -> None:
        """Functions that run only a few times in all rounds of a loop."""
        facts, sizes = self.functions.facts, self.functions.sizes
        for limit in facts.limits:
            name = limit.function
            found = [*self._calls_of(name, limit.over), *self._begins_in(name, limit.over)]
            sums: dict[tuple[str, tuple[int, ...]], list[tuple[Sum, Places]]] = {}
            outers = {}
            for what, count, places, outer in found:
                sums.setdefault((what, tuple(outer)), []).append((count, places))
                outers[tuple(outer)] = outer
            for (what, key), counts in sums.items():
                total: Sum = {}
                for count, _ in counts:
                    for i, it in count.items():
                        total[i] = total.get(i, 0.0) + it
                # One call may begin all the loops that the compiler has made of one.
                made = max(Counter(places for _, places in counts).values()) if what else 1
                self._at_most(total, made * facts.value(limit.most, sizes), outers[key])

    def _calls_of(self, function: str, over: str) -> Iterator[tuple[str, Sum, Places, Sum]]:
        """Calls of a function in a loop."""
        names = {function, function + ("f" if self.functions.real == "float" else "")}
        for call in self.calls:
            for block, instruction, callee in self.functions.callees(call.graph):
                outer = self._around(call, None, over, block)
                if self.functions.name(callee) in names and outer:
                    yield "", call.count(block), instruction.places, outer

    def _begins_in(self, function: str, over: str) -> Iterator[tuple[str, Sum, Places, Sum]]:
        """Begins of the loops of a function in a loop, also where it was put into another one."""
        for call in self.calls:
            for loop in call.graph.loops:
                name = self.functions.name_of(call.graph, loop)
                outer = self._around(call, loop, over)
                inner = any(
                    loop.blocks < it.blocks
                    and self.functions.name_of(call.graph, it).startswith(f"{function}: ")
                    for it in call.graph.loops
                )
                if name.startswith(f"{function}: ") and outer and not inner:
                    # Where the function was put in: every function around it has another place.
                    first = call.graph.blocks[loop.header].instructions[0]
                    places = (*first.places[1:], Place(f"{id(call)}", 0))
                    yield name, call.entries(loop), places, outer

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
