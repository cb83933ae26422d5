"""A robot of another implementation of ROS 2 and DDS: RustDDS with ros2-client.

Robot and estimator run in a separate network. Robot and estimator find each other by multicast on
the loopback device.
"""

import subprocess
import sys
import time
from collections import defaultdict
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from gate import missing, need
from sender import CONFIGURATION, ended, estimated, messages, running

FIRST = 1_700_000_000_000_000_000  # [ns] since 1970
NETWORK = (
    "ip link set lo up && ip link set lo multicast on && ip route add 224.0.0.0/4 dev lo && "
    "echo ready && exec sleep 600"
)
ROS = CONFIGURATION
for before, after in {
    '"t"': '"/joint_states.time"',
    '"arm/motor"': '"/joint_states.position[arm_motor]"',
    '"arm/link[0]"': '"/joint_states.position[arm]"',
    '"arm/torque"': '"/joint_states.effort[arm_motor]"',
}.items():
    ROS = ROS.replace(before, after)


@pytest.fixture
def network() -> Iterator[list[str]]:
    """How a command is run in a network of its own."""
    unshare, nsenter = need("unshare"), need("nsenter")
    need("ip")
    own = [unshare, "--map-root-user", "--net", "sh", "-c", NETWORK]
    with subprocess.Popen(own, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as holder:
        assert holder.stdout is not None
        if holder.stdout.readline() != "ready\n":
            pytest.skip("no network of one's own may be made here")
        options = [f"--target={holder.pid}", "--user", "--net", "--preserve-credentials"]
        yield [nsenter, *options]
        holder.kill()


@pytest.mark.skipif(sys.platform != "linux", reason="networks of a process are Linux")
@pytest.mark.complete
@pytest.mark.slow("two programs find each other, and talk in real time")
@pytest.mark.parametrize("reliability", ["reliable", "best-effort"])
def test_joint_states_in_and_estimates_out(
    reliability: str, network: list[str], build: Path, tmp_path: Path
) -> None:
    robot = build / "checkers" / "bin" / "ros2-robot"
    if not robot.exists():
        missing("ros2-robot", ".ci/robot")
    received, pipe = tmp_path / "received", subprocess.PIPE
    command = [*network, str(robot), reliability, "arm_motor", "arm"]
    with (
        running(tmp_path, "--from", "ros2", "--to", "ros2", text=ROS, inside=network) as live,
        received.open("w") as written,
        subprocess.Popen(command, stdin=pipe, stdout=written, stderr=pipe, text=True) as ours,
    ):
        try:
            assert ours.stdin is not None and ours.stderr is not None
            assert ours.stderr.readline() == "somebody listens\n"
            time.sleep(0.5)
            for each in messages(1500):
                stamp = FIRST + round(each["t"] * 1e9)
                row = [each["arm/motor"], each["arm/torque"], each["arm/link[0]"], 0.0]
                ours.stdin.write(" ".join([str(stamp), *map(repr, row)]) + "\n")
                ours.stdin.flush()
                time.sleep(1e-3)
            ours.communicate(timeout=60)
            printed, _ = ended(live)
        finally:
            ours.kill()
    lines = defaultdict(list)
    for line in received.read_text().splitlines():
        kind, _, rest = line.partition(" ")
        lines[kind].append(rest.split())
    assert any(" ".join(each).startswith("0 sigmahat: stiffness of joint: confident") or
               each[0] == "1" for each in lines["diagnosis"])  # fmt: skip
    assert any(" ".join(each).startswith("3 sigmahat: stiffness of joint: no data for")
               for each in lines["diagnosis"])  # fmt: skip
    ages = [float(each[each.index("data_age") + 1]) for each in lines["estimate"]]
    with_data = [each for each, age in zip(lines["estimate"], ages, strict=True) if age == 0]
    assert len(with_data) < len(ages)
    (recording,) = (tmp_path / "out").glob("*.csv")
    found = estimated(recording)
    ticks = len(found.t)
    assert ticks == 1500 and "messages: 1500 read" in printed
    stamps = [int(each[0]) for each in with_data]
    np.testing.assert_allclose(np.array(stamps) - FIRST, 1e9 * found.t, atol=2)
    for name, output in (("stiffness", "sigma"), ("torque_std", "tau_e_std")):
        values = [float(each[each.index(name) + 1]) for each in with_data]
        assert values == found[output].tolist()
