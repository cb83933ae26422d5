"""Formats tables of the measured times."""

import platform
import re
from collections.abc import Iterator, Mapping
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

Times = Mapping[str, NDArray[np.float64]]
"""Time for one unit of work in each round [ns], by name of the benchmark subject. The time is NaN
in a round in which the subject did not run."""

FMPY = "simulate_fmu of FMPy"


def ratio(times: Times, one: str, other: str) -> float:
    """Computes the median of the ratio of two times, which are measured in the same rounds."""
    return float(np.nanmedian(times[one] / times[other]))


def _requirements(times: Times) -> Iterator[str]:
    """Yields rows of a table: quantity, required and measured value, and whether they agree."""

    def at_most(what: str, value: float, limit: float, unit: str) -> str:
        measured = f"{value:.{2 if abs(value) < 100 else 0}f} {unit}"
        met = "yes" if value <= limit else "no"
        return f"| {what} | <= {limit:g} {unit} | {measured} | {met} |"

    tick, one = "tick Paper2011", "Estimator.run"
    for what, subject, other, limit in (
        *(
            (f"least squares, {n} parameters, against Eigen", f"sigmahat {n}", f"eigen {n}", limit)
            for n, limit in ((3, 1.3), (6, 1.3), (18, 1.0), (40, 1.0))
        ),
        ("tick of Paper2011, against the covariance update alone", tick, "covariance 18", 1.5),
        (
            "tick of FilteredRegression with 21 columns, against Paper2011",
            "tick FilteredRegression, 21 columns",
            tick,
            5.0,
        ),
        ("Estimator.run, against the bare tick", one, tick, 1.1),
        ("Estimator.run of 30 joints, against one, per joint", f"{one}, 30 joints", one, 1.0),
        ("simulate, against simulate_fmu of FMPy", "simulate of sigmahat", FMPY, 1.0),
    ):
        yield at_most(what, ratio(times, subject, other), limit, "x")
    alone = float(np.nanmedian(times["FMU"] - times[tick]))
    yield at_most("FMU in the loop in C, time in addition to the tick", alone, 60, "ns")
    growth = np.log(ratio(times, "sigmahat 40", "sigmahat 18")) / np.log(40 / 18)
    yield at_most("exponent of the growth of time from 18 to 40 parameters", float(growth), 2, "")
    for name, size, limit, unit in (
        ("plant, held", 1e3, 3, "us"),
        ("plant, linear", 1e3, 3, "us"),
        ("table1 RESIDUAL", 1e9, 0.4, "s"),
    ):
        yield at_most(name, float(np.nanmedian(times[name])) / size, limit, unit)


def _duration(ns: float) -> str:
    for unit, size in (("s", 1e9), ("ms", 1e6), ("us", 1e3)):
        if ns >= size:
            return f"{ns / size:.3g} {unit}"
    return f"{ns:.3g} ns"


def table(times: Times) -> str:
    """Formats the tables of requirements and of all times as Markdown."""
    lines = [f"Measured on {_processor()}.", "", "| quantity | required | measured | met |"]
    lines += ["|---|---|---|---|", *_requirements(times)]

    header = "| one sample, tick, step or run | median | min | relative to the bare tick |"
    lines += ["", header, "|---" * 4 + "|"]
    for name, of_name in times.items():
        low, middle = float(np.nanmin(of_name)), float(np.nanmedian(of_name))
        relative = ratio(times, name, "tick Paper2011") if re.match("tick|.*FMU", name) else None
        against = "" if relative is None else f"{relative:.2f} x"
        lines.append(f"| {name} | {_duration(middle)} | {_duration(low)} | {against} |")

    return "\n".join([*lines, ""])


def _processor() -> str:
    path = Path("/proc/cpuinfo")
    text = path.read_text(encoding="utf-8") if path.exists() else ""
    found = re.search(r"model name\s*:\s*(.*)", text)
    return found[1] if found else platform.processor() or platform.machine()
