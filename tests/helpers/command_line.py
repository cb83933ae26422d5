"""What the command line says when it refuses."""

from __future__ import annotations

import subprocess

import pytest

from sigmahat.cli import main


def one_line(done: subprocess.CompletedProcess[str]) -> str:
    """The line that a command failed with; it must be one line, and all that was printed."""
    assert (done.returncode, done.stdout) == (2, "")
    (line,) = done.stderr.splitlines()
    assert line.startswith("sigmahat: error: ")
    return line


def refused(capsys: pytest.CaptureFixture[str], *arguments: str) -> str:
    """Runs a command in this process that must fail with one line, and returns that line."""
    capsys.readouterr()
    status = main([*arguments])
    return one_line(subprocess.CompletedProcess(arguments, status, *capsys.readouterr()))
