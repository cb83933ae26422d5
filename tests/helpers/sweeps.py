"""Sweeps as a user starts them, in this process or in one of their own."""

import subprocess
import sys
import time
from collections.abc import Sequence
from pathlib import Path

from command_line import in_process, one_line

COMMAND = [sys.executable, "-m", "sigmahat", "sweep"]
QUICK = ["--modality", "RESIDUAL"]
"""One run takes a fraction of a second."""


def run(*arguments: str, cwd: Path) -> subprocess.CompletedProcess[str]:
    """Runs a sweep to its end, in this process."""
    return in_process("sweep", *arguments, cwd=cwd)


def start(arguments: Sequence[str], cwd: Path) -> subprocess.Popen[str]:
    """Starts a sweep that goes on meanwhile."""
    return subprocess.Popen(
        [*COMMAND, *arguments], cwd=cwd, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )


def refused(*arguments: str, cwd: Path) -> str:
    """Runs a sweep that must fail with one line, and returns that line."""
    return one_line(run(*arguments, cwd=cwd))


def records(path: Path) -> list[bytes]:
    """Complete lines so far, without the first, which names the sweep."""
    return path.read_bytes().splitlines(keepends=True)[1:] if path.exists() else []


def wait_for_records(path: Path, count: int, process: subprocess.Popen[str]) -> None:
    """Waits until some runs are done, but not all of them."""
    deadline = time.monotonic() + 300
    while len(records(path)) < count:
        assert process.poll() is None, process.communicate()
        assert time.monotonic() < deadline
        time.sleep(0.02)
