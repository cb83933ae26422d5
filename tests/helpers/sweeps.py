"""Sweeps as a user starts them, in a process of their own."""

import shlex
import sqlite3
import subprocess
import sys
import time
from collections.abc import Callable
from contextlib import closing
from pathlib import Path
from typing import Any

from sigmahat.experiments.records import NAME

QUICK = "sweep --modality RESIDUAL"
"""One run takes a fraction of a second."""


def start(command: str) -> subprocess.Popen[str]:
    """Starts a command in the background."""
    arguments, pipe = [sys.executable, "-m", "sigmahat", *shlex.split(command)], subprocess.PIPE
    return subprocess.Popen(arguments, stdout=pipe, stderr=pipe, text=True)


def wait_until(is_so: Callable[[], bool], process: subprocess.Popen[Any]) -> None:
    """Waits for a condition while a process is running."""
    deadline = time.monotonic() + 300
    while not is_so():
        assert process.poll() is None, process.communicate()
        assert time.monotonic() < deadline
        time.sleep(0.02)


def written(folder: Path) -> int:
    """Least number of runs that a sweep has recorded so far; nobody else may read its database."""
    path = folder / NAME
    if not path.exists():
        return 0
    count = path.read_bytes().count(b'{"RESIDUAL": {')
    # While a record is being written, the journal would remove it after an interruption.
    journal = path.with_name(f"{NAME}-journal")
    is_open = journal.exists() and any(journal.read_bytes()[:8])
    return max(count - is_open, 0)


def records(folder: Path) -> list[tuple[str, str]]:
    """The runs in a folder, in the order in which they were written."""
    with closing(sqlite3.connect(folder / NAME)) as file:
        return file.execute("SELECT * FROM runs ORDER BY rowid").fetchall()
