"""The job of `sigmahat report`: one HTML file of the results in a folder, of several commands."""

import re
from base64 import b64encode
from collections.abc import Callable, Iterator, Mapping
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
from bokeh.embed import components
from bokeh.resources import Resources
from numpy.typing import NDArray

from sigmahat.files.tables import read_csv
from sigmahat.files.templates import environment
from sigmahat.logs.estimate import JOINTS
from sigmahat.logs.panels import SIDES, of_side, quantity_panels, reduce, sampling, stiffness_panels
from sigmahat.paper.reproduction import SEEDS, TABLE, TIME, read_result_files
from sigmahat.plotting.panels import COLORS, TRUE, Curve, Kind, Panel
from sigmahat.plotting.style import PAGE, QUANTITIES, plain_axis
from sigmahat.report.contents import Contents, TextTable, of_file
from sigmahat.report.from_log import from_joints, from_log
from sigmahat.report.plots import plots
from sigmahat.sweep.panels import against_parameters, distributions
from sigmahat.sweep.summary import summary_columns
from sigmahat.sweep.table import FAILURE, RUN, Role, read, title

METHODS, MISFITS = "compare.csv", "misfits.csv"
"""Files of `compare` and `compare --misfits`; the figure has the same name."""
_FIRST = {METHODS: "group", MISFITS: "class"}  # column whose values head the tables
_SEEDS = "seeds"  # another column of these files
_MAIN = "RESIDUAL"  # estimator for panels of a single estimator: RESIDUAL needs no torque sensor
_STIFFNESS = re.compile(r"sigma(_\d)?")


def from_reproduction(folder: Path) -> Contents:
    """Stiffness of every estimator, and all other signals of one estimator.

    Raises ValueError as read_result_files() does.
    """
    table, series = read_result_files(folder)
    main = _MAIN if _MAIN in series else next(iter(series))
    signals = dict(series[main])
    t = signals.pop(TIME)
    estimates = {}
    for name, own in series.items():
        keys = {each: f"{name} {each}" for each in own if _STIFFNESS.fullmatch(each)}
        signals |= {key: own[each] for each, key in keys.items()}
        estimates[name] = keys
    reduced = reduce(t, signals)
    seeds = table[SEEDS][0].as_py()
    of_seeds = f" of {seeds} seeds; the plots show the first" if seeds > 1 else ""
    # The columns that have a value in some row.
    shown = [name for name in table.column_names if table[name].null_count < len(table)]
    indices = of_file("Performance indices", table.select(shown))
    quantities = quantity_panels(reduced, main if len(series) > 1 else "")
    return Contents(
        f"Reproduction: {folder.resolve().name}",
        [f"{len(t)} samples{of_seeds}"],
        [indices],
        [*stiffness_panels(reduced, estimates), *quantities],
        answer=list(over_deformation(series[main], main)),
        notes=sampling(reduced),
        every=reduced.every if reduced.bucket > 1 else None,
    )


_LAST = 1 / 3  # fraction of the run that is shown: at the end, an estimate changes little
_COUNT = 100  # number of dots of the estimate: few, so that the truth is visible between the dots

Signals = Mapping[str, NDArray[Any]]


def over_deformation(signals: Signals, estimator: str) -> Iterator[Panel]:
    """Two panels for each transmission with a fixed spring; separate panels for sides of a pair.

    No panels without the truth. signals  of the plant and of one estimator
    """
    for side in SIDES:
        needed = [f"{name}{side}" for name in ("phi", "tau_e", "sigma", "setPoint")]
        needed += [f"plant.{name}" for name in needed[:3]]
        if not all(name in signals for name in needed):
            continue
        late = slice(int(len(signals["t"]) * (1 - _LAST)), None)
        own = {name: signals[name][late] for name in needed}
        if np.ptp(own[f"setPoint{side}"]) > 0:
            continue
        for name in ("tau_e", "sigma"):
            words = QUANTITIES[name].words.capitalize()
            title = f"{words} against deformation{of_side(side)}, {estimator}"
            axes, curves = (plain_axis("phi"), plain_axis(name)), list(_curves(own, name, side))
            caption = f"last {_LAST * float(signals['t'][-1]):.3g} s"
            yield Panel(title, *axes, curves, linked=False, caption=caption)


