"""Tables and a figure of the measured times."""

from __future__ import annotations

import platform
import re
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

Times = Mapping[str, NDArray[np.float64]]
"""By name of the subject: time for one piece of work in each round [ns]. NaN in a round in which
the subject did not run."""

SIZES = (3, 6, 18, 40)
MAKES = ("sigmahat", "eigen", "dlib", "liquid", "numpy", "padasip", "covariance")
NATIVE = ("sigmahat native", "eigen native")
LABELS = {
    "eigen": "Eigen",
    "sigmahat native": "sigmahat, `-march=native`",
    "eigen native": "Eigen, `-march=native`",
    "liquid": "liquid-dsp",
    "covariance": "covariance alone, plain loops",
}
_PAIR, _MANY, _FMPY = "pair, master in C", "Estimator.run, 30 joints", "simulate_fmu of FMPy"


@dataclass(frozen=True)
class Footprint:
    """Memory and number of instructions of a tick."""

    instructions: float | None
    """None if valgrind is not installed."""
    stack: int
    """[bytes]"""
    code: int
    """Of the whole library [bytes]."""
    memory: list[int]
    """State, parameters, estimate [bytes]."""


def update_flops(n: int) -> int:
    """Multiplications and additions of a UD update: 6 per entry of U, 16 per parameter."""
    return 6 * n * (n - 1) // 2 + 16 * n


def ratio(times: Times, one: str, other: str) -> float:
    """Median over the rounds of the ratio of two times of the same round."""
    return float(np.nanmedian(times[one] / times[other]))


def difference(times: Times, one: str, other: str) -> float:
    """Median over the rounds of the difference of two times of the same round [ns]."""
    return float(np.nanmedian(times[one] - times[other]))


def _requirements(
    times: Times, footprints: Mapping[str, Footprint]
) -> list[tuple[str, str, str, bool]]:
    """Rows of the table: quantity, required value, measured value, whether it is met."""
    rows: list[tuple[str, str, str, bool]] = []

    def at_most(what: str, value: float, limit: float, unit: str) -> None:
        digits = 2 if abs(value) < 100 else 0
        rows.append((what, f"<= {limit:g} {unit}", f"{value:.{digits}f} {unit}", value <= limit))

    tick = "tick Paper2011"
    own = "sigmahat 18"
    at_most("least squares, 18 parameters, against dlib", ratio(times, own, "dlib 18"), 0.5, "x")
    at_most("least squares, 18 parameters, against Eigen", ratio(times, own, "eigen 18"), 1.0, "x")
    at_most(
        "tick of Paper2011, relative to the covariance update alone",
        ratio(times, tick, "covariance 18"),
        1.5,
        "x",
    )
    alone = "tick FilteredRegression, 21 columns"
    at_most(
        "tick of FilteredRegression with 21 columns, relative to Paper2011",
        ratio(times, alone, tick),
        5.0,
        "x",
    )
    at_most(
        "FMU through the C interface, time in addition to the tick",
        difference(times, "FMU, C", tick),
        60,
        "ns",
    )
    python = ratio(times, "PythonFMU, C", "FMU, C")
    rows.append(
        (
            "FMU, how much faster than that of PythonFMU, both through the C interface",
            ">= 50 x",
            f"{python:.0f} x",
            python >= 50,
        )
    )
    growth = np.log(ratio(times, "sigmahat 40", own)) / np.log(40 / 18)
    at_most("exponent of the growth of time from 18 to 40 parameters", float(growth), 2.0, "")
    for name in ("held", "linear"):
        median = float(np.nanmedian(times[f"plant, {name}"])) / 1e3
        at_most(f"AwAS plant, step of 1 ms, inputs {name}", median, 3, "us")
    for what, one, other, limit in (
        ("plant and estimator, loop in C, against the master in C", "pair, loop in C", _PAIR, 1.2),
        ("Estimator.run, against the bare tick", "Estimator.run", tick, 1.1),
        ("Estimator.run of 30 joints, against one, per joint", _MANY, "Estimator.run", 1.0),
        ("simulate, against simulate_fmu of FMPy", "simulate of sigmahat", _FMPY, 1.0),
    ):
        at_most(what, ratio(times, one, other), limit, "x")
    for name in [n for n in times if n.startswith("table1")]:
        at_most(f"run of {name}", float(np.nanmedian(times[name])) / 1e9, 0.4, "s")
    for method, each in footprints.items():
        at_most(f"stack of a tick, {method}", each.stack, 5120, "bytes")
    return rows


def _duration(ns: float) -> str:
    for unit, size in (("s", 1e9), ("ms", 1e6), ("us", 1e3)):
        if ns >= size:
            return f"{ns / size:.3g} {unit}"
    return f"{ns:.3g} ns"


