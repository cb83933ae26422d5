"""Estimators that run for a very long time, compared with the same in higher precision.

    build/venv/bin/python tests/studies/endurance.py

runs every case of CASES in full, one after the other, and prints the table of docs/endurance.md.
The outputs at the checkpoints are written to build/endurance/. The C program is in
drivers/endurance*.c.
"""

from __future__ import annotations

import subprocess
import sys
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

REPOSITORY = Path(__file__).resolve().parents[2]
LIBRARY = REPOSITORY / "c"
DRIVERS = REPOSITORY / "tests" / "drivers"
METHODS = {1: "Paper2011", 2: "FilteredRegression"}
OUTPUTS = (
    "sigma", "tau_e", "sigma_std", "tau_e_residual", "theta_dot", "D_theta", "B", "tau_coulomb",
)  # fmt: skip
FLAGS = ("-std=gnu99", "-D_GNU_SOURCE", "-O2", "-ffp-contract=off")
# Definitions for the type of the library and for its functions and constants, see c/real_math.h.
PRECISIONS = {
    "double": (),
    "long double": ("-DSH_REAL=_Float64x", "-DSH_FOR__Float64x(a,b)=a##f64x"),
    "quad": ("-DSH_REAL=_Float128", "-DSH_FOR__Float128(a,b)=a##f128"),
}
# Largest difference between double and long double over a million ticks, relative to the output.
BOUND = 1e-9


@dataclass(frozen=True)
class Case:
    """An estimator with n x m coefficients of the torque, the ratio of the huge torque to the usual
    one, and the numbers of ticks of its run and of the reference.
    """

    method: int
    n: int
    m: int
    torque: float
    ticks: int
    reference_ticks: int


CASES = (
    Case(1, 6, 3, 1e6, 10**9, 10**8),
    Case(2, 3, 3, 1e3, 10**9, 10**8),
    Case(2, 3, 3, 1e6, 10**8, 10**7),
)


def compile_program(
    folder: Path, precision: str, compiler: str = "gcc", flags: Sequence[str] = ()
) -> Path:
    """Compiles drivers/endurance.c and the estimator, in a precision of PRECISIONS."""
    program = Path(tempfile.mkdtemp(dir=folder)) / precision.replace(" ", "_")
    sources = [*DRIVERS.glob("endurance*.c"), *LIBRARY.rglob("*.c")]
    folders = sorted({header.parent for header in LIBRARY.rglob("*.h")})
    command = [
        *(compiler, *FLAGS, *PRECISIONS[precision], *flags),
        *(f"-I{folder}" for folder in [*folders, DRIVERS]),
        *map(str, sources),
        *("-lm", "-o", str(program)),
    ]
    subprocess.run(command, check=True)
    return program


def scaled(value: NDArray[np.longdouble], reference: NDArray[np.longdouble]) -> float:
    """Largest difference relative to the reference, or to its median if that is larger."""
    size = np.maximum(abs(reference), np.median(abs(reference), axis=0))
    size[size == 0.0] = 1.0
    return float(np.max(abs(value - reference) / size))


Checkpoints = list[list[np.longdouble]]  # [checkpoint][tick, outputs...]


def run(program: Path, case: Case, ticks: int, output: Path) -> Checkpoints:
    """Runs an estimator, which writes its checkpoints to a file.

    Raises CalledProcessError if P is not positive definite or an output is not finite.
    """
    arguments = [str(number) for number in (case.method, case.n, case.m, case.torque, ticks)]
    with output.open("w") as file:
        subprocess.run([str(program), *arguments], stdout=file, check=True)
    return [[np.longdouble(word) for word in line.split()] for line in output.open()]


def difference(run: Checkpoints, reference: Checkpoints) -> tuple[float, str]:
    """Largest difference at the checkpoints that both runs have, and the name of the output."""
    known = {row[0]: row[1:] for row in reference}
    pairs = [(row[1:], known[row[0]]) for row in run if row[0] in known]
    of_run, of_reference = (np.array(rows) for rows in zip(*pairs, strict=True))
    of = [scaled(of_run[:, i], of_reference[:, i]) for i in range(len(OUTPUTS))]
    return max(of), OUTPUTS[int(np.argmax(of))]


def compare(case: Case, program: Path, reference: Path, folder: Path) -> tuple[float, str]:
    """Largest difference between a run and its reference, and the name of the output."""
    name = f"{METHODS[case.method]}_{case.n}x{case.m}_{case.torque:.0e}"
    return difference(
        run(program, case, case.ticks, folder / f"{name}_{program.name}.txt"),
        run(reference, case, case.reference_ticks, folder / f"{name}_{reference.name}.txt"),
    )


def main() -> int:
    folder = REPOSITORY / "build" / "endurance"
    folder.mkdir(parents=True, exist_ok=True)
    print("| method | parameters | huge torque | ticks | reference | largest difference | of |")
    print("|---|---|---|---|---|---|---|", flush=True)
    program = compile_program(folder, "double")
    reference = compile_program(folder, "long double")
    for case in CASES:
        largest, output = compare(case, program, reference, folder)
        size = case.n * case.m + (3 if case.method == 2 else 0)
        print(
            f"| {METHODS[case.method]} | {size} | {case.torque:.0e} | {case.ticks:.0e} | "
            f"{case.reference_ticks:.0e} | {largest:.1e} | {output} |",
            flush=True,
        )
    return 0


if __name__ == "__main__":
    sys.exit(main())
