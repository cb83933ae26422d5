"""What the MISRA addon of cppcheck finds in c/ and fmu_src/."""

import json
import shutil
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

import fmpy

import c_sources
from c_sources import REPOSITORY
from gate import missing, need

LIBRARY = ("c",)
FMU = ("c", "fmu_src")
CONFIGURATIONS = (
    (("SH_REAL=double", "__GNUC__", "__SSE2__"), FMU),
    (("SH_REAL=float",), LIBRARY),
)
"""Macros and folders. The second one takes the other branch of c/pair.h, which is plain C."""

FOLDERS = [*c_sources.FOLDERS, REPOSITORY / "fmu_src", REPOSITORY / "fmu_src" / "shell"]
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


@dataclass(frozen=True)
class Finding:
    """One place that does not follow a rule."""

    rule: str
    file: str
    line: int
    column: int


def version() -> str:
    """Version of cppcheck, such as 2.10."""
    done = subprocess.run(
        [need("cppcheck"), "--version"], capture_output=True, text=True, check=True
    )
    return done.stdout.split()[1]


def addons() -> Path:
    """The folder with misra.py. `cppcheck --addon` shows only one of the findings of a line."""
    prefix = Path(need("cppcheck")).resolve().parents[1]
    for pattern in ("lib/*/cppcheck/addons/misra.py", "share/cppcheck/addons/misra.py"):
        for file in prefix.glob(pattern):
            return file.parent
    missing("misra.py of cppcheck", "apt-get install cppcheck")


def ask(tree: Path, pattern: str, *script: str | Path) -> set[Finding]:
    """The findings in files of c/ and fmu_src/ that the program prints for all files `pattern`."""
    files = sorted(str(file.relative_to(tree)) for file in tree.rglob(pattern))
    done = subprocess.run(
        [sys.executable, *script, "--cli", *files],
        cwd=tree,
        capture_output=True,
        text=True,
        check=True,
    )
    found = set()
    for text in done.stdout.splitlines():
        line = json.loads(text)
        file = Path(line["file"])
        if not file.is_absolute():  # else it is a header of FMI or a generated file
            rule = line["errorId"].removeprefix("c2012-")
            found.add(Finding(rule, file.as_posix(), line["linenr"], line["column"]))
    return found


def findings(folder: Path, build: Path) -> set[Finding]:
    """The findings in all configurations. `folder` is for files that nobody needs later."""
    found = set()
    for index, (macros, names) in enumerate(CONFIGURATIONS):
        tree = folder / str(index)
        groups: dict[Path, list[str]] = {}  # by the folder of generated code
        for name in names:
            shutil.copytree(REPOSITORY / name, tree / name)
            for source in sorted((REPOSITORY / name).rglob("*.c")):
                group = groups.setdefault(c_sources.generated(source, build), [])
                group.append(str(source.relative_to(REPOSITORY)))
        headers = [each.relative_to(REPOSITORY) for each in FOLDERS]
        for generated, sources in groups.items():  # writes FILE.dump beside each source
            command = [need("cppcheck"), "--dump", "--quiet", "--std=c99"]
            command += [f"-D{macro}" for macro in macros]
            command += [f"-I{each}" for each in (*headers, generated, FMI_HEADERS)]
            subprocess.run([*command, *sources], cwd=tree, check=True)
        found |= ask(tree, "*.dump", "-c", PROGRAM, addons())
        found |= ask(tree, "*.ctu-info", addons() / "misra.py")  # in all files together
    return found
