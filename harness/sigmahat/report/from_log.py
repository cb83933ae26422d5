"""The files of `sigmahat estimate` with the findings of the checks, and a report from the files."""

from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from datetime import datetime
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sigmahat.files.output import output_folder, write_json
from sigmahat.files.tables import read_csv
from sigmahat.joint import sheet
from sigmahat.joint.curve import (
    CURVE,
    FAMILY_HEAD,
    STIFFNESS_HEAD,
    Curve,
    family_rows,
    headline,
    polynomial_in_words,
    reach_in_words,
    read_curve,
    stiffness_rows,
)
from sigmahat.joint.sheet import Sheet
from sigmahat.joint.stored import NO_OTHER_KEYS, Format, Text
from sigmahat.logs import estimate as estimation
from sigmahat.logs.changes import detected
from sigmahat.logs.configuration import Configuration
from sigmahat.logs.estimate import JOINTS
from sigmahat.logs.log import Log
from sigmahat.logs.measured import POINTS, MeasuredPoints, read_points
from sigmahat.logs.output import REPLAYED, EstimateTable, Replayed
from sigmahat.logs.panels import (
    Estimate,
    curve_panels,
    quantity_panels,
    reduce,
    sampling,
    stiffness_panels,
)
from sigmahat.plotting.panels import Panel
from sigmahat.plotting.style import plain_text, plain_title, plain_unit
from sigmahat.report.contents import Contents, TextTable, number, of_file
from sigmahat.report.residuals import residual_panels, residuals


@dataclass(frozen=True)
class ShownFinding:
    """A finding as text."""

    __pydantic_config__ = NO_OTHER_KEYS

    severity: Text  # how much the finding matters: "wrong", "rests on", "note"
    text: Text  # A sentence: the key of the configuration, the number, and a value that is proposed


@dataclass(frozen=True)
class FindingsFile:
    """The contents of the file."""

    __pydantic_config__ = NO_OTHER_KEYS

    format: Text
    version: int
    findings: list[ShownFinding]


FINDINGS = Format("findings.json", "sigmahat findings", 1, FindingsFile)
"""Format of the file."""


def write_findings(findings: Sequence[ShownFinding], folder: Path) -> None:
    """Writes the file into a folder of results; an empty list says that nothing was found."""
    contents = FindingsFile(FINDINGS.name, FINDINGS.version, list(findings))
    write_json(asdict(contents), folder / FINDINGS.file)


def estimated(
    log: Log,
    configuration: Configuration,
    findings: Sequence[tuple[str, str]],
    out: Path,
    progress: Callable[[int], object] = lambda thousandths: None,
    start_from: Path | None = None,
    mcap: bool = False,
) -> estimation.Estimate:
    """Returns the estimate, and writes estimate and findings into out: all files, or no file.

    findings  of the checks: severity and sentence
    mcap      whether estimate.mcap is written, too

    Raises what `estimate` raises, OSError if out cannot be written to.
    """
    with output_folder(out) as folder:
        result = estimation.estimate(log, configuration, folder, progress, start_from, mcap)
        write_findings([ShownFinding(*each) for each in findings], folder)
    return result


def findings_table(folder: Path) -> list[TextTable]:
    """The table of the file in a folder; no table without this file.

    Raises ValueError, which says what is wrong, for a damaged file.
    """
    if not (folder / FINDINGS.file).is_file():
        return []
    found = FINDINGS.read(folder).findings
    rows = [[each.severity, each.text] for each in found]
    note = "" if rows else "Nothing in the log contradicts the configuration."
    return [TextTable("Checks", ["", "finding"], rows, [True, True], note=note)]


_OF_THE_METHOD = ("a", "rho")  # inner outputs of the method, which are not in the table


@dataclass(frozen=True)
class _Answer:
    """Contents of the files beside the table."""

    sheet: sheet.Sheet
    replayed: Replayed
    curve: Curve
    points: MeasuredPoints


