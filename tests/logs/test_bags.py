"""ROS 2 bags, written and read without a ROS installation."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from rosbags.rosbag2 import StoragePlugin, Writer
from rosbags.typesys import Stores, get_typestore

from recorded_logs import read_estimate
from sigmahat.cli import main
from sigmahat.logs.readers.formats import open_log

T = 1e-3
N = 3000
START = 1_700_000_000_000_000_000


def signals() -> dict[str, np.ndarray]:
    t = T * np.arange(N)
    theta = np.sin(5 * t)
    return {"theta": theta, "q": theta + 2e-3 * np.sin(7 * t), "tau": 0.2 * np.cos(5 * t)}


def write_bag(path: Path, storage: StoragePlugin) -> None:
    """A sensor_msgs/JointState every ms, and the torque as std_msgs/Float64."""
    store = get_typestore(Stores.ROS2_HUMBLE)
    kinds = store.types
    joint, number = "sensor_msgs/msg/JointState", "std_msgs/msg/Float64"
    values = signals()
    with Writer(path, version=9, storage_plugin=storage) as writer:
        states = writer.add_connection("/joint_states", joint, typestore=store)
        torque = writer.add_connection("/drive/torque", number, typestore=store)
        for k in range(N):
            now = START + k * 1_000_000
            stamp = kinds["builtin_interfaces/msg/Time"](now // 10**9, now % 10**9)
            message = kinds[joint](
                kinds["std_msgs/msg/Header"](stamp, "base"),
                ["motor", "link"],
                np.array([values["theta"][k], values["q"][k]]),
                np.array([]),
                np.array([]),
            )
            writer.write(states, now + 300, store.serialize_cdr(message, joint))
            data = store.serialize_cdr(kinds[number](float(values["tau"][k])), number)
            writer.write(torque, now, data)


CONFIGURATION = """
[time]
column = "/joint_states.time"
[ports.theta]
column = "/joint_states.position[motor]"
[ports.q]
column = "/joint_states.position[link]"
[ports.tau]
column = "/drive/torque.data"
time = "/drive/torque.time"
[parameters]
samplePeriod = 0.001
rls.m = 1
"""


@pytest.mark.parametrize("storage", [StoragePlugin.MCAP, StoragePlugin.SQLITE3])
def test_bag(storage: StoragePlugin, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    write_bag(Path("bag"), storage)
    log = open_log(Path("bag"))
    values = signals()
    assert np.array_equal(log.read("/joint_states.position[link]"), values["q"])
    assert np.array_equal(log.read("/drive/torque.data"), values["tau"])
    assert log.read("/joint_states.time")[-1] - log.read("/joint_states.time")[0] == pytest.approx(
        (N - 1) * T, abs=1e-9
    )
    Path("bag.toml").write_text(CONFIGURATION)
    assert main(["estimate", "bag"]) == 0
    phi = read_estimate(Path("sigmahat-results/bag"))["estimate.phi [rad]"].to_numpy()
    assert np.array_equal(phi, (values["q"] - values["theta"]).astype(np.float32))


def test_one_mcap_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    write_bag(Path("bag"), StoragePlugin.MCAP)
    (file,) = Path("bag").glob("*.mcap")
    assert np.array_equal(open_log(file).read("/drive/torque.data"), signals()["tau"])
    assert main(["init", str(file), "--config", "one.toml"]) == 0
    text = Path("one.toml").read_text()
    assert 'column = "/joint_states.position[motor]"' in text
    assert 'time = "/drive/torque.time"' in text


def test_bag_cut_in_the_middle(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    write_bag(Path("bag"), StoragePlugin.MCAP)
    (file,) = Path("bag").glob("*.mcap")
    file.write_bytes(file.read_bytes()[: file.stat().st_size // 2])
    Path("bag.toml").write_text(CONFIGURATION)
    assert main(["estimate", "bag"]) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert "not a whole ROS 2 bag" in line
