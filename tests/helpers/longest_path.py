"""The largest number of instructions that a function of a program can execute."""

from __future__ import annotations

from dataclasses import dataclass, field

from flow_program import FlowProgram
from program_functions import Functions


@dataclass
class LongestPath:
    """The longest paths of the functions of a program."""

    functions: Functions
    known: dict[tuple[int, int], float] = field(default_factory=dict)

    def of(self, address: int, copied: int = 0) -> float:
        """Largest number of instructions of a call.

        copied  number of bytes, for memcpy, memmove and memset
        """
        if (address, copied) not in self.known:
            program = FlowProgram(self.functions, address, copied, self.of)
            self.known[address, copied] = program.solve()
        return self.known[address, copied]
