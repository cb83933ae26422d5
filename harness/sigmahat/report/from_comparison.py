"""The contents of a report from what `sigmahat compare` wrote."""

from __future__ import annotations

from pathlib import Path

import pyarrow as pa

from sigmahat.files.tables import read_csv
from sigmahat.report.contents import Contents, of_file

METHODS, MISFITS = "compare.csv", "misfits.csv"
"""Files of `compare` and `compare --misfits`; the figure beside has the same name."""
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
