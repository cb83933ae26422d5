"""The loop in C: it estimates, and sends what `sigmahat live` would."""

import re
import subprocess
import sys
from pathlib import Path

import pytest

from controllers import HOST, cross_build, run
from sender import Viewer

STIFFNESS = 600.0  # of robot.c [N.m/rad]

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="it needs timerfd")


@pytest.fixture(scope="module")
def program(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return cross_build("examples/live", HOST, "double", tmp_path_factory.mktemp("live")) / "live"


def test_every_sample_is_sent(program: Path) -> None:
    viewer = Viewer()
    printed = run(program, "3", str(viewer.port))
    found = re.search(r"(\d+) of 3000 samples missed; stiffness (\S+) \+- (\S+) N.m/rad", printed)
    assert found is not None, printed
    received = [viewer.next() for _ in range(3000 - int(found[1]))]
    assert viewer.received.empty()
    estimate = received[-1]["joint"]
    assert abs(estimate["sigma"] - STIFFNESS) < 1.96 * estimate["sigma_std"]
    assert estimate["confident"] is True


def test_wrong_arguments_are_said(program: Path) -> None:
    for arguments in (["0"], ["nan"], ["1", "0"], ["1", "70000"]):
        done = subprocess.run([program, *arguments], capture_output=True, text=True)
        assert done.returncode == 2
        assert "expected live [SECONDS [PORT]]" in done.stderr
