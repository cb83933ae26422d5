"""The loops of the C library, as they are written."""

from __future__ import annotations

import re
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import lizard

from c_sources import HEADERS, LIBRARY, SOURCES

_COMMENTS = re.compile(r"/\*.*?\*/|//[^\n]*|\"(?:\\.|[^\"\\])*\"|'(?:\\.|[^'\\])*'", re.DOTALL)


@dataclass(frozen=True)
class Function:
    """A function of c/; lines from its head to its end."""

    file: str
    name: str
    first: int
    last: int
    complexity: int
    """Cyclomatic number of McCabe."""


@dataclass(frozen=True)
class Loop:
    """A loop of c/; the lines are those of its head."""

    function: Function
    head: str
    """"for (...)", "while (...)" or "do"."""
    first: int
    last: int
    order: int
    """0 for the first loop of the function with this head."""
    place: int
    """Where it begins in the text of the file."""

    @property
    def name(self) -> str:
        """Function, head and, if there are several, order: "walk: for (;;) #2"."""
        again = f" #{self.order + 1}" if self.order else ""
        return f"{self.function.name}: {self.head}{again}"


def code_of(file: Path) -> str:
    """A file without comments and strings; all else stays in its place."""
    return _COMMENTS.sub(
        lambda match: re.sub(r"[^\n]", " ", match[0]), file.read_text(encoding="utf-8")
    )


@cache
def functions() -> tuple[Function, ...]:
    """All functions of c/."""
    return tuple(
        Function(file.name, it.name, it.start_line, it.end_line, it.cyclomatic_complexity)
        for file in [*SOURCES, *HEADERS]
        for it in lizard.analyze_file(str(file)).function_list
    )


def function_at(file: str, line: int) -> Function | None:
    """The function of c/ to which a line belongs."""
    for function in functions():
        if function.file == file and function.first <= line <= function.last:
            return function
    return None


@cache
def loops() -> tuple[Loop, ...]:
    """All loops of c/, in their order."""
    found: list[Loop] = []
    for file in [*SOURCES, *HEADERS]:
        code = code_of(file)
        for word in re.finditer(r"\b(for|while|do)\b", code):
            begin, end = word.start(), word.end()
            if word[0] != "do":
                end = closing(code, code.index("(", end)) + 1
            first, last = (code.count("\n", 0, place) + 1 for place in (begin, end))
            function = function_at(file.name, first)
            assert function, f"{file.relative_to(LIBRARY)}:{first}: a loop outside of a function"
            head = re.sub(r"\s+", " ", code[begin:end])
            order = sum(loop.function == function and loop.head == head for loop in found)
            found.append(Loop(function, head, first, last, order, begin))
    return tuple(found)


def closing(code: str, opening: int) -> int:
    """Place of the parenthesis that closes the one at `opening`."""
    depth = 0
    for place in range(opening, len(code)):
        depth += {"(": 1, ")": -1}.get(code[place], 0)
        if depth == 0:
            return place
    raise ValueError("a parenthesis is not closed")


def loop_at(file: str, line: int) -> Loop | None:
    """The loop of c/ whose head is on a line."""
    for loop in loops():
        if loop.function.file == file and loop.first <= line <= loop.last:
            return loop
    return None
