"""Events and silence in each kind of output."""

import io
import subprocess
import sys
import time
from threading import Thread

import pytest

from sender import Viewer, free_port
from sigmahat.live import terminal
from sigmahat.live.endpoints import _send_udp
from sigmahat.live.events import FieldsMissing, StiffnessChanged
from sigmahat.live.live_joint import GIVEN, Estimated
from sigmahat.live.loop import Inbox

OUTPUTS = {name: 1.0 for name in GIVEN} | {"confident": True, "valid": True, "doubt": "None"}
ESTIMATE = Estimated("elbow", 12.0, OUTPUTS)
SILENT = ESTIMATE.without_data(15.0, 3.0)
CHANGE = StiffnessChanged(t=12.5, joint="elbow", changed_at=12.3, relative=-0.3)


class Screen(io.StringIO):
    def isatty(self) -> bool:
        return True


def test_the_line_in_a_terminal(monkeypatch: pytest.MonkeyPatch) -> None:
    screen = Screen()
    monkeypatch.setattr(sys, "stderr", screen)
    monkeypatch.setattr(terminal, "_EVERY", -1.0)
    show = terminal.terminal()
    show([ESTIMATE])
    show([CHANGE])
    show([SILENT])
    first, second, third = screen.getvalue().split("\033[1F\033[J")
    assert first.endswith("confident  1 N.m at 1 rad\n")
    change, line = second.splitlines()
    assert change == "elbow: the stiffness changed by -30 % at 12.3 s"
    assert "  confident  " in line
    assert third.endswith("no data for 3 s\n")


def test_events_in_a_file_are_not_delayed(capsys: pytest.CaptureFixture[str]) -> None:
    show = terminal.terminal()
    show([ESTIMATE, CHANGE])
    assert capsys.readouterr().err == "elbow: the stiffness changed by -30 % at 12.3 s\n"


def test_datagrams() -> None:
    viewer = Viewer()
    send = _send_udp(("127.0.0.1", viewer.port))
    missing = FieldsMissing(t=1.0, fields=["a", "b"], messages=100, duration=None)
    send([ESTIMATE, CHANGE, SILENT, missing])
    assert viewer.next()["elbow"]["confident"] is True
    silent = viewer.silent.get(timeout=10)
    assert silent["timestamp"] == 15.0
    expected = {"confident": False, "valid": False, "doubt": "NoData", "data_age": 3.0}
    assert silent["elbow"].items() >= expected.items()
    change, missed = (viewer.events.get(timeout=10) for _ in range(2))
    assert change == {
        **{"kind": "stiffness_changed", "t": 12.5, "joint": "elbow", "changed_at": 12.3},
        **{"relative": -0.3, "text": "elbow: the stiffness changed by -30 % at 12.3 s"},
    }
    assert missed["fields"] == ["a", "b"]
    assert missed["duration"] is None


def test_foxglove_does_not_silence_warnings() -> None:
    pytest.importorskip("foxglove")
    program = (
        "import logging\n"
        "from sigmahat.live.foxglove_server import serve\n"
        f"serve(('127.0.0.1', {free_port()}), [])\n"
        "logging.getLogger('sigmahat').warning('this is seen')\n"
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True)
    assert done.returncode == 0
    assert done.stderr == "this is seen\n"


def test_diagnostics_of_ros_2() -> None:
    """Estimates and diagnostics of the sink, read in the same participant of DDS."""
    pytest.importorskip("cyclonedds")
    from cyclonedds.sub import DataReader
    from cyclonedds.topic import Topic

    from sigmahat.live import ros2

    ours = ros2.Ros2()
    readers = {}
    for name, kind in (
        (ros2.ESTIMATES, ros2._DynamicJointState),
        (ros2.DIAGNOSTICS, ros2._Diagnostics),
    ):
        topic = Topic(ours._domain, f"rt{name}", kind)
        readers[name] = DataReader(ours._domain, topic, qos=ros2._WHOLE)
    send = ours.publish()
    send([ESTIMATE, CHANGE])
    send([SILENT])
    estimates = readers[ros2.ESTIMATES].take(N=10)
    values = [dict(zip(each.interface_names, each.values, strict=True))
              for message in estimates for each in message.interface_values]  # fmt: skip
    assert [each["confident"] for each in values] == [1.0, 0.0]
    assert [each["data_age"] for each in values] == [0.0, 3.0]
    diagnostics = readers[ros2.DIAGNOSTICS].take(N=10)
    statuses = [status for message in diagnostics for status in message.status]
    said = [(each.level, each.name, each.message) for each in statuses]
    assert said == [
        (1, "sigmahat: events", "elbow: the stiffness changed by -30 % at 12.3 s"),
        (0, "sigmahat: stiffness of elbow", "confident"),
        (3, "sigmahat: stiffness of elbow", "no data for 3 s"),
    ]


def test_names_that_are_not_utf_8_do_not_stop_the_reader() -> None:
    pytest.importorskip("cyclonedds")
    from cyclonedds.pub import DataWriter
    from cyclonedds.topic import Topic

    from sigmahat.live import ros2

    ours = ros2.Ros2()
    inbox = Inbox()
    source = ours.joint_states(["/joint_states.time", "/joint_states.position[knee]"])
    Thread(target=source, args=[inbox], daemon=True).start()
    topic = Topic(ours._domain, "rt/joint_states", ros2._JointState)
    writer = DataWriter(ours._domain, topic, qos=ros2._WHOLE)
    for i in range(10):
        header = ros2._Header(ros2._Time(1 + i, 0), "")
        message = ros2._JointState(header, ["knee"], [0.5], [], [])
        if i in (3, 4):
            data = message.serialize().replace(b"knee", b"\xff\xfeee")
            message.serialize = lambda data=data, **_: data
        writer.write(message)
    found: list[float | str] = []
    until = time.monotonic() + 10
    while len(found) < 10 and time.monotonic() < until:
        try:
            columns = inbox.get(timeout=10).read()
            assert columns is not None
            found.append(columns["/joint_states.time"])
        except ValueError as error:
            found.append(str(error).split(",")[0])
    bad = "/joint_states: expected a JointState"
    assert found == [0.0, 1.0, 2.0, bad, bad, 5.0, 6.0, 7.0, 8.0, 9.0]
