"""The stack that a function of a program can need, with all that it calls."""

from __future__ import annotations

import re
from dataclasses import dataclass, field

from arm_code import Instruction
from program_functions import Functions

_PUSH = re.compile(r"(?:v?push|v?stmdb)(?: sp!,)? {(.*)}")
_POP = re.compile(r"(?:v?pop|v?ldm(?:ia)?)(?: sp!,)? {(.*)}")
_CHANGE = re.compile(r"(add|sub)w? sp, (?:sp, )?#(\d+)")
_BEFORE = re.compile(r"v?str\w* .*\[sp, #(-\d+)\]!")
_AFTER = re.compile(r"v?ldr\w* .*\[sp\], #(\d+)")
_REGISTER = re.compile(r"([sdr])(\d+)(?:-[sdr](\d+))?|\w+")


@dataclass
class Stack:
    """Depths of the stack, from the instructions that move its pointer [bytes]."""

    functions: Functions
    known: dict[int, tuple[int, int]] = field(default_factory=dict)

    def depth(self, address: int, under: tuple[int, ...] = ()) -> tuple[int, int]:
        """Depth of a function alone, and with all that it calls. No function may call itself."""
        assert address not in under, f"{self.functions.name(address)} is recursive"
        if address not in self.known:
            self.known[address] = self._depth(address, (*under, address))
        return self.known[address]

    def _depth(self, address: int, under: tuple[int, ...]) -> tuple[int, int]:
        graph = self.functions.graph(address)
        callees: dict[int, list[int]] = {}
        for _, instruction, callee in self.functions.callees(graph):
            callees.setdefault(instruction.address, []).append(callee)
        own = deepest = 0
        begins, todo = {graph.begin: 0}, [graph.begin]
        while todo:
            block = todo.pop()
            depth = begins[block]
            for instruction in graph.blocks[block].instructions:
                depth += _growth(instruction)
                own, deepest = max(own, depth), max(deepest, depth)
                for callee in callees.get(instruction.address, ()):
                    deepest = max(deepest, depth + self.depth(callee, under)[1])
            for after in graph.blocks[block].following:
                assert begins.get(after, depth) == depth, f"{after:x}: a stack of two depths"
                if after not in begins:
                    begins[after] = depth
                    todo.append(after)
        return own, deepest


def _growth(instruction: Instruction) -> int:
    """By how much an instruction makes the stack deeper; below 0: less deep."""
    if len(instruction.following) != 1 and instruction.name.startswith(("pop", "ldm")):
        return 0  # a return
    text = f"{instruction.name} {instruction.operands}"
    name = instruction.name
    if (match := _PUSH.fullmatch(text)) and (name.endswith("push") or "sp!" in text):
        return _bytes(match[1])
    if (match := _POP.fullmatch(text)) and (name.endswith("pop") or "sp!" in text):
        return -_bytes(match[1])
    if match := _CHANGE.match(text):
        return int(match[2]) * (1 if match[1] == "sub" else -1)
    if match := _BEFORE.match(text):
        return -int(match[1])
    if match := _AFTER.match(text):
        return -int(match[1])
    assert not re.match(r"\w+ sp[,!]", text), f"what does {text} do to the stack?"
    return 0


def _bytes(registers: str) -> int:
    """Bytes of the registers of a list: "r4, r5, lr" or "d8-d11"."""
    total = 0
    for match in _REGISTER.finditer(registers):
        count = int(match[3]) - int(match[2]) + 1 if match[3] else 1
        total += count * (8 if match[1] == "d" else 4)
    return total
