"""Every loop of the C library has a bound, and no function has more than the library allows."""

from __future__ import annotations

import re
import subprocess
from dataclasses import replace
from pathlib import Path

import pytest

import c_loops
import c_sources
from c_sources import FOLDERS, HEADERS, SOURCES
from flow_facts import Facts, Sizes, read_facts
from gate import need

FACTS = read_facts("filtered_regression")
PAGE = (c_sources.REPOSITORY / "docs" / "proof" / "bounds.md").read_text(encoding="utf-8")
RUNS = ((1, 8, 5, 0), (1, 4, 1, 0), (2, 8, 5, 1), (2, 8, 5, 0), (2, 6, 3, 1), (2, 2, 1, 0))
"""Arguments of rounds.c."""
HEAP = {"malloc", "calloc", "realloc", "free", "aligned_alloc", "alloca"}


@pytest.fixture(scope="module", autouse=True)
def compiler() -> None:
    """The compiler of this machine, which prints the graph of calls."""
    need("gcc")


def compile_all(folder: Path, *flags: str) -> None:
    """Compiles c/ on this machine, file by file, as it is written: without optimisation."""
    command = ["gcc", "-std=c99", "-O0", *flags, *(f"-I{it}" for it in FOLDERS), "-c"]
    subprocess.run([*command, *map(str, SOURCES)], cwd=folder, check=True)


def test_every_loop_has_a_bound() -> None:
    names = [loop.name for loop in c_loops.loops()]
    assert len(set(names)) == len(names) > 50
    known = set(FACTS.loops)
    assert not set(names) - known, "loops without a bound in tests/proof/bounds.toml"
    assert not known - set(names), "loops of tests/proof/bounds.toml that are not in c/"
    assert all(loop.head.startswith("for (") for loop in c_loops.loops()), "while, do"
    assert not [it for it in [*SOURCES, *HEADERS] if re.search(r"\bgoto\b", c_loops.code_of(it))]


def test_what_the_facts_name_is_there() -> None:
    functions = {function.name for function in c_loops.functions()}
    for total in FACTS.totals:
        for name in (total.loop, total.over):
            assert name in FACTS.loops.keys() | FACTS.library.keys() | functions, name
    for limit in FACTS.limits:
        assert limit.function in functions | {"sin", "cos", "log"}
        assert limit.over in FACTS.loops
    assert FACTS.copies.keys() <= functions
    assert FACTS.pointers.keys() <= functions


def test_no_function_is_too_complex() -> None:
    complexity = {it.name: it.complexity for it in c_loops.functions()}
    assert len(complexity) > 100
    (largest,) = re.findall(r"the cyclomatic number is at most (\d+)", PAGE)
    assert max(complexity.values()) == int(largest), complexity


def test_there_is_no_recursion_and_no_heap(tmp_path: Path) -> None:
    """The graph of calls as gcc prints it, with the functions that a pointer can call."""
    compile_all(tmp_path, "-fcallgraph-info=su")
    graph: dict[str, set[str]] = {}
    by_pointer = set()
    for file in tmp_path.glob("*.ci"):
        text = file.read_text()
        assert "dynamic" not in re.sub(r"\b0 dynamic objects", "", text), file.name
        for source, target in re.findall(r'sourcename: "([^"]*)" targetname: "([^"]*)"', text):
            # A function that is static has the name of its file before its own.
            source, target = source.rpartition(":")[2], target.rpartition(":")[2]
            if target == "__indirect_call":
                by_pointer.add(source)
            else:
                graph.setdefault(source, set()).add(target)
    rows = re.findall(r"^\| `(\w+)` \| `(\w+)` \| (.*) \|$", PAGE, re.M)
    assert by_pointer == {caller for caller, _, _ in rows}
    text = "".join(c_loops.code_of(source) for source in SOURCES)
    members = re.findall(r"^    \.(\w+) = (\w+),$", text, re.M)
    # A macro makes this table from the list of methods.
    members += [("STATE_CHECKS", it) for it in re.findall(r"^int (\w+_check_state)\(", text, re.M)]
    for _, member, functions in rows:
        reached = {function for name, function in members if name == member}
        assert set(re.findall(r"`(\w+)`", functions)) == reached != set(), member
    for caller in by_pointer:
        graph.setdefault(caller, set()).update(it for _, it in members)
    assert not HEAP & set().union(*graph.values())
    done: set[str] = set()

    def visit(function: str, under: tuple[str, ...]) -> None:
        assert function not in under, [*under, function]
        if function not in done:
            for callee in graph.get(function, ()):
                visit(callee, (*under, function))
            done.add(function)

    for function in list(graph):
        visit(function, ())
    assert {"sh_estimator_tick", "tick_filtered_regression", "sh_information_take"} <= done


