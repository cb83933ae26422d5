"""The job of `sigmahat report`: finds out what a folder holds, and makes one HTML file of it."""

from __future__ import annotations

from pathlib import Path


def report(folder: Path) -> str:
    """HTML with the tables and plots of a reproduction, a log or a sweep.

    folder  where `sigmahat reproduce`, `estimate` or `sweep` wrote its results

    Raises ValueError, which says what to do, if the folder holds nothing of that or damaged files.
    """
    from sigmahat import report_series, report_sweep
    from sigmahat.report_page import page

    if not folder.is_dir():
        raise ValueError(
            f"{folder}: expected a folder of `sigmahat reproduce`, `estimate` or `sweep`"
        )
    kinds = {
        "sweep.parquet": report_sweep.sweep,
        "table.csv": report_series.reproduction,
        "estimate.parquet": report_series.log,
        "estimate.csv": report_series.log,
    }
    for name, read in kinds.items():
        if (folder / name).is_file():
            return page(read(folder))
    if (folder / "runs.jsonl").is_file():
        raise ValueError(f"{folder}: a sweep that is not complete; run its command again first")
    raise ValueError(
        f"{folder}: no result of `sigmahat reproduce`, `estimate` or `sweep` "
        f"(expected one of {', '.join(kinds)})"
    )
