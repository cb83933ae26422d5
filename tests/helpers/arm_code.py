"""The machine code of a program for Cortex-M, as objdump prints it: instructions, jumps, calls."""

from __future__ import annotations

import re
import subprocess
from dataclasses import dataclass, field
from pathlib import Path

from gate import need

_FUNCTION = re.compile(r"^([0-9a-f]+) <(.+)>:$")
_PLACE = re.compile(r"^(?P<inlined>inlined by )?(?P<file>/.*):(?P<line>\d+)(?: \(.*\))?$")
_INSTRUCTION = re.compile(r"^ +([0-9a-f]+):\t(\S+)(?:\t(.*))?$")
_CONDITION = "(?:eq|ne|cs|cc|mi|pl|vs|vc|hi|ls|ge|lt|gt|le)"
_CALL = re.compile(rf"blx?({_CONDITION})?")
_JUMP = re.compile(rf"b({_CONDITION})?|cbn?z")
_RETURN = re.compile(rf"(?:bx|mov|pop|ldr|ldm(?:ia)?)({_CONDITION})?")


@dataclass(frozen=True)
class Place:
    """A line of the source."""

    file: str
    """Without its folder."""
    line: int


@dataclass
class Instruction:
    """One instruction.

    places  the line that it belongs to, then the lines where this was inlined, inner first
    """

    address: int
    name: str
    operands: str
    places: tuple[Place, ...]
    following: list[int] = field(default_factory=list)
    """Addresses where the function goes on."""
    calls: int | None = None
    """Address of a function that it calls."""
    calls_pointer: bool = False


@dataclass
class Program:
    """All instructions by address, and the functions."""

    instructions: dict[int, Instruction]
    names: dict[int, str]
    """Functions by the address of their first instruction."""

    def address(self, name: str) -> int:
        """Where a function begins."""
        (address,) = (address for address, known in self.names.items() if known == name)
        return address


def read_program(elf: Path) -> Program:
    """Disassembles a program that was compiled with -g."""
    text = subprocess.run(
        [need("arm-none-eabi-objdump"), "-d", "-l", "--inlines", "--no-show-raw-insn", str(elf)],
        capture_output=True,
        text=True,
        check=True,
    ).stdout
    program = Program({}, {})
    data: dict[int, int] = {}
    places: list[Place] = []
    is_new = False
    for line in text.splitlines():
        if function := _FUNCTION.match(line):
            program.names[int(function[1], 16)] = function[2]
            places, is_new = [], True
        elif place := _PLACE.match(line):
            here = Place(Path(place["file"]).name, int(place["line"]))
            # After an instruction, only the places of inlining are repeated.
            inner = places if is_new else places[:1]
            places = [*inner, here] if place["inlined"] else [here]
            is_new = True
        elif code := _INSTRUCTION.match(line):
            address, name, operands = int(code[1], 16), code[2], code[3] or ""
            is_new = False
            if name in (".word", ".short", ".byte"):
                size = {".word": 4, ".short": 2, ".byte": 1}[name]
                value = int(operands.split()[0], 16)
                data.update((address + i, value >> 8 * i & 0xFF) for i in range(size))
                continue
            name = name.removesuffix(".n").removesuffix(".w")
            operands = operands.split("\t@")[0]
            program.instructions[address] = Instruction(address, name, operands, tuple(places))
    _connect(program, data)
    return program


def _connect(program: Program, data: dict[int, int]) -> None:
    """Sets where each instruction goes."""
    addresses = sorted(program.instructions)
    for address, after in zip(addresses, [*addresses[1:], -1], strict=True):
        it = program.instructions[address]
        target = int(it.operands.split()[-2], 16) if "<" in it.operands else None
        if _CALL.fullmatch(it.name):
            it.calls, it.calls_pointer = target, target is None
            it.following = [after]
        elif jump := _JUMP.fullmatch(it.name):
            assert target is not None, it
            if target in program.names and not _is_in(program, address, target):
                it.calls = target  # the function ends with the call of another one
            else:
                it.following.append(target)
            if jump[1] or it.name.startswith("cb"):
                it.following.append(after)
        elif it.name in ("tbb", "tbh"):
            it.following = _table(it, data, program)
        elif (end := _RETURN.fullmatch(it.name)) and _writes_pc(it):
            it.calls_pointer = it.name.startswith("bx") and it.operands != "lr"
            it.following = [after] if end[1] else []
        elif it.name != "udf":
            it.following = [after]


def _is_in(program: Program, address: int, function: int) -> bool:
    """Whether an instruction belongs to the function that begins there."""
    return max(begin for begin in program.names if begin <= address) == function


def _writes_pc(it: Instruction) -> bool:
    """Whether an instruction of the form of a return is one."""
    if it.name.startswith("bx"):
        return True
    if it.name.startswith(("pop", "ldm")):
        return it.operands.rstrip("}").endswith("pc")
    assert not it.operands.startswith("pc,") or it.operands.startswith(("pc, lr", "pc, [sp]")), it
    return it.operands.startswith("pc,")


def _table(it: Instruction, data: dict[int, int], program: Program) -> list[int]:
    """Targets of a jump through a table, which follows the instruction."""
    width = 1 if it.name == "tbb" else 2
    begin = place = it.address + 4
    targets = set()
    while place in data:
        distance = sum(data[place + i] << 8 * i for i in range(width) if place + i in data)
        targets.add(begin + 2 * distance)
        place += width
    return sorted(target for target in targets if target in program.instructions)
