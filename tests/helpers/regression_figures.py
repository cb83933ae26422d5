"""Figures of docs/filtered-regression/: outputs, a row, blocks and a change, of simulated joints.

    python tests/helpers/regression_figures.py FOLDER

draws filtered-regression.png, row.png, block.png and change.png. The states inside of the estimator
are read from the C library of the build tree.
"""

import os
import sys
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from c_library import Array, Estimator, Library, load
from regression_joint import PLAIN, SETTINGS, Joint, MisfitJoint, T
from sigmahat.show.figure import in_rows, save
from sigmahat.show.panel import COLORS, TRUE, FigureRows, Panel, Trace, TraceKind

REPOSITORY = Path(__file__).parents[2]
REGRESSION = {"method": 2, "rls.n": 3}
AT = 15.0
"""Time of the change [s]."""
CHANGES = Joint(
    duration=20.0, tau_coulomb=0.02, D_theta=1.1e-3, stiffness=lambda t: np.where(t < AT, 1.0, 0.6)
)
FITS = MisfitJoint(duration=8.0)
DOES_NOT = replace(FITS, hysteresis=0.1)
GAIN, Y = 0, 1
"""Right-hand sides of a row: SH_RIGHT_GAIN, SH_RIGHT_Y."""


def ticks(estimator: Estimator, joint: Joint) -> Iterator[tuple[float, Any]]:
    """Yields the time and the state of the regression after each tick."""
    for t, z in zip(joint.t, joint.measurements(), strict=True):
        estimator.tick(z)
        yield float(t), estimator.state.method.regression


def line(label: str, color: str, x: Any, y: Any, **more: Any) -> Trace:
    return Trace(label, color, np.asarray(x), np.asarray(y), **more)


def interval(t: Array, found: Any, color: str) -> Trace:
    sigma, std = found["sigma"], found["sigma_std"]
    return line("estimate", color, t, sigma, band=(sigma - 1.96 * std, sigma + 1.96 * std))


def in_doubt(t: Array, found: Any) -> Trace:
    """The estimate where it is not confident."""
    sigma = np.where(found["confident"], np.nan, found["sigma"])
    return line("not confident", COLORS[2], t, sigma, width=2.4)


def outputs(c: Library) -> FigureRows:
    """What a user sees: a start, a confident estimate, and a spring that softens at 15 s."""
    found, t = Estimator(c, REGRESSION).run(CHANGES.measurements()), CHANGES.t
    paper = Estimator(c, {"method": 1}).run(CHANGES.measurements())
    stiffness = Panel(
        "",
        "time [s]",
        "stiffness [N.m/rad]",
        (
            interval(t, found, COLORS[0]),
            line("true", TRUE, t, CHANGES.sigma, dash=(3, 2)),
            in_doubt(t, found),
            line("Paper2011", COLORS[3], t, paper["sigma"], width=0.8),
        ),
        y_range=(0.0, 1.6 * float(np.max(CHANGES.sigma))),
    )
    return ((stiffness,),)


@dataclass(frozen=True)
class Rows:
    """Samples of a short time, and the rows that were made from them."""

    t: Array  # of the samples [s]
    torque: Array  # -gamma tau, and the same through the filter [N.m] [size: 2 x samples]
    end: Array  # time of the last sample of each row [s]
    row: Array  # -gamma tau_f, y and its prediction [N.m] [size: rows x 3]
    samples: int  # K


def rows(c: Library, first: float, last: float) -> Rows:
    estimator = Estimator(c, REGRESSION)
    gamma, torque_filter = estimator.parameters.motor.gamma, c.lib.SH_FILTER_TORQUE
    t, torque, end, made = [], [], [], []
    before, z, K = None, CHANGES.measurements(), 1
    for (now, state), sample in zip(ticks(estimator, CHANGES), z, strict=True):
        if now >= last:
            break
        size, filters, K = state.columns.size, state.signals.filters, state.signals.decimation
        y = state.row.x[size + Y]
        if now >= first:
            through = filters.input[torque_filter] - filters.behind[2][torque_filter]
            t.append(now)
            torque.append((-gamma * sample[3], -gamma * through))
            if y != before and before is not None:
                end.append(now)
                made.append((state.row.x[size + GAIN], y, y - state.row.epsilon))
        before = y
    return Rows(np.array(t), np.array(torque).T, np.array(end), np.array(made), int(K))


def a_row(c: Library) -> FigureRows:
    found = rows(c, 8.0, 8.08)
    edges = np.append(found.end[0] - found.samples * T, found.end)
    torque = Panel(
        "",
        "time [s]",
        "torque [N.m]",
        (
            line("samples of -gamma tau", TRUE, found.t, found.torque[0], kind=TraceKind.POINTS),
            line("behind the filter", COLORS[0], found.t, found.torque[1]),
            line("rows", COLORS[2], np.repeat(edges, 2)[1:-1], np.repeat(found.row[:, 0], 2)),
        ),
    )
    middle = (edges[1:] + edges[:-1]) / 2
    fit = Panel(
        "",
        "time [s]",
        "torque [N.m]",
        (
            line("y of the rows", COLORS[2], middle, found.row[:, 1], kind=TraceKind.POINTS),
            line("prediction x' beta", COLORS[0], middle, found.row[:, 2]),
        ),
    )
    return ((torque,), (fit,))


