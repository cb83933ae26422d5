"""The functions of a program: their graphs, their names, and which other functions they call."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field

import c_loops
from arm_code import Instruction, Program
from control_flow import Graph, NaturalLoop, read_graph
from flow_facts import Facts, Sizes


@dataclass
class Functions:
    """The functions of a program, with what is known about them for an estimator of some size."""

    program: Program
    facts: Facts
    sizes: Sizes
    real: str
    without: frozenset[str] = frozenset()
    """Functions that are known not to be called."""
    graphs: dict[int, Graph] = field(default_factory=dict)
    names: dict[tuple[int, int], str] = field(default_factory=dict)

    def graph(self, address: int) -> Graph:
        """Control flow graph of a function."""
        if address not in self.graphs:
            self.graphs[address] = read_graph(self.program, address)
        return self.graphs[address]

    def name(self, address: int) -> str:
        """Name of a function; what the compiler appends to it is left out."""
        return self.program.names.get(address, f"at {address:x}").partition(".")[0]

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