def from_log(folder: Path) -> Contents:
    """The curve, other results, and the signals of the estimator over time.

    A folder that an older version wrote has only the signals. Raises ValueError, which says what to
    do, for a damaged or wrong file.
    """
    table = EstimateTable(folder)
    used, t = table["valid"].astype(bool), table["t"]
    signals = drawn = table.without("valid", "t")
    answer = _answer(folder)
    if answer is not None and answer.sheet.method != "FilteredRegression":
        drawn = signals.without("sigma_std")  # the method gives no interval
    reduced = reduce(t, drawn)
    marks = []
    if "change_age" in signals:  # older versions have no such output
        marks = t[detected(signals["change_age"], signals["confident"].astype(bool))].tolist()
    tables = []
    if answer is not None:
        tables += [curve_table(answer.curve)] if answer.curve.branches else []
        tables.append(found_table(answer.sheet))
    tables += findings_table(folder)
    tables.append(_estimates(signals, used))
    if doubts := table.doubts():
        tables.append(_doubts(doubts))
    if answer is not None:
        tables.append(estimator_table(answer.sheet))
    return Contents(
        f"Log: {folder.resolve().name}",
        [
            *_origin(answer, folder),
            f"{len(used)} rows over {t[-1] - t[0]:.6g} s; {_skipped(answer, used)}",
            *(["Dotted lines: changes of the stiffness, see Samples."] if marks else []),
        ],
        tables,
        [
            *stiffness_panels(reduced, [Estimate("estimate", {"sigma": "sigma"})]),
            *quantity_panels(reduced, ""),
            *_residuals(t, drawn, used, answer),
        ],
        headline="" if answer is None else headline(answer.curve, answer.sheet.doubt),
        answer=[] if answer is None else list(curve_panels(answer.curve, answer.points)),
        notes=[*([] if answer is None else answer.replayed.notes), *sampling(reduced)],
        every=reduced.every if reduced.bucket > 1 else None,
        marks=marks,
    )


def from_joints(folder: Path) -> Contents:
    """The table of several joints, and the curve of each joint.

    Raises ValueError, which says what to do, for a file that is missing or damaged.
    """
    table = read_csv(folder / JOINTS)
    if table.column_names[:1] != ["joint"]:
        raise ValueError(f"{folder / JOINTS}: no table of `sigmahat estimate`; run it again")
    names = list(dict.fromkeys(map(str, table["joint"].to_pylist())))
    panels, lines = [], list[str]()
    for name in names:
        answer = _answer(folder / name)
        if answer is None:
            raise ValueError(f"{folder / name}: no result of `sigmahat estimate`; run it again")
        lines = lines or list(_origin(answer, folder / name))  # the same log for all joints
        of_curve = list(curve_panels(answer.curve, answer.points))
        panels += [replace(each, title=f"{name}: {each.title}") for each in of_curve[1:]]
    note = f"Each joint has a report of its own: sigmahat report {folder}/{names[0]}"
    stiffness = replace(of_file("Stiffness", table), note=note)
    return Contents(f"Joints: {folder.resolve().name}", lines, [stiffness], panels)


def _residuals(
    t: NDArray[Any],
    drawn: Mapping[str, NDArray[Any]],
    used: NDArray[np.bool_],
    answer: _Answer | None,
) -> Iterator[Panel]:
    """Panels about the residual of FilteredRegression; the other method predicts no friction."""
    if answer is None or answer.sheet.method != "FilteredRegression":
        return
    bandwidth = float(answer.sheet.start_values["regression.bandwidth"])
    found = residuals(t, drawn, used, bandwidth)
    if found is not None:
        yield from residual_panels(found)


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


def _origin(answer: _Answer | None, folder: Path) -> Iterator[str]:
    """A line with the log, the configuration, the version and the time of the results."""
    if answer is not None:
        made = datetime.fromtimestamp((folder / REPLAYED.file).stat().st_mtime).astimezone()
        version, source = answer.sheet.sigmahat, answer.sheet.configuration.file
        yield f"{answer.replayed.log} with {source}; sigmahat {version}, {made:%Y-%m-%d %H:%M %Z}"


