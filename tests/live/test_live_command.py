"""`sigmahat live` as a program: sockets, signals, and what it leaves behind."""

from __future__ import annotations

import json
import random
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from queue import SimpleQueue
from threading import Thread
from typing import Any

import pytest

from command_line import refused
from sender import CONFIGURATION, free_port, messages
from sigmahat.logs.configuration import read_configuration
from sigmahat.logs.estimate import estimate
from sigmahat.logs.readers.formats import open_log

needs_signals = pytest.mark.skipif(sys.platform == "win32", reason="Windows has no SIGINT")


def nested(message: dict[str, Any]) -> bytes:
    """A message as JSON."""
    arm = {
        "motor": message["arm/motor"],
        "link": [message["arm/link[0]"]],
        "torque": message["arm/torque"],
    }
    return json.dumps({"t": message["t"], "arm": arm}).encode()


@contextmanager
def running(folder: Path, *options: str) -> Iterator[subprocess.Popen[str]]:
    """The command, which waits for messages; "error" of what it prints is kept for the test."""
    (folder / "arm.toml").write_text(CONFIGURATION)
    command = [sys.executable, "-m", "sigmahat", "live", "arm.toml", *options, "--out", "out"]
    process = subprocess.Popen(
        command, cwd=folder, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
        text=True,
    )  # fmt: skip
    try:
        assert process.stderr is not None
        assert "Ctrl-C ends it" in process.stderr.readline()
        yield process
    finally:
        process.kill()
        process.wait()


def ended(process: subprocess.Popen[str], number: int = signal.SIGINT) -> tuple[str, str]:
    """What the command prints after a signal."""
    process.send_signal(number)
    out, err = process.communicate(timeout=60)
    assert process.returncode == 0, err
    return out, err


def recorded(folder: Path) -> list[Path]:
    return sorted((folder / "out").glob("*.parquet"))


class Viewer:
    """Receives estimates, in a thread, since the system keeps few datagrams."""

    def __init__(self) -> None:
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self._socket.bind(("127.0.0.1", 0))
        self.port = self._socket.getsockname()[1]
        self._received: SimpleQueue[bytes] = SimpleQueue()
        Thread(target=self._receive, daemon=True).start()

    def _receive(self) -> None:
        while True:
            self._received.put(self._socket.recv(65536))

    def next(self) -> Any:
        return json.loads(self._received.get(timeout=10))


def send(port: int, datagrams: Sequence[bytes], pause: float = 5e-4) -> None:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sender:
        for each in datagrams:
            sender.sendto(each, ("127.0.0.1", port))
            time.sleep(pause)


@needs_signals
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_udp_in_and_out(number: int, tmp_path: Path) -> None:
    viewer, port = Viewer(), free_port()
    sent = messages(1000)
    with running(tmp_path, "--from", f"udp:{port}", "--to", f"udp:{viewer.port}") as process:
        send(port, [nested(each) for each in sent])
        received = [viewer.next() for _ in sent]
        out, _ = ended(process, number)
    assert out.startswith("messages: 1000 read\n")
    (recording,) = recorded(tmp_path)
    assert f"sigmahat estimate {Path('out', recording.name)} --config" in out
    series = estimate(
        open_log(recording), read_configuration(recording.with_suffix(".toml"))
    ).series
    assert series is not None
    assert [each["timestamp"] for each in received] == pytest.approx([each["t"] for each in sent])
    assert [each["joint"]["sigma"] for each in received] == series["sigma"].tolist()
    assert [each["joint"]["doubt"] for each in received] == series["doubt"].tolist()


@needs_signals
def test_any_datagrams_leave_the_estimate_as_it_is(tmp_path: Path) -> None:
    noise = random.Random(7)
    port, viewer = free_port(), Viewer()
    good = [nested(each) for each in messages(600)]
    sent = []
    for i, each in enumerate(good):
        sent.append(each)
        fuzz = [
            noise.randbytes(noise.randrange(2000)),
            each[: noise.randrange(len(each))],
            good[noise.randrange(max(i - 300, 0), i + 1)],
            nested({**messages(1)[0], "t": noise.choice([-1e9, 1e9, 1e300])}),
            b'{"t": NaN, "arm": {"motor": 1}}',
            b"[" * 60_000,
        ]
        sent += noise.sample(fuzz, noise.randrange(3))
    with running(tmp_path, "--from", f"udp:{port}", "--to", f"udp:{viewer.port}") as process:
        send(port, sent)
        received = [viewer.next() for _ in good]
        out, err = ended(process)
    assert err.count("a message that cannot be read") == 1
    counted = out.splitlines()[0]
    assert all(each in counted for each in ("not readable", "late", "far off in time"))
    alone = tmp_path / "alone"
    alone.mkdir()
    with running(alone, "--from", f"udp:{port}", "--to", f"udp:{viewer.port}") as process:
        send(port, good)
        assert [viewer.next() for _ in good] == received
        ended(process)


