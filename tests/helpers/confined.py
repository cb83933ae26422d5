"""Commands of sigmahat with files from strangers: each in a process of its own, with limits.

One process imports the package and is forked for every command, so that one takes some hundredths
of a second. `python confined.py` is that process: a line of JSON comes in, a line of JSON goes out.
"""

from __future__ import annotations

import json
import os
import resource
import signal
import subprocess
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

LONGEST = 5.0
"""Time after which a command counts as one that hangs [s]."""
MOST_MEMORY = 1000.0
"""Peak of the memory that a command may take for a file of 10 MB [MB]."""
_KILLED_AFTER = 20.0  # [s] So that the time of one that is too slow can be told.
_ADDRESSES = 8 << 30  # bytes; keeps a bomb away from the machine
_FILES = 1 << 30  # bytes of a file that is written


@dataclass(frozen=True)
class Done:
    """How a command ended."""

    status: int  # of the exit; negative: the number of the signal that ended it
    out: str
    err: str
    seconds: float
    megabytes: float  # peak of the memory in RAM

    def complaint(self) -> str | None:
        """What the command did that no file may make it do; None if all is well."""
        if self.seconds > LONGEST:
            return f"took {self.seconds:.1f} s"
        if self.megabytes > MOST_MEMORY:
            return f"took {self.megabytes:.0f} MB"
        if self.status not in (0, 1, 2):
            return f"ended with {self.status}: {self.err[-2000:]}"
        lines = self.err.splitlines()
        if self.status == 2 and not (len(lines) == 1 and lines[0].startswith("sigmahat: error: ")):
            return f"more than one line: {self.err[-2000:]}"
        return "a traceback: " + self.err[-2000:] if "Traceback" in self.err else None


class Confined:
    """The process that is forked; a context manager that ends it."""

    def __init__(self) -> None:
        self._process = subprocess.Popen(
            [sys.executable, __file__], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
        )

    def run(self, folder: Path, *arguments: str) -> Done:
        """Runs `sigmahat` with arguments in a folder."""
        assert self._process.stdin is not None and self._process.stdout is not None
        self._process.stdin.write(json.dumps([str(folder), arguments]) + "\n")
        self._process.stdin.flush()
        return Done(*json.loads(self._process.stdout.readline()))

    def __enter__(self) -> Confined:
        return self

    def __exit__(self, *_: object) -> None:
        self._process.communicate()


def _run(folder: str, arguments: Sequence[str]) -> list[Any]:
    """Forks, and returns the fields of Done."""
    outputs = [os.memfd_create(name) for name in ("out", "err")]
    process = os.fork()
    if process == 0:
        _child(folder, arguments, outputs)
    _, status, usage = os.wait4(process, 0)
    texts = []
    for output in outputs:
        with os.fdopen(output, "rb") as file:
            file.seek(0)
            texts.append(file.read(100_000).decode(errors="replace"))
    code = os.waitstatus_to_exitcode(status)
    return [code, *texts, usage.ru_utime + usage.ru_stime, usage.ru_maxrss * 1024 / 1e6]


def _child(folder: str, arguments: Sequence[str], outputs: Sequence[int]) -> None:
    from sigmahat.cli import main

    os.chdir(folder)
    os.dup2(os.open(os.devnull, os.O_RDONLY), 0)
    os.dup2(outputs[0], 1)
    os.dup2(outputs[1], 2)
    resource.setrlimit(resource.RLIMIT_AS, (_ADDRESSES, _ADDRESSES))
    resource.setrlimit(resource.RLIMIT_FSIZE, (_FILES, _FILES))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    signal.setitimer(signal.ITIMER_REAL, _KILLED_AFTER)  # its default is to end the process
    status = 70
    try:
        status = main(arguments)
        sys.stdout.flush()
        sys.stderr.flush()
    except BaseException:
        import traceback

        traceback.print_exc()
        sys.stderr.flush()
    finally:
        os._exit(status)


def _serve() -> None:
    """Imports what the commands need, without starting a thread, and waits for lines."""
    from importlib import import_module

    for name in (
        *("h5py", "scipy.io", "scipy.signal", "matplotlib.figure", "rosbags.highlevel"),
        *("sigmahat.checks.check", "sigmahat.guessing.guess", "sigmahat.logs.estimate"),
        *("sigmahat.identification.identify", "sigmahat.logs.readers.tables"),
        *("sigmahat.logs.readers.matrices", "sigmahat.report.page", "sigmahat.sweep.job"),
        "sigmahat.validation.validate",
    ):
        import_module(name)
    for line in sys.stdin:
        print(json.dumps(_run(*json.loads(line))), flush=True)


if __name__ == "__main__":
    _serve()
