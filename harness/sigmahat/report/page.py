"""The job of `sigmahat report`: one HTML file of the results in a folder, of several commands."""

import os
import re
from collections.abc import Callable, Sequence
from pathlib import Path
from urllib.parse import quote

from sigmahat.experiments.records import NAME as RECORDS
from sigmahat.files.templates import environment
from sigmahat.report.contents import Contents, TextTable, of_file
from sigmahat.report.from_log import from_joints, from_log
from sigmahat.result.estimate import JOINTS, read_joints
from sigmahat.result.log_panels import quantity_panels, reduce, sampling, stiffness_panels
from sigmahat.show.panel import Panel
from sigmahat.show.style import PAGE
from sigmahat.studies.reproduce_results import SEEDS, TABLE, TIME, read_result_files
from sigmahat.studies.sweep_panels import against_parameters, distributions
from sigmahat.studies.sweep_summary import summary_columns
from sigmahat.studies.sweep_table import FAILURE, RUN, ValueSource, read, title

_MAIN = "RESIDUAL"  # estimator for panels of a single estimator: RESIDUAL needs no torque sensor
_STIFFNESS = re.compile(r"sigma(_\d)?")


def from_reproduction(folder: Path) -> Contents:
    """Creates panels of the stiffness of every estimator, and other signals of one estimator.

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
        notes=sampling(reduced),
        whole=reduced.whole,
    )


def from_sweep(folder: Path) -> Contents:
    """The summary, the distribution of the error, and the error against each parameter.

    Raises ValueError as sigmahat.studies.sweep_table.read() does.
    """
    sweep = read(folder / "sweep.parquet")
    runs = dict(zip(sweep.values(RUN), sweep.values(FAILURE), strict=True))
    failed = sum(failure is not None for failure in runs.values())
    lines = [f"{len(runs)} runs, {failed} of them failed"]
    drawn = [title(column) for column in sweep.parameters(ValueSource.DRAWN)]
    if drawn:
        lines.append(f"drawn for each seed: {', '.join(drawn)}")
    columns = summary_columns(sweep)
    head = [column.title for column in columns]
    rows = list(zip(*(column.cells for column in columns), strict=True))
    words = [i for i, column in enumerate(columns) if column.words]
    summary = TextTable("Mean and 95 % interval over the runs", head, rows, words)
    panels = [*distributions(sweep), *against_parameters(sweep)]
    return Contents(f"Sweep: {folder.resolve().name}", lines, [summary], panels)


def joints_of(folder: Path) -> list[Path]:
    """Returns the folders of the joints in a folder of results of several joints, else none."""
    if not (folder / JOINTS).is_file():
        return []
    return [folder / name for name in read_joints(folder)[0]]


def report(folder: Path, out: Path) -> str:
    """Creates HTML with the tables and plots of a reproduction, a log or a sweep in a folder.

    out  file of the report, from which its links lead to the reports of joints

    Raises ValueError, which says what to do, if the folder has no such results, or damaged files.
    """
    kinds: dict[str, Callable[[Path], Contents]] = {
        "sweep.parquet": from_sweep,
        TABLE: from_reproduction,
        "estimate.parquet": from_log,
        "estimate.csv": from_log,
        JOINTS: from_joints,
    }
    for name, contents in kinds.items():
        if (folder / name).is_file():
            return page(contents(folder), out)
    if (folder / RECORDS).is_file() and not any(folder.glob("*.csv")):
        raise ValueError(f"{folder}: incomplete sweep; run the command of the sweep again")
    raise ValueError(
        f"{folder}: expected results of `sigmahat reproduce`, `estimate` or `sweep` "
        f"(one of the files {', '.join(kinds)})"
    )


def page(contents: Contents, out: Path) -> str:
    """Creates the HTML of a report; out: its file."""
    links = [(each.text, _address(each.path, out)) for each in contents.links]
    panels, first = [*contents.answer, *contents.panels], len(contents.answer)
    library, script, divs = _interactive(panels, contents) if panels else ("", "", [])
    shown = list(zip(range(len(panels)), panels, divs, strict=True))
    template = environment(Path(__file__).parent).get_template("page.html")
    return template.render(
        contents=contents,
        links=links,
        style=PAGE.read_text(encoding="utf-8"),
        answer=shown[:first],
        plots=shown[first:],
        library=library,
        script=script,
    )


def _interactive(panels: Sequence[Panel], contents: Contents) -> tuple[str, str, Sequence[str]]:
    """Returns Bokeh, the script of the plots of panels, and an element of HTML for each."""
    # Loading Bokeh takes longer than a page without plots.
    from bokeh.embed import components
    from bokeh.resources import Resources

    from sigmahat.show.plots import plots

    script, divs = components(plots(panels, contents.marks, contents.whole))
    return Resources(mode="inline", components=["bokeh"]).render(), script, divs


def _address(path: Path, out: Path) -> str:
    """Returns the address of a file in a link of the page `out`."""
    try:
        relative = Path(os.path.relpath(path.resolve(), out.resolve().parent))
    except ValueError:  # on another drive of Windows
        return path.resolve().as_uri()
    return quote(relative.as_posix())
