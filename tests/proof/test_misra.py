"""MISRA C:2012: the table of docs/proof/misra.md has all that does not follow a rule."""

import json
import re
import shutil
import subprocess
import sys
from collections import defaultdict
from pathlib import Path

import fmpy
import pytest

import c_sources
from c_sources import REPOSITORY
from controllers import run
from gate import missing, need

PAGE = REPOSITORY / "docs" / "proof" / "misra.md"
FOLDERS = ("c", "fmu_src")
CONFIGURATIONS = (
    (("SH_REAL=double", "__GNUC__", "__SSE2__"), FOLDERS),
    (("SH_REAL=float",), ("c",)),
)
"""Macros and folders. The second program uses the other branch of c/pair.h, which is plain C."""
HEADERS = [*c_sources.FOLDERS, REPOSITORY / "fmu_src", REPOSITORY / "fmu_src" / "shell"]
FMI_HEADERS = Path(fmpy.__file__).parent / "c-code"
# A checker for each file, as one writes what all files say together for its first file only.
PROGRAM = """
import sys
sys.path.insert(0, sys.argv.pop(1))
import misra
arguments = misra.get_args_parser().parse_args()
for file in arguments.dumpfile:
    misra.MisraChecker(misra.MisraSettings(arguments)).parseDump(file)
"""
Findings = dict[tuple[str, str], set[str]]
"""Places by rule and folder."""


def deviations() -> list[list[str]]:
    """The rows of the table: rule, category, "yes" or not for each of FOLDERS, reason."""
    rows = re.findall(r"^\| (\d+\.\d+ \|.*)\|$", PAGE.read_text(encoding="utf-8"), re.MULTILINE)
    table = [[cell.strip() for cell in row.split(" | ")] for row in rows]
    return [[rule, *rest] for rule, _, *rest in table]


@pytest.fixture(scope="module", autouse=True)
def cppcheck() -> None:
    """The version that the page names: another one finds other places."""
    named = re.search(r"cppcheck (\d+\.\d+)", PAGE.read_text(encoding="utf-8"))
    assert named
    there = run(need("cppcheck"), "--version")
    if there.split()[1] != named[1]:
        missing(f"cppcheck {named[1]}", f"apt-get install cppcheck; there is {there}")


def addons() -> Path:
    """The folder with misra.py. `cppcheck --addon` shows only one of the findings of a line."""
    prefix = Path(need("cppcheck")).resolve().parents[1]
    for pattern in ("lib/*/cppcheck/addons/misra.py", "share/cppcheck/addons/misra.py"):
        for file in prefix.glob(pattern):
            return file.parent
    missing("misra.py of cppcheck", "apt-get install cppcheck")


def ask(tree: Path, pattern: str, found: Findings, *script: str | Path) -> None:
    """Adds the findings in c/ and fmu_src/ that the program prints for all files `pattern`."""
    files = sorted(str(file.relative_to(tree)) for file in tree.rglob(pattern))
    command = [sys.executable, *script, "--cli", *files]
    done = subprocess.run(command, cwd=tree, capture_output=True, text=True, check=True)
    for line in map(json.loads, done.stdout.splitlines()):
        file = Path(line["file"])
        if not file.is_absolute():  # else it is a header of FMI or a generated file
            rule = line["errorId"].removeprefix("c2012-")
            found[rule, file.parts[0]].add(f"{file}:{line['linenr']}:{line['column']}")


def findings(folder: Path, build: Path) -> Findings:
    """The findings in all configurations. The argument `folder` is a place for temporary files."""
    found: Findings = defaultdict(set)
    for index, (macros, names) in enumerate(CONFIGURATIONS):
        tree = folder / str(index)
        groups: dict[Path, list[str]] = {}  # by the folder of generated code
        for name in names:
            shutil.copytree(REPOSITORY / name, tree / name)
            for source in sorted((REPOSITORY / name).rglob("*.c")):
                own = build / "fmu" / source.stem
                generated = own if own.is_dir() else build / "fmu" / "AwasPlant"
                groups.setdefault(generated, []).append(str(source.relative_to(REPOSITORY)))
        headers = [each.relative_to(REPOSITORY) for each in HEADERS]
        for generated, sources in groups.items():  # writes FILE.dump beside each source
            command = [need("cppcheck"), "--dump", "--quiet", "--std=c99"]
            command += [f"-D{macro}" for macro in macros]
            command += [f"-I{each}" for each in (*headers, generated, FMI_HEADERS)]
            subprocess.run([*command, *sources], cwd=tree, check=True)
        ask(tree, "*.dump", found, "-c", PROGRAM, addons())
        ask(tree, "*.ctu-info", found, addons() / "misra.py")  # in all files together
    return found


def test_the_table_is_in_order() -> None:
    table = deviations()
    numbers = [tuple(map(int, rule.split("."))) for rule, *_ in table]
    assert numbers == sorted(set(numbers))
    for rule, category, *places, reason in table:
        assert category in ("required", "advisory"), rule  # mandatory: no deviation
        assert "yes" in places and reason, rule


@pytest.mark.complete
@pytest.mark.slow("the addon of cppcheck, a Python program, reads all files, twice")
def test_the_table_has_the_rules_that_are_not_followed(build: Path, tmp_path: Path) -> None:
    """In each folder: no rule is missing, and none is in the table without a finding."""
    table = {
        (rule, folder)
        for rule, _, *places, _ in deviations()
        for folder, told in zip(FOLDERS, places, strict=True)
        if told == "yes"
    }
    found = findings(tmp_path, build)
    wrong = {rule: sorted(found.get(rule, [])) for rule in table ^ found.keys()}
    assert not wrong, wrong
