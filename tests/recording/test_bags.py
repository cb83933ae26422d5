"""Logs in ROS 2 bags, which are written and read without a ROS installation."""

import struct
from pathlib import Path

import numpy as np
import pytest
from rosbags.rosbag2 import StoragePlugin, Writer
from rosbags.typesys import Stores, get_typestore

from command_line import Shell
from recorded_logs import STORED, read_estimate
from sigmahat.recording.log import LogError
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


def write_bag(storage: StoragePlugin, one_joint_each: bool = False) -> None:
    """Writes a bag with a sensor_msgs/JointState every ms and the torque as std_msgs/Float64.

    one_joint_each  the link comes in a message of its own, half a millisecond after the motor
    """
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
            parts = [(now, {"motor": theta, "link": q})]
            if one_joint_each:
                parts = [(now, {"motor": theta}), (now + 500_000, {"link": q})]
            for at, positions in parts:
                header = Header(Time(at // 10**9, at % 10**9), "base")
                angles = np.array([*positions.values()])
                message = JointState(header, [*positions], angles, none, none)
                writer.write(states, at + 300, store.serialize_cdr(message, joint))
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


def test_messages_with_one_joint_each(shell: Shell) -> None:
    """GIVEN motor and link in messages of their own, THEN each has its own samples and times."""
    write_bag(StoragePlugin.MCAP, one_joint_each=True)
    log, values = open_log(Path("bag")), signals()
    for port, name in (("theta", "motor"), ("q", "link")):
        column = log.read(f"/joint_states.position[{name}]")
        assert np.array_equal(column[~np.isnan(column)], values[port])
    shell.run("estimate bag")
    phi = read_estimate(Path("sigmahat-results/bag"))["estimate.phi [rad]"].to_numpy()
    t = T * np.arange(N)
    q = np.interp(t, t + 5e-4, values["q"])  # every second row is of the motor
    np.testing.assert_allclose(phi[::2][2:-2], (q - values["theta"])[2:-2], atol=2e-5)


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


def test_an_mcap_file_of_another_system_is_named(tmp_path: Path) -> None:
    header = struct.pack("<I", 0) + struct.pack("<I", 0)  # empty profile and library
    begin = b"\x89MCAP0\r\n" + struct.pack("<BQ", 1, len(header)) + header
    (tmp_path / "log.mcap").write_bytes(begin)
    with pytest.raises(LogError, match=r"not of ROS 2 \(its profile is ''"):
        open_log(tmp_path / "log.mcap")
