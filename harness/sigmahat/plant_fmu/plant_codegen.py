"""Generates the C code of a plant: ``plant_functions.c`` and ``plant_functions.h``."""

from collections.abc import Iterable, Sequence
from pathlib import Path

import casadi as ca

from sigmahat.plants.equations import PlantEquations


class Elimination:
    """Factors of a square sparse matrix, and the solution of systems with this matrix.

    Pivots are diagonal entries, in the order of the least possible fill-in (Markowitz), with any
    values. This suits the matrices s I - J of an implicit integration, where s is large.
    """

    def __init__(self, matrix: ca.SX) -> None:
        size = matrix.size1()
        self._rows: list[dict[int, ca.SX]] = [{} for _ in range(size)]
        for row, column in zip(*matrix.sparsity().get_triplet(), strict=True):
            self._rows[row][column] = matrix[row, column]
        self._order: list[int] = []
        rest = set(range(size))

        def fill_in(pivot: int) -> int:
            """Returns an upper limit of the number of entries that become nonzero."""
            in_row = len(self._rows[pivot].keys() & rest)
            return (in_row - 1) * (sum(pivot in self._rows[i] for i in rest) - 1)

        while rest:
            pivot = min(rest, key=lambda k: (fill_in(k), k))
            rest.remove(pivot)
            self._order.append(pivot)
            self._eliminate(pivot, rest)

    def _eliminate(self, pivot: int, rest: set[int]) -> None:
        """Keeps 1/pivot on the diagonal, and the multipliers below the diagonal."""
        row = self._rows[pivot]
        row[pivot] = 1 / row[pivot]
        for i in sorted(rest):
            if pivot in self._rows[i]:
                multiplier = self._rows[i][pivot] = self._rows[i][pivot] * row[pivot]
                for j in sorted(row.keys() & rest):
                    self._rows[i][j] = self._rows[i].get(j, 0) - multiplier * row[j]

    @property
    def factors(self) -> ca.SX:
        """Returns all entries of the factors [size: k]."""
        return ca.vertcat(*(row[j] for row in self._rows for j in sorted(row)))

    def solve(self, factors: ca.SX, b: ca.SX) -> ca.SX:
        """Solves the system for the right-hand side b [size: n], given the entries `factors`."""
        entry = iter(ca.vertsplit(factors))
        rows = [{j: next(entry) for j in sorted(row)} for row in self._rows]
        x = ca.vertsplit(b)
        for k, pivot in enumerate(self._order):
            for i in self._order[k + 1 :]:
                if pivot in rows[i]:
                    x[i] -= rows[i][pivot] * x[pivot]
        for k, pivot in reversed(list(enumerate(self._order))):
            for j in self._order[k + 1 :]:
                if j in rows[pivot]:
                    x[pivot] -= rows[pivot][j] * x[j]
            x[pivot] *= rows[pivot][pivot]
        return ca.vertcat(*x)


# CasADi keeps truth values in doubles, and all its functions have the same arguments.
_QUIET = """\
#ifdef __GNUC__
#pragma GCC diagnostic ignored "-Wunused-parameter"
#pragma GCC diagnostic ignored "-Wfloat-conversion"
#endif
"""


