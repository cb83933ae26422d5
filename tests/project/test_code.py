"""Compilers, linter and type checker find no error in the code."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import fmpy
import pytest

from c_sources import FOLDERS, OTHER_FOLDERS, OTHERS, SOURCES, generated
from gate import need

REPOSITORY = Path(__file__).parents[2]
PYTHON = ["c", "harness", "tests", "bench", "docs", "examples"]
WARNINGS = ["-std=c99", "-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Werror"]


@pytest.mark.parametrize("source", SOURCES + OTHERS, ids=lambda path: path.name)
@pytest.mark.parametrize("compiler", ["gcc", "clang"])
def test_compilers_give_no_warning(
    compiler: str, source: Path, build: Path, tmp_path: Path
) -> None:
    done = subprocess.run(
        [
            need(compiler),
            *WARNINGS,
            "-O2",  # some warnings need the analysis of the optimiser
            "-c",
            str(source),
            "-o",
            str(tmp_path / "object.o"),
            *(f"-I{folder}" for folder in [*FOLDERS, *OTHER_FOLDERS, generated(source, build)]),
            f"-isystem{Path(fmpy.__file__).parent / 'c-code'}",
        ],
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stderr


@pytest.mark.parametrize("source", SOURCES, ids=lambda path: path.name)
def test_the_library_needs_no_heap_and_no_output(source: Path) -> None:
    text = source.read_text()
    included = {line.split()[1] for line in text.splitlines() if line.startswith("#include <")}
    assert included <= {"<math.h>", "<stddef.h>", "<string.h>"}


def test_every_test_asks_one_function_for_a_tool() -> None:
    """That function skips the test where the tool is missing."""
    asking = [f for f in (REPOSITORY / "tests").rglob("*.py") if "shutil.which" in f.read_text()]
    # test_install.py asserts that a tool is not found.
    assert {f.name for f in asking} <= {"gate.py", "test_code.py", "test_install.py"}


@pytest.mark.parametrize("command", [["ruff", "check"], ["ruff", "format", "--check"]])
def test_ruff_finds_no_error(command: list[str]) -> None:
    done = subprocess.run(
        [sys.executable, "-m", *command, *PYTHON],
        cwd=REPOSITORY,
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stdout + done.stderr


@pytest.mark.slow("mypy reads the packages that are imported, too")
def test_mypy_finds_no_error() -> None:
    done = subprocess.run(
        [sys.executable, "-m", "mypy", *PYTHON],
        cwd=REPOSITORY,
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stdout + done.stderr