def table(times: Times, footprints: Mapping[str, Footprint]) -> str:
    """All tables as Markdown."""
    lines = [f"Measured on {_processor()}.", "", "| quantity | required | measured | met |"]
    lines += ["|---|---|---|---|"]
    for what, required, measured, met in _requirements(times, footprints):
        lines.append(f"| {what} | {required} | {measured} | {'yes' if met else 'no'} |")

    lines += ["", "Least squares, one sample, median (min) [ns]:", ""]
    lines += ["| | " + " | ".join(f"{n} parameters" for n in SIZES) + " |", "|---" * 5 + "|"]
    for make in (*MAKES, *NATIVE):
        cells = (f"{_short(times, f'{make} {n}')}" for n in SIZES)
        lines.append(f"| {LABELS.get(make, make)} | " + " | ".join(cells) + " |")
    flop = float(np.nanmin(times["peak"]))
    limit = (f"{update_flops(n) * flop:.1f}" for n in SIZES)
    lines.append("| limit of the machine | " + " | ".join(limit) + " |")
    both_native = ratio(times, "sigmahat native 18", "eigen native 18")
    lines += [
        "",
        "Least squares, 18 parameters, against Eigen, both compiled with `-march=native`: "
        f"{both_native:.2f} x.",
    ]

    lines += [
        "",
        "| one tick, step or run | median | min | relative to the bare tick |",
        "|---" * 4 + "|",
    ]
    for name, of_name in times.items():
        if not re.match(r"tick|.*FMU|plant|pair|Estimator|simulate|table1", name):
            continue
        low, middle = float(np.nanmin(of_name)), float(np.nanmedian(of_name))
        relative = ratio(times, name, "tick Paper2011") if re.match("tick|.*FMU", name) else None
        against = "" if relative is None else f"{relative:.2f} x"
        lines.append(f"| {name} | {_duration(middle)} | {_duration(low)} | {against} |")

    lines += [
        "",
        "| method | instructions per tick | stack [bytes] | state + parameters + estimate "
        "[bytes] | code of the library [bytes] |",
        "|---" * 5 + "|",
    ]
    for method, each in footprints.items():
        counted = (
            "valgrind is not installed" if each.instructions is None else f"{each.instructions:.0f}"
        )
        memory = " + ".join(map(str, each.memory))
        lines.append(f"| {method} | {counted} | {each.stack} | {memory} | {each.code} |")
    return "\n".join([*lines, ""])


def _short(times: Times, name: str) -> str:
    values = times[name]
    digits = 1 if np.nanmedian(values) < 1000 else 0
    return f"{np.nanmedian(values):.{digits}f} ({np.nanmin(values):.{digits}f})"


def _processor() -> str:
    found = re.search(r"model name\s*:\s*(.*)", _read(Path("/proc/cpuinfo")))
    return f"{found[1] if found else platform.processor() or platform.machine()}"


def _read(path: Path) -> str:
    return path.read_text(encoding="utf-8") if path.exists() else ""


def figure(times: Times) -> Figure:
    """Time over the number of parameters, and times of ticks and steps with and without an FMU."""
    drawing = Figure(figsize=(10, 4.8), layout="constrained")
    growth, bars = drawing.subplots(1, 2)
    for make in MAKES:
        medians = [np.nanmedian(times[f"{make} {n}"]) for n in SIZES]
        style: Any = {"sigmahat": {"linewidth": 2.5}, "covariance": {"linestyle": ":"}}.get(
            make, {}
        )
        growth.loglog(SIZES, medians, marker="o", label=LABELS.get(make, make), **style)
    flop = float(np.nanmin(times["peak"]))
    limits = [update_flops(n) * flop for n in SIZES]
    growth.loglog(SIZES, limits, "--", color="gray", label="limit of the machine")
    growth.set_xticks(SIZES, [str(n) for n in SIZES])
    growth.minorticks_off()
    growth.set_xlabel("parameters")
    growth.set_ylabel("time of one sample [ns]")
    growth.set_title("Least squares")
    growth.grid(True, color="#dddddd", linewidth=0.6)
    growth.legend(fontsize=8, loc="upper center", bbox_to_anchor=(0.5, -0.14), ncols=3)

    names = [n for n in times if re.match(r"tick|.*FMU|plant", n)][::-1]
    lengths = [float(np.nanmedian(times[n])) for n in names]
    drawn = bars.barh(names, lengths, color="#0072B2")
    bars.bar_label(drawn, [_duration(m) for m in lengths], padding=3, fontsize=8)
    bars.set_xscale("log")
    bars.set_xlim(100, 10 * max(lengths))
    bars.set_xlabel("time of one tick or step [ns]")
    bars.set_title("Estimator and plant")
    return drawing


def update(path: Path, mark: str, text: str) -> None:
    """Replaces the text of a page between <!-- mark --> and <!-- /mark -->.

    Raises ValueError if the page has no such marks.
    """
    first, last = f"<!-- {mark} -->", f"<!-- /{mark} -->"
    before, begin, rest = path.read_text(encoding="utf-8").partition(first)
    _, end, after = rest.partition(last)
    if not begin or not end:
        raise ValueError(f"{path}: expected {first} and {last}")
    path.write_text(f"{before}{first}\n\n{text}\n{last}{after}", encoding="utf-8")
