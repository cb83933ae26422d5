"""Messages of a joint that moves a load, as a robot would send them, their configuration, and
`sigmahat live`, which receives them."""

import json
import math
import signal
import socket
import subprocess
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from queue import SimpleQueue
from threading import Thread
from typing import Any

import numpy as np

from sigmahat.recording.configuration import read_configuration
from sigmahat.recording.readers.formats import open_log
from sigmahat.result.estimate import estimate

T = 0.002
COUNTS, GEAR = 4096, 20

CONFIGURATION = f"""\
[time]
column = "t"
[ports.theta]
column = "arm/motor"
unit = "counts"
counts_per_turn = {COUNTS}
gear_ratio = {GEAR}
wrap = {COUNTS}
[ports.q]
column = "arm/link[0]"
unit = "deg"
sign = -1
zero = 2.5
[ports.tau]
column = "arm/torque"
[parameters]
method = "FilteredRegression"
samplePeriod = {T}
motor.gamma = {GEAR}
motor.B = 1e-3
motor.D_theta = 1e-2
range.phi = 0.06
prior.tau_e = 30
"""


def messages(
    samples: int, seed: int = 1, changed: tuple[float, float] = (math.inf, 1.0)
) -> list[dict[str, float | int]]:
    """Samples of a joint with 400 N.m/rad that moves a load, T apart.

    changed  time of a change of the stiffness [s], and the factor
    """
    noise = np.random.default_rng(seed)
    t = T * np.arange(samples)
    theta = 0.8 * np.sin(3 * t) + 0.2 * np.sin(11 * t)
    q = theta + 0.03 * np.sin(5 * t) + 0.02 * np.sin(13 * t)
    counts = np.round(theta * GEAR * COUNTS / (2 * np.pi)) % COUNTS
    speed = 2.4 * np.cos(3 * t) + 2.2 * np.cos(11 * t)
    acceleration = -7.2 * np.sin(3 * t) - 24.2 * np.sin(11 * t)
    stiffness = np.where(t < changed[0], 400.0, 400.0 * changed[1])
    torque = GEAR * (1e-3 * acceleration + 1e-2 * speed) + stiffness * (theta - q) / GEAR
    torque += noise.normal(0, 3e-3, samples)
    names = ("t", "arm/motor", "arm/link[0]", "arm/torque")
    rows = np.column_stack([t, counts, 2.5 - np.degrees(q), torque]).tolist()
    return [dict(zip(names, row, strict=True)) for row in rows]


class Viewer:
    """Receives estimates, in a thread, since the system keeps few datagrams."""

    def __init__(self) -> None:
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        # As much as the system allows: a busy machine does not run this thread for a while.
        self._socket.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 1 << 22)
        self._socket.bind(("127.0.0.1", 0))
        self.port = int(self._socket.getsockname()[1])
        self.received: SimpleQueue[Any] = SimpleQueue()  # estimates of ticks
        self.silent: SimpleQueue[Any] = SimpleQueue()  # messages of joints without data
        self.events: SimpleQueue[Any] = SimpleQueue()
        Thread(target=self._receive, daemon=True).start()

    def _receive(self) -> None:
        while True:
            message = json.loads(self._socket.recv(65536))
            joints = [each for each in message.values() if isinstance(each, dict)]
            if "event" in message:
                self.events.put(message["event"])
            elif any(each.get("doubt") == "NoData" for each in joints):
                self.silent.put(message)
            else:
                self.received.put(message)

    def next(self) -> Any:
        return self.received.get(timeout=10)


def free_port() -> int:
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return int(probe.getsockname()[1])


def of_joints(names: Sequence[str], prefixes: Sequence[str] | None = None) -> str:
    """A configuration of several joints; prefix of the columns of each, by default "arm/"."""
    ports = CONFIGURATION[CONFIGURATION.index("[ports") : CONFIGURATION.index("[parameters]")]
    return CONFIGURATION.replace(ports, "") + "".join(
        ports.replace("[ports", f"[joints.{name}.ports").replace("arm/", prefix)
        for name, prefix in zip(names, prefixes or ["arm/"] * len(names), strict=True)
    )


def csv(sent: Sequence[dict[str, float | int]]) -> list[str]:
    """Lines of a CSV file: names, then messages."""
    return [",".join(sent[0]), *(",".join(map(repr, each.values())) for each in sent)]


def estimated(recording: Path, start: Path | None = None, joint: str = "") -> Any:
    """The outputs that `estimate` finds in a recording, with the configuration beside it."""
    configuration = read_configuration(recording.with_suffix(".toml"), joint)
    return estimate(open_log(recording), configuration, start_from=start).series


@contextmanager
def running(
    folder: Path, *options: str, text: str = CONFIGURATION, inside: Sequence[str] = ()
) -> Iterator[subprocess.Popen[str]]:
    """The command, which waits for messages, and writes to "out" in its folder.

    inside  the command that runs it
    """
    (folder / "arm.toml").write_text(text)
    command = [*inside, sys.executable, "-m", "sigmahat", "live", "arm.toml", *options]
    pipe = subprocess.PIPE
    with subprocess.Popen(
        [*command, "--out", "out"], cwd=folder, stdin=pipe, stdout=pipe, stderr=pipe, text=True
    ) as process:
        try:
            assert process.stderr is not None
            assert "Ctrl-C ends it" in process.stderr.readline()
            yield process
        finally:
            process.kill()


def ended(process: subprocess.Popen[str], number: int = signal.SIGINT) -> tuple[str, str]:
    """Output of the command after a signal."""
    process.send_signal(number)
    out, err = process.communicate(timeout=60)
    assert process.returncode == 0, err
    return out, err
