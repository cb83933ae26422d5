"""Time-critical functions need at most as many processor instructions as a table allows."""

import os
import platform
import re
import sys
from collections import defaultdict
from collections.abc import Mapping
from pathlib import Path

import pytest
import tomlkit

from c_programs import compile_driver
from controllers import run
from gate import need

TABLE = Path(__file__).parent / "instructions.toml"
FLAGS = ("-target", "x86_64-linux-musl", "-static", "-O3")  # static C library
MORE = 0.02  # largest allowed increase
STEPS = 600  # steps of instructions.c
PAPER2011, FILTERED_REGRESSION = "1", "2"
ROW = r"^ *([\d,]+) \(.*?\) +\S+:(\w+)"  # instructions and function in callgrind_annotate


def counted(program: Path, method: str) -> Mapping[str, float]:
    """Returns the instructions per step of each function, including the functions it calls."""
    profile = program.with_name("profile")
    valgrind = need("valgrind")
    run(valgrind, "--tool=callgrind", f"--callgrind-out-file={profile}", program, method)
    annotate = Path(valgrind).with_name("callgrind_annotate")
    options = ["--inclusive=yes", "--auto=no", "--threshold=100"]
    # The working folder contains no sources, because callgrind_annotate would list these twice.
    listed = run(annotate, *options, profile, cwd=program.parent)
    found: defaultdict[str, float] = defaultdict(float)
    # A function has a row for its source file, and one more for each header with inline functions,
    # whose instructions are also among those of the first row.
    for total, function in re.findall(ROW, listed, re.M):
        found[function] = max(found[function], int(total.replace(",", "")) / STEPS)
    return found


@pytest.mark.skipif(platform.machine() != "x86_64" or sys.platform != "linux", reason="for Linux")
@pytest.mark.slow("the programs are compiled with their C library, and run in valgrind")
def test_nothing_needs_more_instructions(build: Path, tmp_path: Path) -> None:
    compiler = tmp_path / "cc"
    compiler.write_text(f'#!/bin/sh\nexec "{sys.executable}" -m ziglang cc "$@"\n')
    compiler.chmod(0o755)
    estimator, plant = (
        compile_driver("instructions", fmu, "fmi2", build, tmp_path, str(compiler), FLAGS)
        for fmu in ("StiffnessEstimator", "AwasPlant")
    )
    paper, regression = (counted(estimator, m) for m in (PAPER2011, FILTERED_REGRESSION))
    found = {
        "least squares, 18 parameters": paper["sh_least_squares_update"],
        "tick of Paper2011": paper["sh_estimator_tick"],
        "tick of FilteredRegression": regression["sh_estimator_tick"],
        "FMU, step in addition to the tick": paper["fmi2DoStep"] - paper["sh_estimator_tick"],
        "AwasPlant, step": counted(plant, PAPER2011)["fmi2DoStep"],
    }
    found |= {f"FMU, {f}": paper[f] for f in ("fmi2SetReal", "fmi2GetReal")}
    if os.environ.get("SIGMAHAT_COUNT"):
        comments = [line for line in TABLE.read_text().splitlines() if line.startswith("#")]
        rows = tomlkit.dumps({name: round(count) for name, count in found.items()})
        TABLE.write_text("\n".join(comments) + "\n" + rows)
    table = tomlkit.parse(TABLE.read_text()).unwrap()
    assert found.keys() == table.keys()
    more = {name: (n, table[name]) for name, n in found.items() if n > (1 + MORE) * table[name]}
    assert not more, f"instructions now, and in {TABLE.name}: {more}"
