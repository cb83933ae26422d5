"""A recording is readable whenever the process ends, and no disk stops an estimate."""

import errno
import json
import os
import random
import shutil
import signal
import socket
import sys
import time
from collections.abc import Callable
from functools import partial
from io import FileIO
from itertools import chain
from multiprocessing import get_context
from pathlib import Path
from threading import Thread
from types import SimpleNamespace

import numpy as np
import pytest

from sender import CONFIGURATION, T, Viewer, estimated, free_port, messages, running
from sigmahat.cli import main
from sigmahat.live import recording, session
from sigmahat.live.events import NotWritten
from sigmahat.live.live_joint import Estimated
from sigmahat.live.session import Session
from sigmahat.recording.readers.formats import open_log

LOST = 2.0  # [s] of a recording, at most


class Full(FileIO):
    """A file on a disk that is full after some bytes."""

    room = 20_000

    def write(self, data: memoryview) -> int:  # type: ignore[override]
        free = self.room - self.tell()
        if not free:
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        return super().write(data[: min(free, len(data) // 2 + 1)])


def opened(folder: Path) -> Session:
    folder.mkdir(exist_ok=True)
    (folder / "arm.toml").write_text(CONFIGURATION)
    return Session(folder / "arm.toml", folder)


def written(live: Session) -> None:
    """Waits for the thread that writes, which has no time in simulated time."""
    assert live._recording is not None
    live._recording._written.result()


@pytest.mark.parametrize("seed", range(3))
def test_what_is_lost_when_the_process_is_killed(
    seed: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A copy of the file at any time is what SIGKILL leaves."""
    sent, now = messages(5000, seed), 0.0
    monkeypatch.setattr(recording, "time", SimpleNamespace(monotonic=lambda: now))
    live, killed = opened(tmp_path), random.Random(seed).randrange(1000, 5000)
    for i, each in enumerate(sent[:killed]):
        now = each["t"]
        live.take(each, 0)
        if i % 250 == 0:  # a write takes at most half a second, as the simulated clock counts
            written(live)
    written(live)
    (file,) = tmp_path.glob("*.csv")
    left = Path(shutil.copy(file, tmp_path / "left.csv"))
    shutil.copy(file.with_suffix(".toml"), tmp_path / "left.toml")
    live.close()
    times = open_log(left).read("t")
    np.testing.assert_array_equal(times, [each["t"] for each in sent[: len(times)]])
    assert killed - len(times) <= LOST / T
    whole = estimated(file)
    np.testing.assert_array_equal(estimated(left)["sigma"], whole["sigma"][: len(times)])


def test_what_has_arrived_is_written_while_nothing_arrives(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    now = 0.0
    monkeypatch.setattr(recording, "time", SimpleNamespace(monotonic=lambda: now))
    live = opened(tmp_path)
    for each in messages(100):
        live.take(each, 0)
    written(live)
    now = 1.5
    live.save()
    written(live)
    (file,) = tmp_path.glob("*.csv")
    assert open_log(file).samples("t") == 100
    live.close()


def test_a_full_disk_stops_the_recording_alone(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    sent = messages(3000)
    whole = opened(tmp_path / "whole")
    expected = [*chain.from_iterable(whole.take(each, 0) for each in sent), *whole.close()]
    monkeypatch.setattr(recording, "FileIO", Full)
    monkeypatch.setattr(recording, "_ROWS", 200)
    live = opened(tmp_path / "full")
    found = [*chain.from_iterable(live.take(each, 0) for each in sent), *live.close()]
    (event,) = (each for each in found if isinstance(each, NotWritten))
    (file,) = live.recordings
    assert event.in_words == (f"not written: {file} (No space left on device); the estimates go on")
    sigma = [[e.outputs["sigma"] for e in n if isinstance(e, Estimated)] for n in (found, expected)]
    assert sigma[0] == sigma[1]
    assert file.read_bytes().endswith(b"\n")  # no number is cut off
    rows = open_log(file).samples("t")
    assert rows and rows % 200 == 0
    np.testing.assert_array_equal(estimated(file)["sigma"], sigma[0][:rows])
    assert (tmp_path / "full" / "state.json").is_file()


def test_a_folder_that_vanishes_does_not_stop_the_estimates(tmp_path: Path) -> None:
    live = opened(tmp_path / "gone")
    shutil.rmtree(tmp_path / "gone")
    found = [*chain.from_iterable(live.take(each, 0) for each in messages(300)), *live.close()]
    assert sum(isinstance(each, Estimated) for each in found) == 300
    assert [Path(each).suffix for each in live.not_written] == [".csv"]
    assert (tmp_path / "gone" / "state.json").is_file()


def test_a_sender_cannot_fill_a_folder_with_files(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(session, "_MOST", 3)
    live = opened(tmp_path)
    sent = messages(50)
    again = ({**each, "t": each["t"] + 10 * i} for i in range(10) for each in sent)
    found = [*chain.from_iterable(live.take(each, 0) for each in again), *live.close()]
    assert len(list(tmp_path.glob("*.csv"))) == 3
    (event,) = (each for each in found if isinstance(each, NotWritten))
    assert "further recordings (the sender has started again 3 times)" in event.in_words
    assert sum(isinstance(each, Estimated) for each in found) > 300


@pytest.mark.skipif(sys.platform != "linux", reason="processes that begin as a copy of this one")
@pytest.mark.complete
@pytest.mark.slow("fifty programs for each signal, in real time")
@pytest.mark.parametrize("number", ["SIGINT", "SIGTERM", "SIGHUP", "SIGQUIT", "SIGKILL"])
def test_signals_at_random_times(number: str, tmp_path: Path) -> None:
    chance = random.Random(number)
    lost = []
    for batch in range(5):
        folders = [tmp_path / f"{batch}-{i}" for i in range(10)]
        senders = [killed(each, getattr(signal, number), chance.uniform(1, 6)) for each in folders]
        for folder, sender in zip(folders, senders, strict=True):
            sender.join()
            lost.append((sender.sent - rows_of(folder)) * sender.period)
    print(number, max(lost), "s of the recording lost at most, in", len(lost), "programs")
    assert max(lost) <= (LOST if number in ("SIGQUIT", "SIGKILL") else 0.1)


def killed(folder: Path, number: int, duration: float) -> "Sender":
    """The command in a process that is a copy of this one, which a signal ends."""
    folder.mkdir()
    (folder / "arm.toml").write_text(CONFIGURATION)
    port, log = free_port(), folder / "log"
    process = get_context("fork").Process(target=run_live, args=[folder, port])
    process.start()
    until = time.monotonic() + 60
    while "Ctrl-C" not in (log.read_text() if log.exists() else ""):
        assert time.monotonic() < until
        time.sleep(0.01)
    assert process.pid is not None
    sender = Sender(port, partial(os.kill, process.pid, number), process.join, duration)
    sender.start()
    return sender


def run_live(folder: Path, port: int) -> None:
    os.chdir(folder)
    with (folder / "log").open("wb") as log:
        os.dup2(log.fileno(), 1)
        os.dup2(log.fileno(), 2)
    sys.stdout, sys.stderr = open(1, "w", closefd=False), open(2, "w", 1, closefd=False)  # noqa: SIM115
    main(["live", "arm.toml", "--from", f"udp:{port}", "--out", "out"])


def rows_of(folder: Path) -> int:
    files = [file for file in (folder / "out").glob("*.csv") if file.stat().st_size]
    return open_log(files[0]).samples("t") if files else 0


class Sender(Thread):
    """Sends messages to a program, and a signal at last."""

    period = 0.02  # [s]

    def __init__(
        self,
        port: int,
        kill: Callable[[], object],
        wait: Callable[[], object],
        duration: float,
    ) -> None:
        super().__init__()
        self._port, self._kill, self._wait, self._duration = port, kill, wait, duration
        self.sent = 0

    def run(self) -> None:
        begin = time.monotonic()
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sender:
            for each in messages(round(self._duration / self.period)):
                time.sleep(max(begin + self.sent * self.period - time.monotonic(), 0.0))
                sender.sendto(json.dumps(each).encode(), ("127.0.0.1", self._port))
                self.sent += 1
        self._kill()
        self._wait()


@pytest.mark.skipif(sys.platform != "linux", reason="limits of a file")
@pytest.mark.complete
@pytest.mark.slow("a program in real time")
def test_a_program_goes_on_when_its_files_are_full(tmp_path: Path) -> None:
    port, viewer = free_port(), Viewer()
    limit = ["prlimit", "--fsize=100000"]
    options = ["--from", f"udp:{port}", "--to", f"udp:{viewer.port}"]
    with running(tmp_path, *options, inside=limit) as process:
        sender = Sender(port, process.terminate, process.communicate, 12.0)
        sender.period = 0.004
        sender.start()
        sender.join()
        assert process.returncode == 2
    (file,) = (tmp_path / "out").glob("*.csv")
    rows = open_log(file).samples("t")
    assert 90_000 < file.stat().st_size <= 100_000
    assert viewer.received.qsize() > rows + 1000