@needs_signals
def test_senders_over_tcp_come_and_go(tmp_path: Path) -> None:
    port = free_port()
    sent = messages(1000)
    lines = ["t,arm/motor,arm/link[0],arm/torque\n"]
    lines += [",".join(map(str, each.values())) + "\n" for each in sent]
    with running(tmp_path, "--from", f"tcp:{port}") as process:
        for part in (lines[:500], [lines[0], *lines[500:]]):
            with socket.create_connection(("127.0.0.1", port)) as sender:
                sender.sendall("".join(part).encode())
            time.sleep(1.0)
        out, _ = ended(process)
    assert "messages: 1002 read" in out
    assert open_log(recorded(tmp_path)[0]).samples("t") == 1000


def test_standard_input_ends_the_command(tmp_path: Path) -> None:
    sent = "".join(nested(each).decode() + "\n" for each in messages(100))
    with running(tmp_path, "--from", "stdin") as process:
        out, _ = process.communicate(sent, timeout=60)
    assert out.startswith("messages: 100 read\n")
    assert process.returncode == 0


def test_a_replayed_log_takes_its_time(tmp_path: Path) -> None:
    sent = messages(1000)
    log = tmp_path / "arm.csv"
    rows = [",".join(map(repr, each.values())) for each in sent]
    log.write_text("\n".join([",".join(sent[0]), *rows]) + "\n")
    viewer = Viewer()
    with running(tmp_path, "--replay", "arm.csv", "--to", f"udp:{viewer.port}") as process:
        received = [viewer.next() for _ in range(100)]
        begin = time.monotonic()
        received += [viewer.next() for _ in range(900)]
        took = time.monotonic() - begin
        process.communicate(timeout=60)
    assert took > 0.9 * 1.8
    series = estimate(open_log(log), read_configuration(tmp_path / "arm.toml")).series
    assert series is not None
    assert [each["joint"]["sigma"] for each in received] == series["sigma"].tolist()


@needs_signals
@pytest.mark.slow("the command starts twice, and takes messages in real time")
def test_what_was_learned_is_gone_on_with(tmp_path: Path) -> None:
    port = free_port()
    datagrams = [nested(each) for each in messages(2000)]
    for part, options in ((datagrams[:1000], ()), (datagrams[1000:], ("--start-from", "out"))):
        with running(tmp_path, "--from", f"udp:{port}", *options) as process:
            send(port, part)
            time.sleep(0.5)
            ended(process)
    state = json.loads((tmp_path / "out" / "state.json").read_text())
    assert [each["ticks"] for each in state["logs"]] == [1000, 1000]


@pytest.mark.parametrize(
    ("options", "expected"),
    [
        (
            ["--from", "serial:1"],
            "--from: expected udp:PORT, tcp:PORT, stdin or ros2, got 'serial:1'",
        ),
        (["--from", "udp:70000"], "--from: expected a port from 1 to 65535, got '70000'"),
        (
            ["--to", "tcp:1"],
            "--to: expected udp:PORT, udp:HOST:PORT, foxglove[:PORT] or ros2, got 'tcp:1'",
        ),
        (["--columns", "t,x"], "--columns lacks arm/motor"),
        (["--host", "203.0.113.1"], "cannot listen at 203.0.113.1, udp:9870:"),
        (["--replay", "none.csv"], "none.csv: No such file or directory"),
        (["--replay", "short.csv"], "short.csv: unknown column 'arm/motor'"),
        (["--start-from", "none"], "none: No such file or directory; name the folder"),
    ],
)
def test_wrong_arguments_are_said(
    options: list[str], expected: str, tmp_path: Path, capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
) -> None:  # fmt: skip
    monkeypatch.chdir(tmp_path)
    Path("arm.toml").write_text(CONFIGURATION)
    Path("short.csv").write_text("t,x\n0,1\n1,2\n")
    assert expected in refused(capsys, "live", "arm.toml", "--out", "out", *options)
    assert not Path("out").exists()


def test_a_port_in_use_is_said(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "arm.toml").write_text(CONFIGURATION)
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as other:
        other.bind(("127.0.0.1", 0))
        source = f"udp:{other.getsockname()[1]}"
        said = refused(
            capsys,
            "live",
            str(tmp_path / "arm.toml"),
            "--from",
            source,
            "--out",
            str(tmp_path / "out"),
        )
    assert (
        f"cannot listen at 127.0.0.1, {source}: Address already in use; name another port" in said
    )
