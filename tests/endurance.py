"""Estimators that run for a very long time, beside the same in higher precision.

    build/venv/bin/python tests/endurance.py

runs every case of CASES in full, which takes an hour of one core, and prints the table of
docs/endurance.md. The C programs are in drivers/endurance*.c.
"""

from __future__ import annotations

import subprocess
import sys
import tempfile
from collections.abc import Iterator, Sequence
from contextlib import ExitStack
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

REPOSITORY = Path(__file__).resolve().parent.parent
DRIVERS = REPOSITORY / "tests" / "drivers"
METHODS = {1: "Paper2011", 2: "MatchedFilter"}
OUTPUTS = (
    "sigma", "tau_e", "sigma_std", "tau_e_residual", "theta_dot", "D_theta", "B", "tau_coulomb",
)  # fmt: skip
FLAGS = ("-std=gnu99", "-O2", "-ffp-contract=off")
PRECISIONS = {
    "double": (),
    "long double": ("-include", "high_precision.h"),
    "quad": ("-DHIGH_PRECISION_QUAD", "-include", "high_precision.h"),
}
# Largest difference between double and the reference over a million ticks, and over any number:
# rounding adds up in what is never forgotten. Relative to the output [1].
BOUND = 1e-9
LONG_BOUND = 1e-6


@dataclass(frozen=True)
class Case:
    """An estimator with n x m coefficients of the torque, and how long it and its reference run."""

    method: int
    n: int
    m: int
    ticks: int
    reference_ticks: int


CASES = (
    Case(1, 6, 3, 10**9, 10**8),
    Case(1, 2, 1, 10**9, 10**9),
    Case(2, 1, 1, 10**9, 2 * 10**8),
    Case(2, 6, 3, 10**8, 10**7),
)


def compile_program(
    folder: Path, precision: str, compiler: str = "gcc", flags: Sequence[str] = ()
) -> Path:
    """drivers/endurance.c with the estimator in a precision of PRECISIONS, in a new folder."""
    folder = Path(tempfile.mkdtemp(dir=folder))
    name = precision.replace(" ", "_")
    common = [compiler, *FLAGS, *flags, f"-I{REPOSITORY / 'c'}", f"-I{DRIVERS}"]
    stream = folder / f"{name}.o"
    sources = [DRIVERS / "endurance.c", *sorted((REPOSITORY / "c").glob("*.c"))]
    for command in (
        [*common, "-c", DRIVERS / "endurance_input.c", "-o", stream],
        [
            *common, *PRECISIONS[precision], *sources, stream,
            "-lquadmath" if precision == "quad" else "-lm", "-lm", "-o", folder / name,
        ],
    ):  # fmt: skip
        subprocess.run([str(part) for part in command], check=True)
    return folder / name


def scaled(value: NDArray[np.longdouble], reference: NDArray[np.longdouble]) -> float:
    """Largest difference relative to the reference, or to its median where it is less."""
    size = np.maximum(abs(reference), np.median(abs(reference), axis=0))
    size[size == 0.0] = 1.0
    return float(np.max(abs(value - reference) / size))


@dataclass
class Result:
    """Checkpoints of a run and of its reference, [checkpoint][tick, outputs...]."""

    run: list[list[np.longdouble]] = field(default_factory=list)
    reference: list[list[np.longdouble]] = field(default_factory=list)

    def difference(self) -> tuple[float, str]:
        """The largest one of all outputs at all checkpoints, and the output."""
        known = {row[0]: row[1:] for row in self.reference}
        pairs = [(row[1:], known[row[0]]) for row in self.run if row[0] in known]
        run, reference = (np.array(rows) for rows in zip(*pairs, strict=True))
        of = [scaled(run[:, i], reference[:, i]) for i in range(len(OUTPUTS))]
        return max(of), OUTPUTS[int(np.argmax(of))]


def rows(process: subprocess.Popen[str]) -> Iterator[list[np.longdouble]]:
    assert process.stdout is not None
    for line in process.stdout:
        yield [np.longdouble(word) for word in line.split()]


def compare(case: Case, program: Path, reference: Path) -> Result:
    """Runs both at once. Raises CalledProcessError if one of them stops early."""
    arguments = [str(number) for number in (case.method, case.n, case.m)]
    commands = (
        [str(program), *arguments, str(case.ticks)],
        [str(reference), *arguments, str(case.reference_ticks)],
    )
    with ExitStack() as stack:
        processes = [
            stack.enter_context(subprocess.Popen(command, stdout=subprocess.PIPE, text=True))
            for command in commands
        ]
        result = Result(*(list(rows(process)) for process in processes))
    for process, command in zip(processes, commands, strict=True):
        if process.returncode:
            raise subprocess.CalledProcessError(process.returncode, command)
    return result


def main() -> int:
    print("| method | parameters | ticks | reference | largest difference | of |")
    print("|---|---|---|---|---|---|", flush=True)
    worst = 0.0
    with tempfile.TemporaryDirectory() as name:
        program = compile_program(Path(name), "double")
        reference = compile_program(Path(name), "long double")
        for case in CASES:
            difference, output = compare(case, program, reference).difference()
            size = case.n * case.m + (3 if case.method == 2 else 0)
            print(
                f"| {METHODS[case.method]} | {size} | {case.ticks:.0e} | "
                f"{case.reference_ticks:.0e} | {difference:.1e} | {output} |",
                flush=True,
            )
            worst = max(worst, difference)
    return int(worst > LONG_BOUND)


if __name__ == "__main__":
    sys.exit(main())
