"""Commands as a user gives them, in this process: no second start of Python."""

from __future__ import annotations

import contextlib
import io
import subprocess
from pathlib import Path

import pytest

from sigmahat.cli import main


def command(*arguments: str, cwd: Path) -> subprocess.CompletedProcess[str]:
    """Runs a command in a folder; its status and what it prints."""
    out, errors = io.StringIO(), io.StringIO()
    with (
        pytest.MonkeyPatch.context() as patch,
        contextlib.redirect_stdout(out),
        contextlib.redirect_stderr(errors),
    ):
        patch.chdir(cwd)
        status = main([*arguments])
    return subprocess.CompletedProcess(arguments, status, out.getvalue(), errors.getvalue())
