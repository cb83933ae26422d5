"""Logs in ROS 2 bags, which are written and read without a ROS installation."""

from pathlib import Path

import numpy as np
import pytest
from rosbags.rosbag2 import StoragePlugin, Writer
from rosbags.typesys import Stores, get_typestore

from command_line import Shell
from recorded_logs import STORED, read_estimate
from sigmahat.recording.readers.formats import open_log

T = 1e-3
N = 3000
START = 1_700_000_000_000_000_000
CONFIGURATION = """
time.column = "/joint_states.time"
[ports]
theta.column = "/joint_states.position[motor]"
q.column = "/joint_states.position[link]"
tau = {column = "/drive/torque.data", time = "/drive/torque.time"}
[parameters]
samplePeriod = 0.001
rls.m = 1
"""


def signals() -> dict[str, np.ndarray]:
    t = T * np.arange(N)
    theta = np.sin(5 * t)
    return {"theta": theta, "q": theta + 2e-3 * np.sin(7 * t), "tau": 0.2 * np.cos(5 * t)}


def write_bag(storage: StoragePlugin) -> None:
    """Writes a bag with a sensor_msgs/JointState every ms and the torque as std_msgs/Float64."""
    store = get_typestore(Stores.ROS2_HUMBLE)
    joint, number = "sensor_msgs/msg/JointState", "std_msgs/msg/Float64"
    Time, Header, JointState, Float64 = (
        store.types[name]
        for name in ("builtin_interfaces/msg/Time", "std_msgs/msg/Header", joint, number)
    )
    none = np.array([])
    with Writer(Path("bag"), version=9, storage_plugin=storage) as writer:
        states = writer.add_connection("/joint_states", joint, typestore=store)
        torque = writer.add_connection("/drive/torque", number, typestore=store)
        for k, (theta, q, tau) in enumerate(zip(*signals().values(), strict=True)):
            now = START + k * 1_000_000
            header = Header(Time(now // 10**9, now % 10**9), "base")
            message = JointState(header, ["motor", "link"], np.array([theta, q]), none, none)
            writer.write(states, now + 300, store.serialize_cdr(message, joint))
            writer.write(torque, now, store.serialize_cdr(Float64(float(tau)), number))
    Path("bag.toml").write_text(CONFIGURATION)


@pytest.mark.parametrize("storage", [StoragePlugin.MCAP, StoragePlugin.SQLITE3])
def test_bag(storage: StoragePlugin, shell: Shell) -> None:
    write_bag(storage)
    log, values = open_log(Path("bag")), signals()
    assert np.array_equal(log.read("/joint_states.position[link]"), values["q"])
    assert np.array_equal(log.read("/drive/torque.data"), values["tau"])
    assert np.ptp(log.read("/joint_states.time")) == pytest.approx((N - 1) * T, abs=1e-9)
    shell.run("estimate bag")
    phi = read_estimate(Path("sigmahat-results/bag"))["estimate.phi [rad]"].to_numpy()
    np.testing.assert_allclose(phi, values["q"] - values["theta"], rtol=STORED, atol=0)


def test_one_mcap_file_whole_and_cut_in_the_middle(shell: Shell) -> None:
    write_bag(StoragePlugin.MCAP)
    (file,) = Path("bag").glob("*.mcap")
    assert np.array_equal(open_log(file).read("/drive/torque.data"), signals()["tau"])
    shell.run(f"init {file} --config one.toml")
    text = Path("one.toml").read_text()
    assert 'column = "/joint_states.position[motor]"' in text
    assert 'time = "/drive/torque.time"' in text
    file.write_bytes(file.read_bytes()[: file.stat().st_size // 2])
    assert "incomplete ROS 2 bag" in shell.refused("estimate bag")
