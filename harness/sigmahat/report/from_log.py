"""Creates a report from the files of `sigmahat estimate`."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from datetime import datetime
from pathlib import Path
from typing import Any

import numpy as np
from pydantic import ValidationError

from sigmahat.checks.findings import findings_of
from sigmahat.checks.text import sentence
from sigmahat.report.contents import REPORT, Contents, Link, TextTable, number, of_file
from sigmahat.report.residuals import residual_panels, residuals
from sigmahat.result.curve import (
    CURVE,
    Curve,
    polynomial_in_words,
    reach_in_words,
    read_curve,
    stiffness_table,
)
from sigmahat.result.curve_of_log import POINTS, MeasuredPoints, read_points
from sigmahat.result.estimate import continued_in_words, read_joints
from sigmahat.result.estimate_table import REPLAYED, EstimateTable, Replayed
from sigmahat.result.headline import Confidence, headline
from sigmahat.result.log_panels import (
    curve_panels,
    quantity_panels,
    reduce,
    sampling,
    stiffness_panels,
)
from sigmahat.result.sheet import FORMAT, WORDS, Sheet
from sigmahat.result.stored import wrong_values
from sigmahat.show.style import plain_text, plain_title, plain_unit

_OF_THE_METHOD = ("a", "rho")  # inner outputs of the method, which are not in the table


def from_log(folder: Path) -> Contents:
    """The curve, other results, and the signals of the estimator over time.

    Raises ValueError, which says what to do, for a file that is missing, damaged or wrong.
    """
    signals = EstimateTable(folder)
    t, used = signals.t, signals.used
    sheet, log, curve, points = _beside_the_table(folder)
    regression = sheet.method == "FilteredRegression"
    bandwidth = float(sheet.start_values["regression.bandwidth"])
    of_model = residuals(t, signals, used, bandwidth) if regression else None
    reduced = reduce(t, signals)
    if not regression:
        del reduced.signals["sigma_std"]  # the method gives no interval
    tables = [
        *([curve_table(curve)] if curve.branches else []),
        found_table(sheet),
        *([] if log.findings is None else [_findings_table(folder, log.findings)]),
        _estimates(signals),
        _doubts(log.doubt),
        estimator_table(sheet),
    ]
    return Contents(
        f"Joint {log.joint}" if log.joint else f"Log: {folder.resolve().name}",
        [
            _origin(sheet, log, folder),
            # A gap in the log has ticks, but no rows.
            f"{len(used)} rows over {t[-1] - t[0]:.6g} s; "
            f"{log.skipped} of {log.ticks} ticks skipped, a tick every {log.T:g} s",
            *(["Dotted lines mark changes of the stiffness, see Samples."] if log.changes else []),
        ],
        tables,
        [
            *stiffness_panels(reduced, {"estimate": {"sigma": "sigma"}}),
            *quantity_panels(reduced, ""),
            *(residual_panels(of_model) if of_model else []),
        ],
        headline=_headline(sheet, log, curve),
        answer=list(curve_panels(curve, points)),
        notes=[
            *continued_in_words([each.file for each in sheet.logs[:-1]]),
            *(note.in_words for note in log.notes),
            *(change.in_words for change in log.changes),
            *sampling(reduced),
        ],
        marks=[change.t for change in log.changes],
        whole=reduced.whole,
    )


def from_joints(folder: Path) -> Contents:
    """The table of several joints, a line for each joint, and the curve of each joint.

    Each line is a link to the report of the joint, REPORT in its folder.

    Raises ValueError, which says what to do, for a file that is missing or damaged.
    """
    names, table = read_joints(folder)
    panels, lines, links = [], list[str](), []
    for name in names:
        sheet, log, curve, points = _beside_the_table(folder / name)
        lines = lines or [_origin(sheet, log, folder / name)]  # the same log for all joints
        links.append(Link(f"{name}: {_headline(sheet, log, curve)}", folder / name / REPORT))
        _, *of_curve = curve_panels(curve, points)
        panels += [replace(each, title=f"{name}: {each.title}") for each in of_curve]
    stiffness = of_file("Stiffness", table)
    return Contents(f"Joints: {folder.resolve().name}", lines, [stiffness], panels, links=links)


def _headline(sheet: Sheet, log: Replayed, curve: Curve) -> str:
    return headline(curve, Confidence(sheet.doubt, log.doubt), log.changes)


def _beside_the_table(folder: Path) -> tuple[Sheet, Replayed, Curve, MeasuredPoints]:
    sheet = FORMAT.read(folder)
    curve = read_curve(folder / CURVE, sheet.polynomial)
    return sheet, REPLAYED.read(folder), curve, read_points(folder / POINTS)


def _origin(sheet: Sheet, log: Replayed, folder: Path) -> str:
    """A line with the log, the configuration, the version and the time of the results."""
    made = datetime.fromtimestamp((folder / REPLAYED.file).stat().st_mtime).astimezone()
    source = f"{log.log} with {sheet.configuration.file}"
    return f"{source}; sigmahat {sheet.sigmahat}, {made:%Y-%m-%d %H:%M %Z}"


def _findings_table(folder: Path, values: Sequence[Mapping[str, Any]]) -> TextTable:
    path = REPLAYED.path(folder)
    try:
        findings = findings_of(values)
    except ValidationError as error:
        raise wrong_values(path, error, ["findings"]) from error
    try:
        rows = [[finding.severity.value, sentence(finding)] for finding in findings]
    except (KeyError, TypeError) as error:  # the sentence needs values that the finding lacks
        raise ValueError(
            f"{path}: damaged: expected findings with the values of their kinds, got others; "
            "run `sigmahat estimate` again"
        ) from error
    note = "" if rows else "The check found no error in the configuration."
    return TextTable("Checks", ["", "finding"], rows, (0, 1), note=note)


def _estimates(signals: EstimateTable) -> TextTable:
    """Lists each output at the end, with range and RMS in the second half of the log."""
    late = signals.used.copy()
    late[: len(late) // 2] = False
    rows = []
    for name in signals:
        if name not in _OF_THE_METHOD:
            values = signals[name]
            own = values[late]
            range_and_rms = [own.min(), own.max(), np.sqrt(np.mean(own**2))] if len(own) else []
            cells = [values[-1], *(range_and_rms or [np.nan] * 3)]
            title = plain_title(name, signals.units[name])
            rows.append([title, *(number(float(cell)) for cell in cells)])
    head, note = ["", "at the end", "least *", "greatest *", "RMS *"], "* in the second half"
    return TextTable("Outputs of the estimator", head, rows, note=note, folded=True)


def _doubts(doubts: Mapping[str, float]) -> TextTable:
    """Lists how often the estimator was confident in the second half, and reasons for doubt."""
    shares = [[item, f"{100 * share:.3g}"] for item, share in doubts.items()]
    head = ["why not confident", "fraction of the ticks [%] *"]
    note = "* in the second half; None: it was confident"
    return TextTable("Doubt", head, shares, note=note)


_FROM = {"prior": "the configuration (prior)", "identify": "identify", "exact": "taken as exact"}


def curve_table(curve: Curve) -> TextTable:
    head, *rows = stiffness_table(curve)
    words = plain_text(polynomial_in_words(curve.polynomial))
    reach = plain_text(reach_in_words(curve))
    note = f"The curve is valid {reach}; outside (pale in the plots), it is extrapolated. {words}."
    if not curve.claims:
        note += " The method gives no interval."
    titles = [plain_text(cell) for cell in head]
    return TextTable("Stiffness", titles, rows, words=(), note=note)


def found_table(sheet: Sheet) -> TextTable:
    rows = []
    for name, each in sheet.parameters.items():
        interval = "-" if each.interval is None else " to ".join(map(number, each.interval))
        unit = "" if each.unit == "1" else plain_unit(each.unit)
        source = _FROM.get(each.interval_from, each.interval_from)
        rows.append([WORDS[name], name, number(each.value), unit, interval, source])
    head = ["", "name", "value", "unit", "95 % interval", "interval from"]
    return TextTable("Joint and motor", head, rows, words=(0, 1, 3, 5))


def estimator_table(sheet: Sheet) -> TextTable:
    """Lists all parameters of the estimator except the coefficients of the curve; collapsed."""
    rows = [
        [name, str(value).lower() if isinstance(value, bool) else number(value)]
        for name, value in sheet.start_values.items()
        if not name.startswith("rls.eta_0")
    ]
    note = "motor.B and motor.D_theta are the estimated values"
    title = "Parameters of the estimator"
    return TextTable(title, ["parameter", "value"], rows, note=note, folded=True)
