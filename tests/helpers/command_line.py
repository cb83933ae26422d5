"""What the command line says when it refuses."""

from __future__ import annotations

import subprocess


def one_line(done: subprocess.CompletedProcess[str]) -> str:
    """The line that a command failed with; it must be one line, and all that was printed."""
    assert (done.returncode, done.stdout) == (2, "")
    (line,) = done.stderr.splitlines()
    assert line.startswith("sigmahat: error: ")
    return line
