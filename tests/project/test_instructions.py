"""Speed without a clock: the fast parts need as many instructions as the table says."""

from __future__ import annotations

import os
import platform
import re
import subprocess
import sys
from pathlib import Path

import pytest
import tomlkit

from c_programs import compile_driver
from gate import need

TABLE = Path(__file__).parent / "instructions.toml"
FLAGS = ("-target", "x86_64-linux-musl", "-static", "-O3")  # the C library comes with the compiler
MORE = 0.02  # so much more is a loss
FEW, MANY = 300, 900  # rounds; what a start costs is in both
METHODS = {"tick of Paper2011": "1", "tick of FilteredRegression": "2"}


def counted(program: Path, subject: str) -> float:
    totals = []
    for rounds in (FEW, MANY):
        valgrind = [need("valgrind"), "--tool=cachegrind", "--cache-sim=no"]
        command = [*valgrind, "--cachegrind-out-file=/dev/null", str(program), subject, str(rounds)]
        done = subprocess.run(command, capture_output=True, text=True, check=True)
        (total,) = re.findall(r"I +refs: +([\d,]+)", done.stderr)
        totals.append(int(total.replace(",", "")))
    return (totals[1] - totals[0]) / (MANY - FEW)


@pytest.mark.skipif(platform.machine() != "x86_64" or sys.platform != "linux", reason="for Linux")
@pytest.mark.slow("valgrind executes each part thousands of times, a hundred times slower")
def test_nothing_needs_more_instructions(build: Path, tmp_path: Path) -> None:
    compiler = tmp_path / "cc"
    compiler.write_text(f'#!/bin/sh\nexec "{sys.executable}" -m ziglang cc "$@"\n')
    compiler.chmod(0o755)
    programs = {
        fmu: compile_driver("instructions", fmu, "fmi2", build, tmp_path, str(compiler), flags)
        for fmu, flags in (("StiffnessEstimator", FLAGS), ("AwasPlant", (*FLAGS, "-DSH_PLANT")))
    }
    estimator = programs["StiffnessEstimator"]
    found = {"least squares, 18 parameters": counted(estimator, "least_squares")}
    found |= {name: counted(estimator, method) for name, method in METHODS.items()}
    step = counted(estimator, "step")
    found["FMU, step in addition to the tick"] = step - found["tick of Paper2011"]
    found["AwasPlant, step"] = counted(programs["AwasPlant"], "step")
    if os.environ.get("SIGMAHAT_COUNT"):
        comments = [line for line in TABLE.read_text().splitlines() if line.startswith("#")]
        rows = tomlkit.dumps({name: round(count) for name, count in found.items()})
        TABLE.write_text("\n".join(comments) + "\n" + rows)
    table = tomlkit.parse(TABLE.read_text()).unwrap()
    assert found.keys() == table.keys()
    more = {name: (n, table[name]) for name, n in found.items() if n > (1 + MORE) * table[name]}
    assert not more, f"instructions now, and in {TABLE.name}: {more}"
