"""Runs commands of sigmahat in this process, and returns their output or their error message."""

import io
import json
import shlex
import subprocess
from collections.abc import Iterator
from contextlib import contextmanager, redirect_stderr, redirect_stdout
from pathlib import Path
from typing import Any

import pytest

from sigmahat.cli import main


def one_line(done: subprocess.CompletedProcess[str]) -> str:
    """Returns the error message of a command, which must be one line and the only output."""
    assert (done.returncode, done.stdout) == (2, "")
    (line,) = done.stderr.splitlines()
    assert line.startswith("sigmahat: error: ")
    return line


def in_process(*arguments: str, cwd: Path = Path()) -> subprocess.CompletedProcess[str]:
    """Runs a command in a folder, without a second start of Python."""
    out, errors = io.StringIO(), io.StringIO()
    with pytest.MonkeyPatch.context() as patch, redirect_stdout(out), redirect_stderr(errors):
        patch.chdir(cwd)
        status = main([*arguments])
    return subprocess.CompletedProcess(arguments, status, out.getvalue(), errors.getvalue())


class Shell:
    """Runs commands without "sigmahat" before them; separates arguments as a shell does."""

    err = ""
    """Returns the output of the last command in the folder."""

    def run(self, command: str, status: int = 0) -> str:
        """Output of a command that must end with this status."""
        done = in_process(*shlex.split(command))
        self.err = done.stderr
        assert done.returncode == status, done.stderr
        return done.stdout

    def json(self, command: str, status: int = 0) -> Any:
        return json.loads(self.run(f"{command} --json", status))

    def refused(self, command: str) -> str:
        """The line that a command fails with. No file may change."""
        files = [path for path in Path().rglob("*") if path.is_file()]
        before = {path: path.read_bytes() for path in files}
        done = subprocess.CompletedProcess(command, 2, self.run(command, 2), self.err)
        assert before == {path: path.read_bytes() for path in Path().rglob("*") if path.is_file()}
        return one_line(done)


@contextmanager
def working_in(folder: Path) -> Iterator[None]:
    """Commands run in a folder, and neither draw figures nor wait for the disk: both take long."""
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(folder)
        patch.setattr("sigmahat.result.estimate._save_figure", lambda *_: None)
        patch.setattr("os.fsync", lambda _: None)
        yield


@pytest.fixture
def shell(tmp_path: Path) -> Iterator[Shell]:
    """Commands in a folder of the test."""
    with working_in(tmp_path):
        yield Shell()
