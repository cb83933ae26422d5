"""`sigmahat live` as a program: sockets, signals, and its files."""

import json
import random
import re
import signal
import socket
import sys
import time
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import pytest

from command_line import Shell
from sender import CONFIGURATION, Viewer, csv, ended, estimated, free_port, messages, running
from sigmahat.live.endpoints import Endpoints
from sigmahat.live.live_joint import Estimated
from sigmahat.live.loop import Inbox
from sigmahat.live.session import Session
from sigmahat.recording.readers.formats import open_log

NO_DATA = "no data for X s; does the sender run?"

needs_signals = pytest.mark.skipif(sys.platform == "win32", reason="Windows has no SIGINT")


def nested(message: dict[str, Any]) -> bytes:
    motor, link, torque = (message[f"arm/{name}"] for name in ("motor", "link[0]", "torque"))
    arm = {"motor": motor, "link": [link], "torque": torque}
    return json.dumps({"t": message["t"], "arm": arm}).encode()


def untimed(text: str) -> str:
    """A text without its durations, which are not exact in real time."""
    return re.sub(r"\b[\d.]+ s\b", "X s", text)


def recorded(folder: Path) -> Path:
    (recording,) = (folder / "out").glob("*.csv")
    return recording


def send(port: int, datagrams: Sequence[bytes]) -> None:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sender:
        for each in datagrams:
            sender.sendto(each, ("127.0.0.1", port))
            time.sleep(5e-4)


@needs_signals
def test_datagrams_in_and_out_and_any_others_between_them(tmp_path: Path) -> None:
    """THEN estimates and recording contain only the good messages."""
    noise = random.Random(7)
    port, viewer = free_port(), Viewer()
    alone = messages(1000)
    good = [nested(each) for each in alone]
    sent = []
    for i, each in enumerate(good):
        sent.append(each)
        fuzz = [
            noise.randbytes(noise.randrange(2000)),
            each[: noise.randrange(len(each))],
            good[noise.randrange(max(i - 300, 0), i + 1)],
            nested({**alone[0], "t": noise.choice([-1e9, 1e9, 1e300])}),
            b'{"t": NaN, "arm": {"motor": 1}}',
            b"[" * 60_000,
        ]
        sent += noise.sample(fuzz, noise.randrange(3))
    with running(tmp_path, "--from", f"udp:{port}", "--to", f"udp:{viewer.port}") as process:
        send(port, sent)
        received = [viewer.next() for _ in good]
        out, err = ended(process, signal.SIGTERM)
    assert err.count("a message that cannot be read") == 1
    counted = out.splitlines()[0]
    assert all(each in counted for each in ("not readable", "late", "far off in time"))
    recording = recorded(tmp_path)
    assert f"sigmahat estimate {Path('out', recording.name)} --config" in out
    series = estimated(recording)
    assert [each["timestamp"] for each in received] == pytest.approx([each["t"] for each in alone])
    assert [each["joint"]["doubt"] for each in received] == series["doubt"].tolist()
    found = [each["joint"]["sigma"] for each in received]
    session = Session(tmp_path / "arm.toml", tmp_path)
    news = [new for each in alone for new in session.take(each, 0)] + session.close()
    ticks = [each for each in news if isinstance(each, Estimated)]
    assert found == series["sigma"].tolist() == [tick.outputs["sigma"] for tick in ticks]


@needs_signals
def test_senders_over_tcp_come_and_go(tmp_path: Path) -> None:
    port = free_port()
    names, *lines = csv(messages(1000))
    with running(tmp_path, "--from", f"tcp:{port}") as process:
        for part in (lines[:500], lines[500:]):
            with socket.create_connection(("127.0.0.1", port)) as sender:
                sender.sendall("".join(f"{line}\n" for line in [names, *part]).encode())
            time.sleep(1.0)
        out, _ = ended(process)
    assert "messages: 1002 read" in out
    assert open_log(recorded(tmp_path)).samples("t") == 1000


def test_standard_input_ends_the_command(tmp_path: Path) -> None:
    sent = "".join(nested(each).decode() + "\n" for each in messages(100))
    with running(tmp_path, "--from", "stdin") as process:
        out, _ = process.communicate(sent, timeout=60)
    assert out.startswith("messages: 100 read\n")
    assert process.returncode == 0


def test_messages_of_which_none_can_be_read_are_an_error(tmp_path: Path) -> None:
    with running(tmp_path, "--from", "stdin") as process:
        _, error = process.communicate("0.0,1.0,2.0\n0.1,1.0,2.0\n", timeout=60)
    assert process.returncode != 0
    assert re.search("none of .* messages could be read; expected .* --columns", error)


