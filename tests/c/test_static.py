"""Static analysers find no error in the C code."""

from __future__ import annotations

import re
import subprocess
from pathlib import Path

import fmpy
import pytest

import c_sources
from gate import need, need_of_environment

REPOSITORY = Path(__file__).parents[2]
SOURCES = [*c_sources.SOURCES, *c_sources.OTHERS]
every_source = pytest.mark.parametrize("source", SOURCES, ids=lambda path: path.name)

# False alarms of clang-tidy: file, check, line of code, why the alarm is wrong.
FALSE_ALARMS = (
    (
        "radau.c",
        "core.uninitialized.Assign",
        "x[j] = x_new[j];",
        "does not see that x_new was set if the error is at most 1",
    ),
)


@pytest.mark.parametrize(("file", "code"), [(file, code) for file, _, code, _ in FALSE_ALARMS])
def test_every_false_alarm_is_about_code_that_exists(file: str, code: str) -> None:
    (source,) = (source for source in SOURCES if source.name == file)
    assert code in map(str.strip, source.read_text().splitlines())


def flags(source: Path, build: Path) -> list[str]:
    """Compiler options for a source of an FMU or of the library."""
    folders = [*c_sources.FOLDERS, *c_sources.OTHER_FOLDERS, c_sources.generated(source, build)]
    headers = Path(fmpy.__file__).parent / "c-code"
    return ["-std=c99", *(f"-I{folder}" for folder in folders), f"-isystem{headers}"]


def run(*command: str | Path) -> str:
    done = subprocess.run([str(part) for part in command], capture_output=True, text=True)
    return done.stdout + done.stderr if done.returncode else ""


@every_source
def test_clang_tidy(source: Path, build: Path) -> None:
    text = run(need("clang-tidy"), "--quiet", source, "--", *flags(source, build))
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
    folders = [*c_sources.FOLDERS, *c_sources.OTHER_FOLDERS, build / "fmu" / "AwasPlant"]
    text = run(
        *(
            need("cppcheck"),
            "--quiet",
            "--std=c99",
            "--enable=warning,style,performance,portability",
        ),
        *("--inconclusive", "--error-exitcode=1"),
        # A static variable without an initial value is zero, as these are meant to be.
        "--suppress=unassignedVariable",
        # CasADi's functions read this array through the table of their arguments.
        f"--suppress=unreadVariable:{REPOSITORY / 'fmu_src' / 'plant.c'}",
        *(f"-I{folder}" for folder in folders),
        *SOURCES,
    )
    assert text == "", text


@every_source
def test_gcc_analyzer(source: Path, build: Path, tmp_path: Path) -> None:
    output = tmp_path / "object.o"
    text = run(
        need("gcc"),
        "-O2",
        "-fanalyzer",
        "-Werror",
        *flags(source, build),
        "-c",
        source,
        "-o",
        output,
    )
    assert text == "", text


def c_files() -> list[Path]:
    """All C and C++ of the project."""
    folders = ("c", "fmu_src", "harness", "bench", "examples", "modelica", "tests")
    return sorted(
        file
        for folder in folders
        for pattern in ("*.c", "*.h", "*.cpp")
        for file in (REPOSITORY / folder).rglob(pattern)
    )


def test_clang_format() -> None:
    """The layout is that of .clang-format, by the version that the environment pins."""
    text = run(need_of_environment("clang-format"), "--dry-run", "--Werror", *c_files())
    assert text == "", text


@pytest.mark.parametrize("file", c_files(), ids=lambda path: path.name)
def test_no_function_is_longer_than_80_lines(file: Path) -> None:
    lines = file.read_text().splitlines()
    first = 0
    for number, line in enumerate(lines):
        if line == "{":
            first = number
        elif line == "}" and first:
            assert number - first < 80, f"line {first}"
            first = 0
