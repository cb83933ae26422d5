"""The job of `sigmahat report`: one HTML file of the results in a folder, of several commands."""

from __future__ import annotations

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
from sigmahat.paper.result_files import TABLE
from sigmahat.report.contents import Contents, of_file
from sigmahat.report.from_log import from_joints, from_log
from sigmahat.report.from_reproduction import from_reproduction
from sigmahat.report.from_sweep import from_sweep
from sigmahat.report.plots import plots

METHODS, MISFITS = "compare.csv", "misfits.csv"
"""Files of `compare` and `compare --misfits`; the figure has the same name."""
_FIRST = {METHODS: "group", MISFITS: "class"}
"""Column whose values head the tables."""
_SEEDS = "seeds"


def from_comparison(name: str, folder: Path) -> Contents:
    """The figure, and a table for each group of conditions.

    name  of the file, METHODS or MISFITS

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


def report(folder: Path) -> str:
    """HTML with the tables and plots of a reproduction, a log, a sweep or a comparison.

    folder  where one of these commands wrote its results

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
    for name, read in kinds.items():
        if (folder / name).is_file():
            return _page(read(folder))
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
    loader = FileSystemLoader(Path(__file__).parent)
    environment = Environment(loader=loader, autoescape=True, undefined=StrictUndefined)
    return environment.get_template("page.html").render(
        contents=contents,
        answer=list(zip(made, divs, strict=True))[: len(contents.answer)],
        plots=list(zip(made, divs, strict=True))[len(contents.answer) :],
        pictures=[b64encode(path.read_bytes()).decode() for path in contents.pictures],
        library=Resources(mode="inline", components=["bokeh"]).render() if made else "",
        script=script,
    )
