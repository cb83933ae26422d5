"""Imports between the subpackages of sigmahat follow the drawing in docs/architecture.md.

They form no cycle and no long chain.
"""

import ast
import re
from collections.abc import Iterator, Mapping
from graphlib import TopologicalSorter
from pathlib import Path

import pytest

REPOSITORY = Path(__file__).parents[2]
PACKAGE = REPOSITORY / "harness" / "sigmahat"
PAGE = REPOSITORY / "docs" / "architecture.md"
LONGEST = 10
"""Largest number of subpackages in a chain of imports, which begins at the command line."""

Graph = Mapping[str, set[str]]


def modules() -> dict[str, Path]:
    """Files of all modules by name, without __init__.py of sigmahat, which imports public names."""
    files = (path for path in PACKAGE.rglob("*.py") if path != PACKAGE / "__init__.py")
    parts = {path: path.relative_to(PACKAGE.parent).with_suffix("").parts for path in files}
    return {".".join(names).removesuffix(".__init__"): path for path, names in parts.items()}


def imported(path: Path) -> Iterator[str]:
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.ImportFrom) and node.module:
            yield from (f"{node.module}.{alias.name}" for alias in node.names)
            yield node.module
        elif isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)


@pytest.fixture(scope="module")
def graph() -> Graph:
    files = modules()
    return {name: set(imported(path)) & files.keys() - {name} for name, path in files.items()}


def room(module: str) -> str:
    """Returns the subpackage of a module, or the name of a module at the top level."""
    return module.split(".")[1]


def rooms(graph: Graph) -> Graph:
    every: dict[str, set[str]] = {room(name): set() for name in graph}
    for name, others in graph.items():
        every[room(name)] |= {room(other) for other in others} - {room(name)}
    return every


def drawn() -> list[list[str]]:
    """Returns the rooms of each line in the drawing of the page, from top to bottom.

    A line begins with the names of its rooms, with one space between two names. The text behind two
    spaces is a remark.
    """
    _, _, section = PAGE.read_text(encoding="utf-8").partition("\n## The package in Python\n")
    block = re.search(r"(?:^ +\S.*\n)+", section, re.MULTILINE)
    assert block is not None
    names = [line.strip().split("  ")[0] for line in block[0].splitlines()]
    return [[name.removesuffix("/") for name in line.split(" ")] for line in names]


def longest(graph: Graph) -> list[str]:
    """Returns the longest chain of imports. Raises CycleError if the imports form a cycle."""
    chains: dict[str, list[str]] = {}
    for name in TopologicalSorter(graph).static_order():
        below = max((chains[other] for other in graph[name]), key=len, default=[])
        chains[name] = [name, *below]
    return max(chains.values(), key=len)


def test_no_module_imports_itself_through_others(graph: Graph) -> None:
    assert len(longest(graph)) > 1


def test_imports_run_one_way_through_few_rooms(graph: Graph) -> None:
    assert len(longest(rooms(graph))) <= LONGEST


def test_a_room_imports_only_rooms_on_lower_lines_of_the_drawing(graph: Graph) -> None:
    imports = rooms(graph)
    place = [(name, line) for line, names in enumerate(drawn()) for name in names]
    assert sorted(name for name, _ in place) == sorted(imports)
    line_of = dict(place)
    wrong = [
        f"{name} imports {other}"
        for name, others in imports.items()
        for other in others
        if line_of[other] <= line_of[name]
    ]
    assert wrong == []
