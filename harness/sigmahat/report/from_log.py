"""The contents of a report from what `sigmahat estimate` wrote."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sigmahat.joint import sheet
from sigmahat.joint.curve import Curve
from sigmahat.joint.curve_file import CURVE, read_curve
from sigmahat.logs.measured import MeasuredPoints
from sigmahat.logs.notes_file import REPLAYED, Replayed
from sigmahat.logs.output import EstimatedSignal, read_estimate
from sigmahat.logs.points_file import POINTS, read_points
from sigmahat.plotting.symbols import plain_title
from sigmahat.report.contents import Contents, TextTable, number
from sigmahat.report.curve_panels import curve_panels, curve_table
from sigmahat.report.findings import findings_table
from sigmahat.report.parameter_tables import estimator_table, found_table
from sigmahat.report.reduction import reduce
from sigmahat.report.time_panels import Estimate, quantity_panels, sampling, stiffness_panels

_OF_THE_METHOD = ("a", "rho")
"""Outputs about the inner working of the method; they are not in the table."""


@dataclass(frozen=True)
class _Answer:
    """What stands in the files beside the table."""

    sheet: sheet.Sheet
    replayed: Replayed
    curve: Curve
    points: MeasuredPoints


def from_log(folder: Path) -> Contents:
    """The curve, what was found, and the signals of the estimator over time.

    A folder that an older version wrote has only the signals. Raises ValueError, which says what to
    do, for a file that is damaged or of something else.
    """
    signals = read_estimate(folder)
    used = signals.pop("valid").values.astype(bool)
    doubt = signals.pop("doubt", None)
    t = signals.pop("t").values
    answer = _answer(folder)
    reduced = reduce(t, {name: signal.values for name, signal in signals.items()})
    tables = [] if answer is None else _found(answer)
    tables += findings_table(folder)
    tables += [_estimates(signals, used), *([] if doubt is None else [_doubts(doubt)])]
    return Contents(
        f"Log: {folder.resolve().name}",
        [f"{len(used)} rows over {t[-1] - t[0]:.6g} s; {_skipped(answer, used)}"],
        [*tables, *([] if answer is None else [estimator_table(answer.sheet)])],
        [
            *stiffness_panels(reduced, [Estimate("estimate", {"sigma": "sigma"})]),
            *quantity_panels(reduced, ""),
        ],
        answer=[] if answer is None else list(curve_panels(answer.curve, answer.points)),
        notes=[*([] if answer is None else answer.replayed.notes), *sampling(reduced)],
        every=reduced.every if reduced.bucket > 1 else None,
    )


def _answer(folder: Path) -> _Answer | None:
    if not (folder / REPLAYED.file).is_file():
        return None
    found = sheet.FORMAT.read(folder)
    return _Answer(
        found,
        REPLAYED.read(folder),
        read_curve(folder / CURVE, found.polynomial),
        read_points(folder / POINTS),
    )


def _skipped(answer: _Answer | None, used: NDArray[np.bool_]) -> str:
    """As `estimate` counts: ticks. A gap in the log has ticks, but no rows."""
    if answer is None:
        return f"in {np.count_nonzero(~used)} of them the estimator skipped the tick"
    replayed = answer.replayed
    return f"{replayed.skipped} of {replayed.ticks} ticks of {replayed.T:g} s skipped"


def _found(answer: _Answer) -> list[TextTable]:
    curve = [curve_table(answer.curve)] if answer.curve.branches else []
    return [*curve, found_table(answer.sheet)]


def _estimates(signals: Mapping[str, EstimatedSignal], used: NDArray[np.bool_]) -> TextTable:
    """Each output at the end, and its range and RMS where the estimator ran in the second half."""
    late = used & (np.arange(len(used)) >= len(used) // 2)
    rows = []
    for name, signal in signals.items():
        if name not in _OF_THE_METHOD:
            cells = [signal.values[-1], *_range_and_rms(signal.values[late])]
            rows.append([plain_title(name, signal.unit), *(number(float(cell)) for cell in cells)])
    return TextTable(
        "Outputs of the estimator",
        ["", "at the end", "least *", "greatest *", "RMS *"],
        rows,
        [True, False, False, False, False],
        note="* in the second half",
        folded=True,
    )


def _doubts(doubt: EstimatedSignal) -> TextTable:
    """How often the estimator was confident, and why not, in the second half."""
    late = doubt.values[len(doubt.values) // 2 :]
    rows = [[item, f"{100 * count / len(late):.3g}"] for item, count in Counter(late).most_common()]
    return TextTable(
        "Doubt",
        ["why not confident", "share of rows [%] *"],
        rows,
        [True, False],
        note="* in the second half; None: it was confident",
    )


def _range_and_rms(values: NDArray[Any]) -> list[float]:
    if not len(values):
        return [np.nan] * 3
    return [values.min(), values.max(), float(np.sqrt(np.mean(values**2)))]
