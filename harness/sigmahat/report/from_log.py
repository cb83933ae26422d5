"""The contents of a report from what `sigmahat estimate` wrote."""

from __future__ import annotations

from collections import Counter
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sigmahat.files.columns import title
from sigmahat.logs.output import EstimatedSignal, read_estimate
from sigmahat.report.contents import Contents, TextTable, number
from sigmahat.report.reduction import reduce
from sigmahat.report.time_panels import Estimate, quantity_panels, sampling, stiffness_panels

_OF_THE_METHOD = ("a", "rho")
"""Outputs about the inner working of the method; they are not in the table."""


def from_log(folder: Path) -> Contents:
    """Stiffness and all other signals of the estimator.

    Raises ValueError, which says what to do, for a file that is damaged or of something else.
    """
    signals = read_estimate(folder)
    used = signals.pop("valid").values.astype(bool)
    doubt = signals.pop("doubt", None)
    t = signals.pop("t").values
    reduced = reduce(t, {name: signal.values for name, signal in signals.items()})
    return Contents(
        f"Log: {folder.resolve().name}",
        [
            f"{len(used)} rows over {t[-1] - t[0]:.6g} s; in {np.count_nonzero(~used)} of them "
            "the estimator skipped the tick",
            *sampling(reduced),
        ],
        [_estimates(signals, used), *([] if doubt is None else [_doubts(doubt)])],
        [
            *stiffness_panels(reduced, [Estimate("estimate", {"sigma": "sigma"})]),
            *quantity_panels(reduced, ""),
        ],
        reduced.every if reduced.bucket > 1 else None,
    )


def _estimates(signals: dict[str, EstimatedSignal], used: NDArray[np.bool_]) -> TextTable:
    """Each output at the end, and its range and RMS where the estimator ran in the second half."""
    late = used & (np.arange(len(used)) >= len(used) // 2)
    rows = []
    for name, signal in signals.items():
        if name not in _OF_THE_METHOD:
            cells = [signal.values[-1], *_range_and_rms(signal.values[late])]
            rows.append([title(name, signal.unit), *(number(float(cell)) for cell in cells)])
    return TextTable(
        "Estimates",
        ["", "at the end", "least *", "greatest *", "RMS *"],
        rows,
        [True, False, False, False, False],
        note="* in the second half",
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
