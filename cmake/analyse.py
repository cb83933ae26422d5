"""gcc with its analyser, clang-tidy and cppcheck find nothing in the C code of the build tree."""

import json
import os
import shlex
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

REPOSITORY = Path(__file__).parents[1]
BUILD = REPOSITORY / "build"
FOLDERS = [REPOSITORY / name for name in ("c", "fmu_src", "harness/native")]
CPPCHECK = (
    *("cppcheck", "--quiet", "--std=c99", "--enable=warning,style,performance,portability"),
    *("--inconclusive", "--error-exitcode=1"),
    # A static variable without an initial value is zero, as these are meant to be.
    "--suppress=unassignedVariable",
    # CasADi's functions read this array through the table of their arguments.
    f"--suppress=unreadVariable:{REPOSITORY / 'fmu_src' / 'plant.c'}",
)


def commands() -> dict[Path, list[str]]:
    """The options of the compiler for each source: the first ones, if it is compiled often."""
    found: dict[Path, list[str]] = {}
    for each in json.loads((BUILD / "compile_commands.json").read_text(encoding="utf-8")):
        source = Path(each["file"])
        if any(folder in source.parents for folder in FOLDERS):
            found.setdefault(source, shlex.split(each["command"])[1:])
    return found


def complaints(command: list[str]) -> str:
    done = subprocess.run(command, cwd=BUILD, capture_output=True, text=True)
    return done.stdout + done.stderr if done.returncode else ""


def main() -> None:
    options = commands()
    folders = {option for each in options.values() for option in each if option.startswith("-I")}
    every = [[*CPPCHECK, *sorted(folders), *map(str, options)]]
    for source, flags in options.items():
        every.append(["gcc", *flags, "-fanalyzer", "-Werror", "-o", os.devnull])
        every.append(["clang-tidy", "--quiet", str(source), "--", *flags])
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        found = list(filter(None, pool.map(complaints, every)))
    sys.exit("\n".join(found) or None)


if __name__ == "__main__":
    main()
