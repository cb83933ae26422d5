"""Imports between the subpackages of sigmahat form no cycle and no long chain."""

import ast
from collections.abc import Iterator, Mapping
from graphlib import TopologicalSorter
from pathlib import Path

import pytest

PACKAGE = Path(__file__).parents[2] / "harness" / "sigmahat"
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
