"""The job of `sigmahat report`: one HTML file of the results in a folder, of several commands."""

from base64 import b64encode
from collections.abc import Callable
from functools import partial
from pathlib import Path

import pyarrow as pa
from bokeh.embed import components
from bokeh.resources import Resources
from jinja2 import Environment, FileSystemLoader, StrictUndefined

from sigmahat.files.tables import read_csv
from sigmahat.logs.estimate import JOINTS
from sigmahat.paper.reproduction import TABLE
from sigmahat.report.contents import Contents, TextTable, of_file
from sigmahat.report.from_log import from_joints, from_log
from sigmahat.report.from_reproduction import from_reproduction
from sigmahat.report.plots import plots
from sigmahat.sweep.panels import against_parameters, distributions
from sigmahat.sweep.summary import summary_columns
from sigmahat.sweep.table import FAILURE, RUN, Role, read, title

METHODS, MISFITS = "compare.csv", "misfits.csv"
"""Files of `compare` and `compare --misfits`; the figure has the same name."""
_FIRST = {METHODS: "group", MISFITS: "class"}  # column whose values head the tables
_SEEDS = "seeds"


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
    return Contents(
        f"Comparison: {folder.resolve().name}",
        [f"{table.num_rows} rows; mean over {seeds} seed{'s' if seeds > 1 else ''}"],
        tables,
        [],
        pictures=[picture] if picture.is_file() else [],
    )


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
    summary = TextTable(
        "Mean and 95 % interval over the runs",
        [column.title for column in columns],
        list(zip(*(column.cells for column in columns), strict=True)),
        [column.words for column in columns],
    )
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
    if (folder / "runs.jsonl").is_file():
        raise ValueError(f"{folder}: a sweep that is not complete; run its command again first")
    raise ValueError(
        f"{folder}: no result of `sigmahat reproduce`, `estimate`, `sweep` or `compare` "
        f"(expected one of {', '.join(kinds)})"
    )


def _page(contents: Contents) -> str:
    """The report as HTML."""
    made = plots([*contents.answer, *contents.panels], contents.every, contents.marks)
    script, divs = components([plot.figure for plot in made]) if made else ("", [])
    shown, first = list(zip(made, divs, strict=True)), len(contents.answer)
    loader = FileSystemLoader(Path(__file__).parent)
    environment = Environment(loader=loader, autoescape=True, undefined=StrictUndefined)
    return environment.get_template("page.html").render(
        contents=contents,
        answer=shown[:first],
        plots=shown[first:],
        pictures=[b64encode(path.read_bytes()).decode() for path in contents.pictures],
        library=Resources(mode="inline", components=["bokeh"]).render() if made else "",
        script=script,
    )
