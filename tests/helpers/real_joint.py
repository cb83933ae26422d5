"""A real variable-stiffness joint, replayed through the estimator.

    python tests/helpers/real_joint.py FIGURE.png

prints the tables of docs/real-joint.md and draws its figure. The data are looked for in
../shared/data/desr next to the checkout, or in the folder that the environment variable
SIGMAHAT_DESR names.
"""

import math
import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pandas as pd
from matplotlib.figure import Figure
from numpy.typing import NDArray

from regression_joint import WITHOUT_MISFITS
from shared_data import data_folder
from sigmahat import Estimator
from sigmahat.fmi.model import Value

Array = NDArray[np.float64]

SETTINGS = (0, 10, 25, 33, 35, 45)  # position of the support [mm]
SAMPLE_PERIOD = 1.2e-3  # [s]
DYNAMOMETER = 218 * 180 / math.pi  # stiffness of the dynamometer [N.m/rad]
N, M = 6, 3
PARAMETERS: dict[str, Value] = {
    **{"samplePeriod": SAMPLE_PERIOD, "modality": "Sensor", "rls.n": N, "rls.m": M},
    **{"encoder.theta": 0.0, "encoder.q": 0.0, "encoder.theta_c": 0.0},
    **{"setPoint.offset": 0.0, "setPoint.scale": 1.0, "rls.P_0": 1e32},
}
PAPER2011: dict[str, Value] = {}
FILTERED_REGRESSION: dict[str, Value] = {
    "method": "FilteredRegression",
    "range.phi": 0.25,
    "range.setPoint": 45.0,
    "prior.tau_e": 1000.0,
    "noise.tau_e": 0.25,
    "prior.torque_gain": 0.0,
    # The joint turns by 0.4 rad only, where an encoder that is not centred looks like the spring.
    "prior.eccentric": 0.0,
    # The six logs take 86 s.
    "regression.memory": 100.0,
}
SPRING_ALONE = {**FILTERED_REGRESSION, **WITHOUT_MISFITS, "regression.memory": 0.0}
"""FilteredRegression without the columns for misfits, and without their effect."""
BIN = 5e-3  # width over which the measured curve is averaged [rad]
POINTS = (-0.1, 0.1)  # where the stiffness is compared [rad]
HALF_WIDTH = 0.05  # half width of the window for the slope [rad]


@dataclass(frozen=True)
class Log:
    """One setting of the joint; arrays of one size, a sample each."""

    setting: int  # position of the support [mm]
    q: Array  # angle of the dynamometer [rad]
    torque: Array  # of the transmission [N.m]

    @property
    def theta(self) -> Array:
        """Deformation of the dynamometer itself [rad]."""
        return self.torque / DYNAMOMETER

    @property
    def phi(self) -> Array:
        """Deformation of the transmission [rad]."""
        return self.q - self.theta

    def rms(self, fit: Estimator) -> float:
        """RMS error of the fitted torque in percent of the torque range."""
        error = fit.evaluate(self.phi, self.setting)["tau_e"] - self.torque
        return float(100 * np.sqrt(np.mean(error**2)) / np.ptp(self.torque))

    def hysteresis(self) -> float:
        """RMS of the torque around its mean at each deformation, in percent of its range.

        This RMS is a lower limit for the error of any function of the deformation.
        """
        torque = pd.Series(self.torque)
        error = torque - torque.groupby(np.floor(self.phi / BIN)).transform("mean")
        return float(100 * np.sqrt(np.mean(error**2)) / np.ptp(self.torque))

    def mean_curve(self) -> tuple[Array, Array]:
        """Deformation [rad] and torque [N.m], the mean of loading and unloading.

        Each branch is averaged in bins of deformation; bins that only one branch reaches are left
        out. The angle in a log goes to its minimum, to its maximum, and back.
        """
        rising = np.zeros(len(self.q), dtype=bool)
        rising[np.argmin(self.q) : np.argmax(self.q)] = True
        of_branches = pd.Series(self.torque).groupby([np.floor(self.phi / BIN), rising]).mean()
        mean = of_branches.unstack().dropna().mean(axis=1)
        return (mean.index.to_numpy() + 0.5) * BIN, mean.to_numpy()


def slope(x: Array, y: Array, at: float, half_width: float) -> float:
    """Slope of the straight line through the points of y(x) within half_width of x = at."""
    near = np.abs(x - at) < half_width
    return float(np.polyfit(x[near], y[near], 1)[0])


def logs(path: Path) -> list[Log]:
    """The six logs, by setting."""
    found = []
    for setting in SETTINGS:
        table = np.loadtxt(path / f"desr_x{setting:02d}.csv", delimiter=",", skiprows=1)
        found.append(Log(setting, table[:, 1], table[:, 2]))
    return found


def inputs(played: Sequence[Log]) -> dict[str, Array]:
    """Logs, one after another, as the estimator takes them."""
    return {
        "theta": np.concatenate([log.theta for log in played]),
        "q": np.concatenate([log.q for log in played]),
        "theta_c": np.concatenate([np.full(len(log.q), float(log.setting)) for log in played]),
        "tau_e_sensor": np.concatenate([log.torque for log in played]),
    }


def replay(
    played: Sequence[Log], symmetric: bool, method: Mapping[str, Value] = PAPER2011
) -> Estimator:
    """An estimator after logs, one after another."""
    estimator = Estimator({**PARAMETERS, **method, "rls.symmetric": symmetric})
    estimator.run(**inputs(played))
    return estimator


