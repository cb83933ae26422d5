"""The control flow graph of a function of a program, and the loops in it."""

from __future__ import annotations

from collections import defaultdict
from dataclasses import dataclass, field

import numpy as np
from scipy.sparse import csr_array
from scipy.sparse.csgraph import connected_components

from arm_code import Instruction, Program


@dataclass
class Block:
    """Instructions that are executed one after the other."""

    instructions: list[Instruction]
    following: list[int] = field(default_factory=list)
    """First addresses of the blocks that can come next; none where the function returns."""


@dataclass(frozen=True)
class NaturalLoop:
    """Blocks that can be executed again without leaving; named by the first address."""

    header: int
    blocks: frozenset[int]
    back: tuple[tuple[int, int], ...]
    """Edges to the header from within."""


@dataclass
class Graph:
    """A function."""

    begin: int
    blocks: dict[int, Block]
    loops: list[NaturalLoop]
    """Inner loops first."""

    def around(self, block: int) -> list[NaturalLoop]:
        """The loops that contain a block, inner ones first."""
        return [loop for loop in self.loops if block in loop.blocks]

    def goes_round(self, loop: NaturalLoop, without: set[int]) -> bool:
        """Whether a loop can come back to its begin without some of its blocks."""
        reached, todo = set[int](), [loop.header]
        while todo:
            block = todo.pop()
            if block not in loop.blocks or block in without:
                continue
            if loop.header in self.blocks[block].following:
                return True
            if block not in reached:
                reached.add(block)
                todo += self.blocks[block].following
        return False


def read_graph(program: Program, begin: int) -> Graph:
    """The graph of the function that begins at an address."""
    reached, todo = set[int](), [begin]
    targets = {begin}
    while todo:
        address = todo.pop()
        if address in reached:
            continue
        reached.add(address)
        following = program.instructions[address].following
        todo += following
        if len(following) != 1 or program.instructions[address].name.startswith("b"):
            targets.update(following)
    before = defaultdict(set)
    for address in reached:
        for after in program.instructions[address].following:
            before[after].add(address)
    targets |= {address for address in reached if len(before[address]) > 1}
    blocks: dict[int, Block] = {}
    for target in targets:
        block = blocks[target] = Block([])
        address = target
        while True:
            instruction = program.instructions[address]
            block.instructions.append(instruction)
            following = instruction.following
            if len(following) != 1 or following[0] in targets:
                block.following = list(dict.fromkeys(following))
                break
            address = following[0]
    loops: list[NaturalLoop] = []
    while (entrances := _find_loops(begin, blocks, set(blocks), loops)) is not None:
        _split(blocks, *entrances)
        loops.clear()
    return Graph(begin, blocks, sorted(loops, key=lambda loop: len(loop.blocks)))


def _find_loops(
    begin: int, blocks: dict[int, Block], within: set[int], found: list[NaturalLoop]
) -> tuple[frozenset[int], int] | None:
    """Adds the loops among some blocks, outer ones first.

    Returns None, or the blocks of a loop that has several entrances and the one to keep.
    """
    for inside in _circles(blocks, within):
        edges = [(it, to) for it in blocks for to in blocks[it].following if to in inside]
        entrances = {to for it, to in edges if it not in inside}
        # An inner loop is also entered from the header of the one around it.
        entrances |= {begin} & inside
        if len(entrances) > 1:
            return inside, min(
                entrances, key=lambda it: (_copied(blocks, inside, entrances, it), it)
            )
        header = entrances.pop()
        back = tuple((it, to) for it, to in edges if to == header and it in inside)
        found.append(NaturalLoop(header, inside, back))
        problem = _find_loops(begin, blocks, set(inside - {header}), found)
        if problem is not None:
            return problem
    return None


def _copied(
    blocks: dict[int, Block], inside: frozenset[int], entrances: set[int], header: int
) -> int:
    """How many blocks must be copied so that a loop has this entrance alone."""
    reached, todo = {header}, list(entrances)
    while todo:
        block = todo.pop()
        if block in inside and block not in reached:
            reached.add(block)
            todo += blocks[block].following
    return len(reached) - 1


def _circles(blocks: dict[int, Block], within: set[int]) -> list[frozenset[int]]:
    """The strongly connected parts of a graph that contain an edge."""
    names = sorted(within)
    place = {name: i for i, name in enumerate(names)}
    edges = [(a, b) for a in names for b in blocks[a].following if b in within]
    rows, columns = [place[a] for a, _ in edges], [place[b] for _, b in edges]
    graph = csr_array((np.ones(len(edges)), (rows, columns)), shape=(len(names),) * 2)
    count, part = connected_components(graph, connection="strong")
    parts: list[set[int]] = [set() for _ in range(count)]
    for name, number in zip(names, part, strict=True):
        parts[number].add(name)
    return [frozenset(it) for it in parts if any(a in it and b in it for a, b in edges)]


def _split(blocks: dict[int, Block], inside: frozenset[int], header: int) -> None:
    """Gives a loop one entrance: who comes in elsewhere takes copies of blocks to the header."""
    first = max(blocks) + 1  # above all addresses: a name for the first copy
    copies = {block: first + i for i, block in enumerate(sorted(inside - {header}))}
    for name in list(blocks):
        if name not in inside:
            following = blocks[name].following
            blocks[name].following = [copies.get(block, block) for block in following]
    for block, copy in copies.items():
        following = [copies.get(after, after) for after in blocks[block].following]
        blocks[copy] = Block(blocks[block].instructions, following)
    reached, todo = set[int](), [name for name in blocks if name not in copies.values()]
    while todo:
        block = todo.pop()
        if block not in reached:
            reached.add(block)
            todo += blocks[block].following
    for copy in copies.values():
        if copy not in reached:
            del blocks[copy]