@dataclass(frozen=True)
class Blocks:
    """Quantities after each block."""

    t: Array  # [s]
    errors: (
        Array  # z of the hypotheses as before, another spring, other friction [size: 3 x blocks]
    )
    evidence: Array  # E [1]
    level: Array  # l [1]
    q: Array  # [1]
    kappa_squared: Array  # [1]


def blocks(c: Library, joint: Joint, values: dict[str, Any]) -> Blocks:
    found, count = [], 0.0
    for t, state in ticks(Estimator(c, values), joint):
        bank, misfit = state.bank, state.misfit
        if bank.count > count:
            errors = bank.error, bank.spring_error, bank.friction_error
            found.append(
                (t, *errors, bank.evidence, bank.level, misfit.square, misfit.variance_factor)
            )
        count = bank.count
    t, as_before, spring, friction, evidence, level, q, kappa = np.array(found).T
    return Blocks(t, np.array([as_before, spring, friction]), evidence, level, q, kappa)


def a_block(c: Library) -> FigureRows:
    """The window of a block, and the misfit of a joint with hysteresis and without."""
    length = 7
    x = (np.arange(length) + 0.5) / length
    fine = np.linspace(0, 1, 100)
    shape: Callable[[Array], Array] = lambda x: 16 * x**2 * (1 - x) ** 2  # noqa: E731
    window = Panel(
        "",
        "time in the block [ms]",
        "h [1]",
        (
            line("window", COLORS[0], 50 * fine, shape(fine)),
            line("its rows", COLORS[2], 50 * x, shape(x), kind=TraceKind.POINTS),
        ),
    )
    values = {**SETTINGS, **PLAIN}
    good, bad = blocks(c, FITS, values), blocks(c, DOES_NOT, values)
    errors = Panel(
        "",
        "time [s]",
        "z of a block [1]",
        (
            line("model holds", COLORS[0], good.t, good.errors[0], kind=TraceKind.POINTS),
            line("hysteresis", COLORS[2], bad.t, bad.errors[0], kind=TraceKind.POINTS),
        ),
        y_log=True,
        y_range=(1e-2, 1e3),
    )
    factors = Panel(
        "",
        "time [s]",
        "[1]",
        (
            line("q, model holds", COLORS[0], good.t, good.q),
            line("kappa^2", COLORS[0], good.t, good.kappa_squared, dash=(3, 2)),
            line("q, hysteresis", COLORS[2], bad.t, bad.q),
            line("kappa^2", COLORS[2], bad.t, bad.kappa_squared, dash=(3, 2)),
        ),
        y_log=True,
    )
    return ((window, errors), (factors,))


def a_change(c: Library) -> FigureRows:
    """The second around a change of the spring: the errors of the hypotheses, and the evidence."""
    first, last = AT - 0.5, AT + 1.5
    found, t = Estimator(c, REGRESSION).run(CHANGES.measurements()), CHANGES.t
    near = (t >= first) & (t < last)
    stiffness = Panel(
        "",
        "",
        "stiffness [N.m/rad]",
        (
            interval(t[near], found[near], COLORS[0]),
            line("true", TRUE, t[near], CHANGES.sigma[near], dash=(3, 2)),
            in_doubt(t[near], found[near]),
        ),
    )
    seen = blocks(c, CHANGES, REGRESSION)
    at = (seen.t >= first) & (seen.t < last)
    names = ("as before: z_0 / l", "another spring: z_1 / l", "other friction: z_2 / l")
    errors = Panel(
        "",
        "",
        "squared error [1]",
        [
            line(name, color, seen.t[at], np.maximum(z[at] / seen.level[at], 1e-2))
            for name, color, z in zip(
                names, (COLORS[2], COLORS[0], COLORS[1]), seen.errors, strict=True
            )
        ],
        y_log=True,
    )
    evidence = Panel(
        "",
        "time [s]",
        "E [1]",
        (
            line("evidence of a change", COLORS[2], seen.t[at], seen.evidence[at]),
            line("doubt, 20", TRUE, seen.t[at], np.full(np.sum(at), 20.0), dash=(1, 2)),
            line("change, 75 sqrt l", TRUE, seen.t[at], 75 * np.sqrt(seen.level[at]), dash=(3, 2)),
        ),
    )
    return ((stiffness,), (errors,), (evidence,))


FIGURES: dict[str, Callable[[Library], FigureRows]] = {
    "filtered-regression": outputs,
    "row": a_row,
    "block": a_block,
    "change": a_change,
}


def main(folder: Path) -> None:
    c = load(Path(os.environ.get("SIGMAHAT_BUILD", REPOSITORY / "build")))
    for name, draw in FIGURES.items():
        save(in_rows, draw(c), folder / name)
        (folder / f"{name}.svg").unlink()


if __name__ == "__main__":
    main(Path(sys.argv[1]))
