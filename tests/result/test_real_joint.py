"""The torque and the stiffness of a real joint, estimated from its log.

The requirements were chosen after a first look at the data: see docs/real-joint.md.
"""

from pathlib import Path

import numpy as np
import pytest

import real_joint
from real_joint import SETTINGS, Log, M, N
from shared_data import data_folder
from sigmahat import Estimator
from sigmahat.checks.check import check
from sigmahat.fmi.model import Value
from sigmahat.recording.configuration import Configuration, Port, Time
from sigmahat.recording.readers.formats import open_log

Joint = tuple[list[Log], Estimator, Estimator]


@pytest.fixture(scope="module")
def data() -> Path:
    return data_folder("desr", "desr_x00.csv")


@pytest.fixture(scope="module")
def joint(data: Path) -> Joint:
    """The logs, and the estimators after them with a general and with an odd polynomial."""
    measured = real_joint.logs(data)
    general, odd = (real_joint.replay(measured, symmetric) for symmetric in (False, True))
    return measured, general, odd


def test_the_general_basis_fits_the_torque_the_odd_one_does_not(joint: Joint) -> None:
    measured, general, odd = joint
    assert [log.setting for log in measured] == list(SETTINGS)
    assert max(log.rms(general) for log in measured) <= 4.5
    for log in measured:
        assert 6.2 < log.rms(odd) < 9.0
        assert log.rms(general) < 0.5 * log.rms(odd)


def test_the_recursion_ends_at_the_batch_fit(joint: Joint) -> None:
    measured, general, _ = joint
    # THEN scaled linear least squares over all samples give the same curve as the recursion.
    unit_phi, unit_l = 0.2, 45.0
    settings = [(log.setting / unit_l) ** np.arange(M) for log in measured]
    powers = [(log.phi[:, None] / unit_phi) ** np.arange(N) for log in measured]
    F = np.concatenate([np.kron(s, p) for s, p in zip(settings, powers, strict=True)])
    solution = np.linalg.lstsq(F, np.concatenate([log.torque for log in measured]), rcond=None)[0]
    ends = np.cumsum([len(log.phi) for log in measured])
    for log, batch in zip(measured, np.split(F @ solution, ends[:-1]), strict=True):
        difference = general.evaluate(log.phi, log.setting)["tau_e"] - batch
        assert np.max(np.abs(difference)) < 1e-4 * np.ptp(log.torque)


def test_a_setting_left_out_is_predicted(joint: Joint) -> None:
    left_out = real_joint.leave_one_out(joint[0])
    print(real_joint.torque_table(*joint, left_out))
    assert list(left_out) == [10, 25, 33, 35]
    assert max(left_out.values()) <= 4.5


def test_stiffness_is_the_slope_of_the_measured_curve(joint: Joint) -> None:
    measured, general, odd = joint
    # The tested windows of +-0.05 to +-0.06 rad were chosen after a look at the data.
    print(real_joint.stiffness_table(*joint))
    for half_width in (0.05, 0.055, 0.06):
        assert real_joint.worst(measured, general, half_width) <= 10.0
    assert real_joint.worst(measured, odd, real_joint.HALF_WIDTH) > 50.0


def test_filtered_regression_is_no_worse(joint: Joint) -> None:
    measured, general, _ = joint
    regression = real_joint.replay(measured, False, real_joint.SPRING_ALONE)
    for log in measured:
        assert log.rms(regression) <= 1.001 * log.rms(general)
    worst, of_general = (
        real_joint.worst(measured, fit, real_joint.HALF_WIDTH) for fit in (regression, general)
    )
    assert worst <= 1.002 * of_general


def test_filtered_regression_claims_what_it_knows(joint: Joint) -> None:
    """The joint has a hysteresis of several N.m. With columns for model errors, the torque is
    hardly less accurate, and the interval contains the slope of the mean curve."""
    measured, general, _ = joint
    fit = real_joint.replay(measured, False, real_joint.FILTERED_REGRESSION)
    found = [log.rms(fit) for log in measured]
    of_general = [log.rms(general) for log in measured]
    assert np.mean(found) <= 1.1 * np.mean(of_general)
    assert np.all(np.array(found) <= 1.4 * np.array(of_general))
    assert real_joint.coverage(measured, fit) >= 90.0


def test_check_finds_nothing_wrong_in_a_right_setup(data: Path) -> None:
    """The column theta of this test bench is the deflection of the bench, computed from torque."""
    ports = {
        "theta": Port("torque_Nm", scale=1 / real_joint.DYNAMOMETER),
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
