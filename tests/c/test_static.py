"""Static analysers find no error in the C code."""

from __future__ import annotations

import re
import shutil
import subprocess
from pathlib import Path

import fmpy
import pytest

import c_sources
from gate import missing

REPOSITORY = Path(__file__).parents[2]
SOURCES = [*c_sources.SOURCES, *sorted((REPOSITORY / "fmu_src").glob("*.c"))]
PLANT = Path("fmu") / "AwasPlant"
every_source = pytest.mark.parametrize("source", SOURCES, ids=lambda path: path.name)

# False alarms of clang-tidy: file, check, line of code, why the alarm is wrong.
FALSE_ALARMS = (
    (
        "least_squares.c",
        "core.uninitialized.Assign",
        "rest[i] -= rest[j] * u[i];",
        "assumes that rls->size may change between two loops over it",
    ),
    (
        "stiffness_estimator.c",
        "core.UndefinedBinaryOperatorResult",
        "scaled[i] = eta_0[i] * units[i];",
        "assumes that loops over m and n have another length than one over n m",
    ),
    (
        "radau.c",
        "core.uninitialized.Assign",
        "x[j] = x_new[j];",
        "does not see that x_new was set if the error is at most 1",
    ),
)


def flags(source: Path, build: Path) -> list[str]:
    """Compiler options for a source of an FMU or of the library."""
    own = build / "fmu" / source.stem  # code that is generated for this file, or for every plant
    folders = [*c_sources.FOLDERS, REPOSITORY / "fmu_src", own if own.is_dir() else build / PLANT]
    headers = Path(fmpy.__file__).parent / "c-code"
    return ["-std=c99", *(f"-I{folder}" for folder in folders), f"-isystem{headers}"]


def run(*command: str | Path) -> str:
    done = subprocess.run([str(part) for part in command], capture_output=True, text=True)
    return done.stdout + done.stderr if done.returncode else ""


@every_source
def test_clang_tidy(source: Path, build: Path) -> None:
    if shutil.which("clang-tidy") is None:
        missing("clang-tidy", "apt-get install clang-tidy")
    text = run("clang-tidy", "--quiet", source, "--", *flags(source, build))
    found = re.findall(
        r"^\S+?([\w.]+):\d+:\d+: error: (.*) \[([^\n]*)\]\n(.*)$", text, re.MULTILINE
    )
    assert found or not text, text  # else it did not run
    wrong = [
        (file, check, line.strip())
        for file, _, check, line in found
        if not any(
            file == known and name in check and line.strip() == code
            for known, name, code, _ in FALSE_ALARMS
        )
    ]
    assert not wrong, text


def test_cppcheck(build: Path) -> None:
    if shutil.which("cppcheck") is None:
        missing("cppcheck", "apt-get install cppcheck")
    text = run(
        *("cppcheck", "--quiet", "--std=c99", "--enable=warning,style,performance,portability"),
        *("--inconclusive", "--error-exitcode=1"),
        # A static variable without an initial value is zero, as these are meant to be.
        "--suppress=unassignedVariable",
        # CasADi's functions read this array through the table of their arguments.
        f"--suppress=unreadVariable:{REPOSITORY / 'fmu_src' / 'plant.c'}",
        *(f"-I{folder}" for folder in [*c_sources.FOLDERS, REPOSITORY / "fmu_src", build / PLANT]),
        *SOURCES,
    )
    assert text == "", text


@every_source
def test_gcc_analyzer(source: Path, build: Path, tmp_path: Path) -> None:
    if shutil.which("gcc") is None:
        missing("gcc", "apt-get install gcc")
    output = tmp_path / "object.o"
    text = run(
        "gcc", "-O2", "-fanalyzer", "-Werror", *flags(source, build), "-c", source, "-o", output
    )
    assert text == "", text
