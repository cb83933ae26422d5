"""Prints the table of docs/proof/bounds.md: the longest tick on controllers.

    PYTHONPATH=tests/helpers build/venv/bin/python tests/studies/longest_ticks.py

It takes some minutes, as QEMU measures a Cortex-M4F that computes double in software.
"""

from __future__ import annotations

import sys
import tempfile
from pathlib import Path

from tick_bounds import Analysis, build_ticks, longest_measured, rows

PROCESSORS = [(name, real) for name in ("Cortex-M4F", "Cortex-M7") for real in ("float", "double")]


def main() -> None:
    """Builds for all processors and prints a column for each."""
    ninja = Path(sys.executable).with_name("ninja")
    columns = []
    with tempfile.TemporaryDirectory() as folder:
        for name, real in PROCESSORS:
            tree = build_ticks(name, real, ninja, Path(folder))
            columns.append(list(rows(Analysis.of(tree, real), longest_measured(tree))))
    print("| | |", " | ".join(", ".join(it) for it in PROCESSORS), "|")
    print("|---|---|" + "---|" * len(PROCESSORS))
    for cells in zip(*columns, strict=True):
        print("|", " | ".join([*cells[0][:2], *(cell[2] for cell in cells)]), "|")


if __name__ == "__main__":
    main()