def test_a_replayed_log_takes_its_time(tmp_path: Path) -> None:
    log = tmp_path / "arm.csv"
    log.write_text("\n".join(csv(messages(1000))) + "\n")
    viewer = Viewer()
    with running(tmp_path, "--replay", "arm.csv", "--to", f"udp:{viewer.port}") as process:
        received = [viewer.next() for _ in range(100)]
        begin = time.monotonic()
        received += [viewer.next() for _ in range(900)]
        took = time.monotonic() - begin
        process.communicate(timeout=60)
    assert took > 0.9 * 1.8
    log.with_suffix(".toml").write_text(CONFIGURATION)
    assert [each["joint"]["sigma"] for each in received] == estimated(log)["sigma"].tolist()


@needs_signals
def test_a_sender_that_dies_is_said_by_the_terminal_and_the_sink(tmp_path: Path) -> None:
    port, viewer = free_port(), Viewer()
    with running(tmp_path, "--from", f"udp:{port}", "--to", f"udp:{viewer.port}") as process:
        send(port, [nested(each) for each in messages(1000)])
        while viewer.next()["timestamp"] < 999 * 0.002 - 1e-6:
            pass
        silent = [viewer.silent.get(timeout=10) for _ in range(4)]
        event = viewer.events.get(timeout=10)
        _, err = ended(process)
    for each in silent:
        joint = each["joint"]
        assert (joint["confident"], joint["doubt"]) == (False, "NoData")
        assert each["timestamp"] == pytest.approx(1.998 + joint["data_age"], abs=0.5)
    assert silent[-1]["joint"]["data_age"] > 1.5
    assert (event["kind"], untimed(event["text"])) == ("no_data", NO_DATA)
    assert untimed(err).count(NO_DATA) == 1


def test_a_replay_says_what_a_stream_would(tmp_path: Path) -> None:
    """The field is lost for 0.8 s, then all data are for 0.7 s."""
    sent = messages(2500)
    for each in sent[500:900]:
        each["arm/link[0]"] = float("nan")
    (tmp_path / "arm.csv").write_text("\n".join(csv([*sent[:1500], *sent[1850:]])) + "\n")
    viewer = Viewer()
    with running(tmp_path, "--replay", "arm.csv", "--to", f"udp:{viewer.port}") as process:
        _, err = process.communicate(timeout=60)
    lines = untimed(err).splitlines()
    expected = [
        "no 'arm/link[0]' for X s, while messages arrive",
        "'arm/link[0]' again",
        NO_DATA,
        "data again, after X s without",
    ]
    assert [each for each in lines if each in expected] == expected
    events = [viewer.events.get(timeout=10)["text"] for _ in expected]
    assert list(map(untimed, events)) == expected
    assert not viewer.silent.empty()


def test_a_source_that_fails_ends_the_command_with_its_reason(
    shell: Shell, monkeypatch: pytest.MonkeyPatch
) -> None:
    def no_handles(inbox: Inbox) -> None:
        raise OSError(24, "Too many open files")

    Path("arm.toml").write_text(CONFIGURATION)
    monkeypatch.setattr(Endpoints, "source", lambda *_: no_handles)
    shell.run("live arm.toml --out out --from tcp:9", status=2)
    expected = "the messages from tcp:9 have ended: [Errno 24] Too many open files"
    assert shell.err.splitlines()[-1] == f"sigmahat: error: {expected}"


@pytest.mark.parametrize(
    ("options", "expected"),
    [
        ("--from serial:1", "--from: expected udp:PORT, tcp:PORT, stdin or ros2, got 'serial:1'"),
        ("--from udp:70000", "--from: expected a port from 1 to 65535, got '70000'"),
        (
            "--to tcp:1",
            "--to: expected udp:PORT, udp:HOST:PORT, foxglove[:PORT] or ros2, got 'tcp:1'",
        ),
        ("--columns t,x", "--columns lacks arm/motor"),
        ("--host 203.0.113.1", "cannot listen at 203.0.113.1, udp:9870:"),
        ("--replay none.csv", "none.csv: No such file or directory"),
        ("--replay short.csv", "short.csv: unknown column 'arm/motor'"),
        ("--start-from none", "none: No such file or directory; name the folder"),
    ],
)
def test_wrong_arguments_are_said(options: str, expected: str, shell: Shell) -> None:
    Path("arm.toml").write_text(CONFIGURATION)
    Path("short.csv").write_text("t,x\n0,1\n1,2\n")
    assert expected in shell.refused(f"live arm.toml --out out {options}")
    assert not Path("out").exists()
