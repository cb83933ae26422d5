"""Commands of sigmahat with files from strangers: each in a process of its own, with limits.

One process imports the package and is forked for every command, so that a command takes only
hundredths of a second. Each process also imports this file, so the file imports no other helper.
"""

import json
import multiprocessing
import os
import resource
import signal
import sys
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

LONGEST = 5.0
"""Time after which a command counts as one that hangs [s]."""
MOST_MEMORY = 1000.0
"""Peak of the memory that a command may take for a file of 10 MB [MB]."""
_KILLED_AFTER = 20.0  # [s] So that the time of one that is too slow can be told.
_ADDRESSES = 8 << 30  # bytes; keeps a bomb away from the machine
_FILES = 1 << 30  # bytes of a file that is written
_SERVER = multiprocessing.get_context("forkserver")
_SERVER.set_forkserver_preload(
    [
        *("h5py", "scipy.io", "scipy.signal", "matplotlib.figure", "rosbags.highlevel"),
        *("sigmahat.checks.check", "sigmahat.guess.guess", "sigmahat.result.estimate"),
        *("sigmahat.motor.identify", "sigmahat.recording.readers.csv_parquet"),
        *("sigmahat.recording.readers.matrices", "sigmahat.report.page", "sigmahat.studies.sweep"),
        *("sigmahat.result.validate", "sigmahat.cli"),
    ]
)


@dataclass(frozen=True)
class Done:
    status: int  # exit status; negative: the number of a signal
    out: str
    err: str
    seconds: float
    megabytes: float  # peak of the memory in RAM

    def complaint(self) -> str | None:
        """Returns a forbidden action of the command; None if there is none."""
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


def run(folder: Path, *arguments: str) -> Done:
    with TemporaryDirectory() as name:
        place = Path(name)
        process = _SERVER.Process(target=_run, args=(folder, arguments, place))
        process.start()
        process.join()
        assert process.exitcode is not None
        out, err = (
            (place / file).read_bytes()[:100_000].decode(errors="replace")
            for file in ("out", "err")
        )
        used = place / "used"  # not there if the process was killed
        seconds, megabytes = json.loads(used.read_text()) if used.exists() else (0.0, 0.0)
    return Done(process.exitcode, out, err, seconds, megabytes)


def _run(folder: Path, arguments: tuple[str, ...], place: Path) -> None:
    """Runs the command in the fork; outputs, time and memory are written to files in `place`."""
    from sigmahat.cli import main

    os.chdir(folder)
    for descriptor, name in ((1, "out"), (2, "err")):
        os.dup2(os.open(place / name, os.O_WRONLY | os.O_CREAT), descriptor)
    resource.setrlimit(resource.RLIMIT_AS, (_ADDRESSES, _ADDRESSES))
    resource.setrlimit(resource.RLIMIT_FSIZE, (_FILES, _FILES))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    signal.setitimer(signal.ITIMER_REAL, _KILLED_AFTER)  # the signal ends the process
    try:
        sys.exit(main(arguments))
    finally:
        usage = resource.getrusage(resource.RUSAGE_SELF)
        used = (usage.ru_utime + usage.ru_stime, usage.ru_maxrss * 1024 / 1e6)
        (place / "used").write_text(json.dumps(used))
