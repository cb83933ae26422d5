"""Sweeps as a user starts them, in a process of their own."""

import shlex
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

QUICK = "sweep --modality RESIDUAL"
"""One run takes a fraction of a second."""


def start(command: str) -> subprocess.Popen[str]:
    """Starts a command that goes on meanwhile."""
    arguments, pipe = [sys.executable, "-m", "sigmahat", *shlex.split(command)], subprocess.PIPE
    return subprocess.Popen(arguments, stdout=pipe, stderr=pipe, text=True)


def records(path: Path) -> list[bytes]:
    """Complete lines so far, without the first, which names the sweep."""
    return path.read_bytes().splitlines(keepends=True)[1:] if path.exists() else []


def wait_until(is_so: Callable[[], bool], process: subprocess.Popen[Any]) -> None:
    """Waits while a process goes on."""
    deadline = time.monotonic() + 300
    while not is_so():
        assert process.poll() is None, process.communicate()
        assert time.monotonic() < deadline
        time.sleep(0.02)