def coverage(measured: Sequence[Log], fit: Estimator) -> float:
    """Share of points, every 0.01 rad, with the slope of the mean curve (over +-0.02 rad) within
    1.96 sigma_std of the estimate, in a second replay of the logs [%]."""
    found = fit.run(**inputs(measured))
    inside, first = [], 0
    for log in measured:
        part = {name: c[first : first + len(log.q)] for name, c in found.values.items()}
        first += len(log.q)
        x, y = log.mean_curve()
        for phi in np.arange(x[0] + 0.02, x[-1] - 0.02, 0.01):
            at = np.argmin(np.abs(part["phi"] - phi))
            error = part["sigma"][at] - slope(x, y, phi, 0.02)
            inside.append(abs(error) <= 1.96 * part["sigma_std"][at])
    return 100 * float(np.mean(inside))


def leave_one_out(measured: Sequence[Log]) -> dict[int, float]:
    """RMS [%] of the torque at each inner setting, with a fit to the other five settings."""
    return {
        log.setting: log.rms(replay([each for each in measured if each is not log], False))
        for log in measured[1:-1]
    }


def worst(measured: Sequence[Log], fit: Estimator, half_width: float, line: bool = False) -> float:
    """Largest error [%] of the stiffness at +-0.1 rad against the slope of the measured curve.

    line  compares the slope of a line through the fitted torque over the same window instead
    """
    errors = []
    for log in measured:
        x, y = log.mean_curve()
        for phi in POINTS:
            sigma = float(fit.evaluate(phi, log.setting)["sigma"])
            if line:
                sigma = slope(x, fit.evaluate(x, log.setting)["tau_e"], phi, half_width)
            errors.append(abs(100 * (sigma / slope(x, y, phi, half_width) - 1)))
    return max(errors)


def torque_table(
    measured: Sequence[Log], general: Estimator, odd: Estimator, left_out: Mapping[int, float]
) -> str:
    """RMS of the torque, as a table in Markdown."""
    rows = ["| setting [mm] | range [N.m] | general basis | left out | odd basis | hysteresis |"]
    rows.append("|---|---|---|---|---|---|")
    for log in measured:
        left = f"{left_out[log.setting]:.2f}" if log.setting in left_out else ""
        errors = [f"{log.rms(general):.2f}", left, f"{log.rms(odd):.2f}", f"{log.hysteresis():.2f}"]
        rows.append(f"| {log.setting} | {np.ptp(log.torque):.0f} | {' | '.join(errors)} |")
    return "\n".join(["torque, RMS in % of its range:", *rows, ""])


def stiffness_table(measured: Sequence[Log], general: Estimator, odd: Estimator) -> str:
    """Stiffness at +-0.1 rad as a table in Markdown, and its error for several windows."""
    rows = ["| setting [mm] | phi [rad] | measured | general basis | odd basis |"]
    rows.append("|---|---|---|---|---|")
    for log in measured:
        for phi in POINTS:
            truth = slope(*log.mean_curve(), phi, HALF_WIDTH)
            cells = [
                f"{sigma:.0f} ({100 * (sigma / truth - 1):+.1f} %)"
                for sigma in (fit.evaluate(phi, log.setting)["sigma"] for fit in (general, odd))
            ]
            rows.append(f"| {log.setting} | {phi:+.1f} | {truth:.0f} | {' | '.join(cells)} |")
    for width in (0.02, 0.04, HALF_WIDTH, 0.055, 0.06, 0.065, 0.07):
        errors = [worst(measured, general, width, line) for line in (False, True)]
        rows.append(f"largest error within {width:g} rad: {errors[0]:.1f} %, {errors[1]:.1f} %")
    return "\n".join(["stiffness in N.m/rad:", *rows])


def draw(measured: Sequence[Log], general: Estimator, odd: Estimator) -> Figure:
    """Draws measured and fitted torque against deformation, one panel for each setting."""
    figure = Figure(figsize=(9.0, 6.0), layout="constrained")
    panels = figure.subplots(2, 3, sharex=True)
    for axes in panels[1]:
        axes.set_xlabel(r"deformation $\phi$ [rad]")
    for axes in panels[:, 0]:
        axes.set_ylabel(r"torque $\tau_e$ [N$\cdot$m]")
    for log, axes in zip(measured, panels.flat, strict=True):
        x = np.linspace(log.phi.min(), log.phi.max(), 200)
        axes.plot(log.phi[::10], log.torque[::10], color="#aaaaaa", linewidth=1.2, label="measured")
        for fit, color, line, name in (
            (odd, "#D55E00", "--", "odd basis, RMS"),
            (general, "#0072B2", "-", "general basis, RMS"),
        ):
            label = f"{name}: {log.rms(fit):.1f} %"
            axes.plot(
                x, fit.evaluate(x, log.setting)["tau_e"], color=color, linestyle=line, label=label
            )
        axes.set_title(f"support at {log.setting} mm", fontsize=10)
        axes.grid(color="#dddddd", linewidth=0.6)
        axes.legend(fontsize=7.5, loc="upper left")
        axes.margins(y=0.15)
    return figure


def main(figure: str) -> None:
    """Prints the tables and draws the figure."""
    measured = logs(data_folder("desr", "desr_x00.csv"))
    general, odd = (replay(measured, symmetric) for symmetric in (False, True))
    print(torque_table(measured, general, odd, leave_one_out(measured)))
    print(stiffness_table(measured, general, odd))
    draw(measured, general, odd).savefig(figure, dpi=100)


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    main(sys.argv[1])