def functions(
    plant: PlantEquations, parameters: Sequence[str], inputs: Sequence[str], outputs: Sequence[str]
) -> list[ca.Function]:
    """Returns the functions that ``fmu_src/plant.c`` and ``fmu_src/radau.c`` call.

    Vectors p, u and y are in the order given, which must name each variable of the plant once.
    Raises ValueError if names are missing or unknown, or the equations of the plant not complete.
    """
    _compare(plant, "parameter", plant.parameters, parameters)
    _compare(plant, "input", plant.inputs, inputs)
    _compare(plant, "output", plant.outputs, outputs)
    _compare(plant, "derivative of state", plant.derivatives, plant.states)
    x = ca.vertcat(*(state.symbol for state in plant.states.values()))
    u = ca.vertcat(*(plant.inputs[name] for name in inputs))
    p = ca.vertcat(*(plant.parameters[name] for name in parameters))
    normals = ca.vertcat(*plant.normals)
    start = ca.vertcat(*(state.start for state in plant.states.values()))
    xdot = ca.vertcat(*(plant.derivatives[name] for name in plant.states))
    y = ca.vertcat(*(plant.outputs[name] for name in outputs))

    # Matrices of Newton's iteration of Radau IIA: (REAL/h - J) and ((RE + i IM)/h - J). The second
    # matrix is written as a real system of twice the size.
    size = x.size1()
    J = ca.jacobian(xdot, x)
    one = ca.SX.eye(size)
    shifts = ca.SX.sym("shifts", 3)
    real, re, im = ca.vertsplit(shifts)
    real_system = Elimination(real * one - J)
    complex_system = Elimination(ca.blockcat([[re * one - J, -im * one], [im * one, re * one - J]]))
    made = ca.vertcat(real_system.factors, complex_system.factors)
    factors = ca.SX.sym("factors", made.size1())
    of_real, of_complex = ca.vertsplit(factors, [0, real_system.factors.size1(), factors.size1()])
    b = ca.SX.sym("b", size)
    b_im = ca.SX.sym("b_im", size)
    z_real = real_system.solve(of_real, b)
    z_complex = complex_system.solve(of_complex, ca.vertcat(b, b_im))
    return [
        ca.Function("sh_plant_start", [p], [ca.densify(start)]),
        ca.Function("sh_plant_xdot", [x, u, p], [ca.densify(xdot)]),
        ca.Function("sh_plant_outputs", [x, u, p, normals], [ca.densify(y)]),
        ca.Function("sh_plant_factorize", [x, u, p, shifts], [made]),
        ca.Function("sh_plant_solve_real", [factors, b], [z_real]),
        ca.Function("sh_plant_solve_complex", [factors, b, b_im], ca.vertsplit(z_complex, size)),
    ]


def write(
    plant: PlantEquations,
    parameters: Sequence[str],
    inputs: Sequence[str],
    outputs: Sequence[str],
    folder: Path,
) -> None:
    """Write the C code of a plant into a folder; variables as in `functions`."""
    generated = {f.name(): f for f in functions(plant, parameters, inputs, outputs)}
    generator = ca.CodeGenerator(
        "plant_functions", {"casadi_int": "int", "with_export": False, "verbose": False}
    )
    for function in generated.values():
        generator.add(function)
    factors = generated["sh_plant_factorize"].numel_out(0)
    scales = ", ".join(repr(state.scale) for state in plant.states.values())
    declared = "\n".join(
        f"int {name}(const double **arg, double **res, int *iw, double *w, int mem);"
        for name in generated
    )
    header = f"""\
/* Generated from the equations of {plant.name}; do not edit. */
#ifndef SH_PLANT_FUNCTIONS_H
#define SH_PLANT_FUNCTIONS_H

#define SH_PLANT_PARAMETERS {len(parameters)}
#define SH_PLANT_INPUTS {len(inputs)}
#define SH_PLANT_OUTPUTS {len(outputs)}
#define SH_PLANT_STATES {len(plant.states)}
#define SH_PLANT_NORMALS {len(plant.normals)}
#define SH_PLANT_FACTORS {factors}
#define SH_PLANT_SCALES {{{scales}}} /* of the states */

{declared}

#endif
"""
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "plant_functions.h").write_text(header, encoding="utf-8")
    (folder / "plant_functions.c").write_text(_QUIET + generator.dump(), encoding="utf-8")


def _compare(
    plant: PlantEquations, kind: str, in_equations: Iterable[str], described: Iterable[str]
) -> None:
    """Raises ValueError unless the names in the equations are exactly the names described."""
    defined = set(in_equations)
    expected = set(described)
    if not defined:
        raise ValueError(f"{plant.name}: expected at least one {kind}, got none")
    for name in sorted(expected - defined):
        raise ValueError(f"{plant.name}: the equations have no {kind} {name}")
    for name in sorted(defined - expected):
        raise ValueError(f"{plant.name}: the model description has no {kind} {name}")
