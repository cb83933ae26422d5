"""Sweeps as a user starts them, in a process of their own."""

import shlex
import subprocess
import sys
import time
from pathlib import Path

QUICK = "sweep --modality RESIDUAL"
"""One run takes a fraction of a second."""


def start(command: str) -> subprocess.Popen[str]:
    """Starts a command that goes on meanwhile."""
    arguments, pipe = [sys.executable, "-m", "sigmahat", *shlex.split(command)], subprocess.PIPE
    return subprocess.Popen(arguments, stdout=pipe, stderr=pipe, text=True)


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