def _skipped(answer: _Answer | None, used: NDArray[np.bool_]) -> str:
    """Number of skipped ticks, as in `estimate`. A gap in the log has ticks, but no rows."""
    if answer is None:
        return f"in {np.count_nonzero(~used)} of the rows the estimator skipped the tick"
    replayed = answer.replayed
    return f"{replayed.skipped} of {replayed.ticks} ticks of {replayed.T:g} s skipped"


def _estimates(signals: EstimateTable, used: NDArray[np.bool_]) -> TextTable:
    """Each output at the end, and its range and RMS where the estimator ran in the second half."""
    late = used & (np.arange(len(used)) >= len(used) // 2)
    rows = []
    for name in signals:
        if name not in _OF_THE_METHOD:
            values, own = signals[name], signals[name][late]
            range_and_rms = [own.min(), own.max(), np.sqrt(np.mean(own**2))] if len(own) else []
            cells = [values[-1], *(range_and_rms or [np.nan] * 3)]
            title = plain_title(name, signals.units[name])
            rows.append([title, *(number(float(cell)) for cell in cells)])
    return TextTable(
        "Outputs of the estimator",
        ["", "at the end", "least *", "greatest *", "RMS *"],
        rows,
        [True, False, False, False, False],
        note="* in the second half",
        folded=True,
    )


def _doubts(doubts: Counter[str]) -> TextTable:
    """How often the estimator was confident, and why not, in the second half."""
    rows = doubts.total()
    shares = [[item, f"{100 * count / rows:.3g}"] for item, count in doubts.most_common()]
    return TextTable(
        "Doubt",
        ["why not confident", "fraction of rows [%] *"],
        shares,
        [True, False],
        note="* in the second half; None: it was confident",
    )


_WORDS = {
    "gamma": "gear ratio",
    "B": "inertia of the motor",
    "D_theta": "viscous friction of the motor",
    "tau_coulomb": "Coulomb friction of the motor",
    "bias": "bias of the torque",
    "damping": "damping of the joint",
    "load_friction": "friction by load",
    "eccentric": "eccentricity of the encoders",
    "delay": "delay of the torque",
    "hysteresis": "hysteresis",
}
_FROM = {"prior": "the configuration (prior)", "identify": "identify", "exact": "taken as exact"}


def curve_table(curve: Curve) -> TextTable:
    """The stiffness with its interval, the range of the curve, and the polynomial."""
    several = len(curve.branches) > 1
    head = [plain_text(cell) for cell in (FAMILY_HEAD if several else STIFFNESS_HEAD)]
    rows = list(family_rows(curve) if several else stiffness_rows(curve))
    words = plain_text(polynomial_in_words(curve.polynomial))
    reach = plain_text(reach_in_words(curve))
    note = f"The curve holds {reach}; outside (faded in the plots), it is a guess. {words}."
    if not curve.claims:
        note += " The method gives no interval."
    return TextTable("Stiffness", head, rows, [False] * len(rows[0]), note=note)


def found_table(sheet: Sheet) -> TextTable:
    """Motor data and other estimates, with intervals."""
    rows = []
    for name, each in sheet.parameters.items():
        interval = "-" if each.interval is None else " to ".join(map(number, each.interval))
        unit = "" if each.unit == "1" else plain_unit(each.unit)
        source = _FROM.get(each.interval_from, each.interval_from)
        rows.append([_WORDS.get(name, name), name, number(each.value), unit, interval, source])
    return TextTable(
        "Joint and motor",
        ["", "name", "value", "unit", "95 % interval", "interval from"],
        rows,
        [True, True, False, True, False, True],
    )


def estimator_table(sheet: Sheet) -> TextTable:
    """All parameters of the estimator without the coefficients of its curve; folded."""
    rows = [
        [name, str(value).lower() if isinstance(value, bool) else number(value)]
        for name, value in sheet.start_values.items()
        if not name.startswith("rls.eta_0")
    ]
    note = "motor.B and motor.D_theta as they were found"
    title = "Parameters of the estimator"
    return TextTable(title, ["parameter", "value"], rows, [True, False], note=note, folded=True)