def instrumented(file: Path, number: dict[str, int]) -> str:
    """A file of c/ whose loops report their begins and rounds."""
    text, code = file.read_text(encoding="utf-8"), c_loops.code_of(file)
    own = [loop for loop in c_loops.loops() if loop.function.file == file.name]
    for loop in sorted(own, key=lambda loop: -loop.place):
        opening = code.index("(", loop.place)
        end = c_loops.closing(code, opening)
        first, condition, step = text[opening + 1 : end].split(";")
        i = number[loop.name]
        begin = f"sh_begin({i})" + (f", {first}" if first.strip() else "")
        new = f"{begin}; sh_round({i}, ({condition}) != 0); {step}"
        text = text[: opening + 1] + new + text[end:]
    return f'#include "rounds.h"\n{text}'


def pairs(facts: Facts, number: dict[str, int]) -> list[tuple[int, int, int, str]]:
    """Inner loop, outer loop, whether begins count, and the bound."""
    first = {loop.function.name: loop.name for loop in reversed(c_loops.loops())}
    found = [
        (number[total.loop], number[first.get(total.over, total.over)], 0, total.most)
        for total in facts.totals
        if total.loop in number and first.get(total.over) != total.loop
    ]
    for limit in facts.limits:
        if limit.function in first:
            inner = number[first[limit.function]]
            found.append((inner, number[limit.over], 1, limit.most))
    return found


@pytest.fixture(scope="module")
def counting(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A program that counts the rounds of all loops."""
    folder = tmp_path_factory.mktemp("rounds")
    number = {loop.name: i for i, loop in enumerate(c_loops.loops())}
    for file in [*SOURCES, *HEADERS]:
        (folder / file.name).write_text(instrumented(file, number))
    both = ", ".join(f"{{{i}, {o}, {begins}}}" for i, o, begins, _ in pairs(FACTS, number))
    (folder / "rounds.h").write_text(
        "#pragma once\nint sh_begin(int loop);\nint sh_round(int loop, int goes_on);\n"
        f"enum {{ SH_LOOPS = {len(number)}, SH_PAIRS = {len(pairs(FACTS, number))} }};\n"
        f"static const int sh_pairs[SH_PAIRS][3] __attribute__((unused)) = {{{both}}};\n"
    )
    driver = Path(__file__).parent / "rounds" / "rounds.c"
    sources = [driver, *(folder / source.name for source in SOURCES)]
    command = ["gcc", "-std=gnu99", "-O1", f"-I{folder}", *map(str, sources), "-lm", "-o", "count"]
    subprocess.run(command, cwd=folder, check=True)
    return folder / "count"


def test_no_loop_makes_more_rounds_than_its_bound(counting: Path) -> None:
    """The bounds hold where loops are counted, and most of them are reached."""
    names = [loop.name for loop in c_loops.loops()]
    number = {name: i for i, name in enumerate(names)}
    reached, ran = set[str](), set[str]()
    sizes = Sizes(N=8, M=5, n=0, m=0, columns=0, real=8)
    for method, n, m, optional in RUNS:
        command = [str(counting), *map(str, (method, n, m, optional))]
        text = subprocess.run(command, capture_output=True, text=True, check=True).stdout
        columns, *counts = map(int, text.split())
        sizes = replace(sizes, n=n, m=m, columns=columns or 1)
        for name, count in zip(names, counts, strict=False):
            bound = FACTS.rounds(name, sizes, 0)
            assert count <= bound, (name, sizes)
            reached |= {name} if 0 < count == bound else set()
            ran |= {name} if count else set()
        both = zip(pairs(FACTS, number), counts[len(names) :], strict=True)
        for (inner, outer, _, most), count in both:
            bound = FACTS.value(most, sizes)
            assert count <= bound, (names[inner], names[outer], sizes)
            reached |= {f"{inner} {outer}"} if 0 < count == bound else set()
    assert len(ran) > 0.95 * len(names), set(names) - ran
    assert {f"{inner} {outer}" for inner, outer, _, _ in pairs(FACTS, number)} <= reached
    assert len(reached & ran) > 0.9 * len(names), set(names) - reached
