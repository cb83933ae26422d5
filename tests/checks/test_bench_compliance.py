"""On a test bench theta may be the compliance of the bench, computed from the torque."""

from __future__ import annotations

from pathlib import Path

import pytest

import real_joint
from sigmahat.checks.check import check
from sigmahat.fmi.instance import Value
from sigmahat.logs.configuration import Configuration, Port, Time
from sigmahat.logs.readers.formats import open_log


def test_nothing_is_wrong_in_a_right_setup_of_the_ankle() -> None:
    try:
        data = real_joint.folder()
    except FileNotFoundError as error:
        pytest.skip(str(error))
    ports = {
        "theta": Port("torque_Nm", scale=8.00609748621252e-05),  # as in docs/real-joint.md
        "q": Port("angle_rad"),
        "tau_e_sensor": Port("torque_Nm", zero=-1.2),
    }
    parameters: dict[str, Value] = {
        **{"method": "FilteredRegression", "modality": "Sensor", "samplePeriod": 1.2e-3},
        **{"encoder.theta": 0.0, "encoder.q": 0.0},
    }
    configuration = Configuration(Path("desr.toml"), Time("time_s"), ports, parameters)
    for setting in (0, 10, 25, 33, 35, 45):
        assert not check(open_log(data / f"desr_x{setting:02d}.csv"), configuration).is_wrong
