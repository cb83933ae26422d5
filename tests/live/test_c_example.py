"""The loop in C: it estimates, and sends what `sigmahat live` would."""

import json
import re
import socket
import subprocess
import sys
from contextlib import suppress
from pathlib import Path

import pytest

from controllers import HOST, cross_build

STIFFNESS = 600.0  # of robot.c [N.m/rad]

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="it needs timerfd")


@pytest.fixture(scope="module")
def program(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return cross_build("examples/live", HOST, "double", tmp_path_factory.mktemp("live")) / "live"


def test_every_sample_is_sent(program: Path) -> None:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as viewer:
        viewer.bind(("127.0.0.1", 0))
        viewer.settimeout(1)
        port = viewer.getsockname()[1]
        running = subprocess.Popen(
            [program, "3", str(port)], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
        )
        received = []
        with suppress(TimeoutError):  # after the last one
            while True:
                received.append(json.loads(viewer.recv(4096)))
        printed, _ = running.communicate(timeout=10)
    assert running.returncode == 0
    found = re.search(r"(\d+) of 3000 samples missed; stiffness (\S+) \+- (\S+) N.m/rad", printed)
    assert found is not None, printed
    assert len(received) == 3000 - int(found[1])
    estimate = received[-1]["joint"]
    assert abs(estimate["sigma"] - STIFFNESS) < 1.96 * estimate["sigma_std"]
    assert estimate["confident"] is True


def test_wrong_arguments_are_said(program: Path) -> None:
    for arguments in (["0"], ["nan"], ["1", "0"], ["1", "70000"]):
        done = subprocess.run([program, *arguments], capture_output=True, text=True)
        assert done.returncode == 2
        assert "expected live [SECONDS [PORT]]" in done.stderr
