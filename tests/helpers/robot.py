"""Axes 1 to 3 of an industrial robot: identified, estimated and validated as a user does it.

    python tests/helpers/robot.py FIGURE.png

prints the table of docs/robot.md and draws its figure. The data are looked for in
../shared/data/kr300 next to the checkout, or in the folder that the environment variable
SIGMAHAT_KR300 names.
"""

import json
import sys
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
from matplotlib.figure import Figure

from command_line import in_process
from recorded_logs import read_estimate
from shared_data import data_folder

RUNS = ("a", "b")
AXES = {
    3: (252.333333333, 0.0118, 4.0999e6),
    2: (267.428571429, 0.0118, 7.5189e6),
    1: (256.857142857, 0.00923, 4.5778e6),
}
"""Gear ratio; inertia [kg.m2] and stiffness [N.m/rad] of the authors."""
SIGMA, STD = "estimate.sigma [N.m/rad]", "estimate.sigma_std [N.m/rad]"

DELAY = 0.0031
"""Delay of the link's encoder [s], as `check` proposes it for axis 3 in both runs."""

CONFIGURATION = """\
[time]
column = "time_s"
unit = "s"
[ports.theta]
column = "a{axis}_motor_deg"
unit = "deg"
[ports.q]
column = "a{axis}_link_deg"
unit = "deg"
delay = {delay}
[ports.tau]
column = "a{axis}_motor_torque_Nm"
unit = "N.m"
[parameters]
samplePeriod = 0.004
method = "FilteredRegression"
motor.gamma = {gear}
motor.B = {inertia}
prior.B = 0.05
motor.D_theta = 0.03
encoder.theta = 0
encoder.q = 0
rls.m = 1
"""


@dataclass(frozen=True)
class Estimated:
    table: pa.Table  # what `sigmahat estimate` wrote for each sample
    stiffness: float  # at the end [N.m/rad]
    std: float  # standard deviation of the stiffness [N.m/rad]
    confident: float  # share of the samples [1]


@dataclass(frozen=True)
class Axis:
    number: int
    estimated: Sequence[Estimated]
    """Results of run a alone, of run b alone, and of run b after run a."""
    validated: Sequence[dict[str, Any]]
    """Output of `sigmahat validate --json`: run b with the estimate of run a, and run a with the
    estimate of run b.
    """


def study(number: int, data: Path, place: Path) -> Axis:
    """Runs the commands for an axis, in an empty folder."""
    gear, inertia, _ = AXES[number]
    estimated = []
    for run in RUNS:
        text = CONFIGURATION.format(axis=number, gear=gear, inertia=inertia, delay=DELAY)
        (place / f"{run}.toml").write_text(text)
        given = f"{data}/kr300_{run}.csv --config {place}/{run}.toml"
        _sigmahat(f"identify {given} --quiet")
        estimated.append(_estimate(given, place / run))
    again = f"{data}/kr300_b.csv --config {place}/a.toml --start-from {place}/a"
    estimated.append(_estimate(again, place / "ab"))
    validated = []
    for run, other in (("a", "b"), ("b", "a")):
        learned = f"--with {place}/{run}.toml --start-from {place}/{run}"
        said = _sigmahat(f"validate {data}/kr300_{other}.csv {learned} --json")
        validated.append(json.loads(said))
    return Axis(number, estimated, validated)


def _estimate(given: str, out: Path) -> Estimated:
    _sigmahat(f"estimate {given} --out {out} --quiet")
    table = read_estimate(out)
    stiffness, std = (float(table[name][-1].as_py()) for name in (SIGMA, STD))
    confident = float(np.mean(table["estimate.confident"].to_numpy()))
    return Estimated(table, stiffness, std, confident)


def _sigmahat(command: str) -> str:
    done = in_process(*command.split())
    if done.returncode > 1:  # 1: the logs do not agree
        raise RuntimeError(f"{command} ended with {done.returncode}: {done.stderr}")
    return done.stdout


def draw(axes: Sequence[Axis]) -> Figure:
    """Stiffness over time, with its interval, and the authors' value."""
    figure = Figure(figsize=(9, 3.8), layout="constrained")
    for axis, panel in zip(axes, figure.subplots(1, len(axes)), strict=True):
        colours = ("#0072B2", "#D55E00")
        for run, each, colour in zip(RUNS, axis.estimated[:2], colours, strict=True):
            sigma, std = (each.table[name].to_numpy() / 1e6 for name in (SIGMA, STD))
            t = 0.004 * np.arange(len(sigma))
            panel.plot(t, sigma, color=colour, label=f"run {run}")
            low, high = sigma - 1.96 * std, sigma + 1.96 * std
            band = f"run {run}, 95 % interval"
            panel.fill_between(t, low, high, color=colour, alpha=0.2, linewidth=0, label=band)
        authors = AXES[axis.number][2] / 1e6
        panel.axhline(authors, color="black", linestyle="--", label="authors of the data")
        panel.set(title=f"axis {axis.number}", xlabel="time [s]", ylim=(-5, 15), xlim=(0, 10))
    figure.axes[0].set_ylabel(r"stiffness [$10^6$ N.m/rad]")
    handles, labels = figure.axes[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=5, fontsize="small")
    return figure


def table(axes: Sequence[Axis]) -> str:
    lines = [
        "| axis | run a | run b | a, then b | confident | torque of the other run below 2 Hz |",
        "|---|---|---|---|---|---|",
    ]
    for axis in axes:
        values = [
            f"{each.stiffness / 1e6:.2f} ± {1.96 * each.std / 1e6:.2f}" for each in axis.estimated
        ]
        confident = ", ".join(f"{100 * each.confident:.0f}" for each in axis.estimated)
        errors = ", ".join(
            f"{100 * each['torque_below_2_Hz']['relative']:.1f}" for each in axis.validated
        )
        lines.append(f"| {axis.number} | {' | '.join(values)} | {confident} % | {errors} % |")
    return "\n".join(lines)


def main(picture: Path) -> None:
    data, axes = data_folder("kr300", "kr300_a.csv"), []
    for number in AXES:
        with tempfile.TemporaryDirectory() as place:
            axes.append(study(number, data, Path(place)))
    print(table(axes))
    draw(axes).savefig(picture, dpi=120)


if __name__ == "__main__":
    main(Path(sys.argv[1]))