def _curves(signals: Signals, name: str, side: str) -> Iterator[Curve]:
    """The truth as a line, and the estimate as dots on it or beside it."""
    phi, true = signals[f"plant.phi{side}"], signals[f"plant.{name}{side}"]
    every = _few(phi, 10 * _COUNT)
    yield Curve("true", TRUE, phi[every], true[every], width=3.5)
    phi, value = signals[f"phi{side}"], signals[f"{name}{side}"]
    few = _few(phi, _COUNT)
    yield Curve("estimate", COLORS[0], phi[few], value[few], Kind.POINTS)


def _few(phi: NDArray[Any], count: int) -> NDArray[np.intp]:
    """About count samples, in the order of the deformation."""
    few: NDArray[np.intp] = np.argsort(phi)[:: max(1, len(phi) // count)]
    return few


def from_comparison(name: str, folder: Path) -> Contents:
    """The figure, and a table for each group of conditions; name is METHODS or MISFITS.

    Raises ValueError, which says what to do, if the file is not what `compare` wrote.
    """
    table = read_csv(folder / name)
    first = _FIRST[name]
    if table.column_names[:1] != [first] or _SEEDS not in table.column_names or not table.num_rows:
        raise ValueError(f"{folder / name}: no table of `sigmahat compare`; run it again")
    groups = table[first].to_pylist()
    seeds = table[_SEEDS][0].as_py()
    shown = table.drop_columns([first, _SEEDS])
    tables = [
        of_file(group, shown.filter(pa.array([each == group for each in groups])))
        for group in dict.fromkeys(groups)
    ]
    picture = (folder / name).with_suffix(".png")
    pictures = [picture] if picture.is_file() else []
    lines = [f"{table.num_rows} rows; mean over {seeds} seed{'s' if seeds > 1 else ''}"]
    title = f"Comparison: {folder.resolve().name}"
    return Contents(title, lines, tables, [], pictures=pictures)


def from_sweep(folder: Path) -> Contents:
    """The summary, the distribution of the error, and the error against each parameter.

    Raises ValueError as sigmahat.sweep.table.read() does.
    """
    sweep = read(folder / "sweep.parquet")
    runs = dict(zip(sweep.values(RUN), sweep.values(FAILURE), strict=True))
    failed = sum(failure is not None for failure in runs.values())
    lines = [f"{len(runs)} runs, {failed} of them failed"]
    drawn = [title(column) for column in sweep.parameters(Role.DRAWN)]
    if drawn:
        lines.append(f"drawn for each seed: {', '.join(drawn)}")
    columns = summary_columns(sweep)
    head = [column.title for column in columns]
    rows = list(zip(*(column.cells for column in columns), strict=True))
    words = [i for i, column in enumerate(columns) if column.words]
    summary = TextTable("Mean and 95 % interval over the runs", head, rows, words)
    panels = [*distributions(sweep), *against_parameters(sweep)]
    return Contents(f"Sweep: {folder.resolve().name}", lines, [summary], panels)


def report(folder: Path) -> str:
    """HTML with the tables and plots of a reproduction, a log, a sweep or a comparison in a folder.

    Raises ValueError, which says what to do, if the folder has no such results, or damaged files.
    """
    if not folder.is_dir():
        raise ValueError(
            f"{folder}: expected a folder of `sigmahat reproduce`, `estimate`, `sweep` or `compare`"
        )
    kinds: dict[str, Callable[[Path], Contents]] = {
        "sweep.parquet": from_sweep,
        TABLE: from_reproduction,
        "estimate.parquet": from_log,
        "estimate.csv": from_log,
        JOINTS: from_joints,
        METHODS: partial(from_comparison, METHODS),
        MISFITS: partial(from_comparison, MISFITS),
    }
    for name, contents in kinds.items():
        if (folder / name).is_file():
            return _page(contents(folder))
    if (folder / "runs.sqlite").is_file():
        raise ValueError(f"{folder}: a sweep that is not complete; run its command again first")
    raise ValueError(
        f"{folder}: no result of `sigmahat reproduce`, `estimate`, `sweep` or `compare` "
        f"(expected one of {', '.join(kinds)})"
    )


def _page(contents: Contents) -> str:
    panels, first = [*contents.answer, *contents.panels], len(contents.answer)
    script, divs = components(plots(panels, contents.every, contents.marks)) if panels else ("", [])
    shown = list(zip(range(len(panels)), panels, divs, strict=True))
    page = environment(Path(__file__).parent).get_template("page.html")
    return page.render(
        contents=contents,
        style=PAGE.read_text(encoding="utf-8"),
        answer=shown[:first],
        plots=shown[first:],
        pictures=[b64encode(path.read_bytes()).decode() for path in contents.pictures],
        library=Resources(mode="inline", components=["bokeh"]).render() if panels else "",
        script=script,
    )
