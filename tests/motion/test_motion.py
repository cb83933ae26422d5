"""The motion that `sigmahat motion` proposes: its limits, files, C code and expected accuracy."""

from collections.abc import Callable, Iterator
from dataclasses import replace
from io import StringIO
from pathlib import Path

import numpy as np
import pytest
import tomlkit
import yaml
from scipy.integrate import solve_ivp

from controllers import run
from recorded_logs import configured, in_memory
from sigmahat.cli import main
from sigmahat.motion import known
from sigmahat.motion.design import Sensors, _log, compared_half_width, design, relative_half_width
from sigmahat.motion.joints_of_log import Joint, Limits, Multisine, Ranges, of_limits
from sigmahat.motor.identify import identify
from sigmahat.motor.write import update
from sigmahat.recording.log import LogError

LIMITS = Limits(angle=0.8, velocity=1.5, torque=60.0, deformation=0.03)
OPTIONS = "--angle 0.8 --velocity 1.5 --torque 60 --deformation 0.03"
JOINT = Joint(k=3000, M=6, D_q=0.3, weight=8, angle=1, B=2, D_theta=3, tau_coulomb=2)
MOTION = Multisine([0.1, 0.06, 0.03], [0.4, 0.65, 1.1], [0.0, 1.0, 2.0], 20.0, 2.0)
SENSORS = Sensors(gear_ratio=100, counts=(4e5, 4e5), torque_gain=0.02, noise=0.2, T=2e-3)


def test_velocity_and_acceleration_are_the_derivatives() -> None:
    t = MOTION.times(1e-4)
    position, velocity, acceleration = MOTION.at(t)
    np.testing.assert_allclose(np.gradient(position, t)[1:-1], velocity[1:-1], atol=1e-6)
    np.testing.assert_allclose(np.gradient(velocity, t)[1:-1], acceleration[1:-1], atol=1e-5)
    for each in (position, velocity, acceleration):
        assert each[0] == 0 and abs(each[-1]) < 1e-12


def test_a_joint_moves_as_a_solver_says() -> None:
    T = 2e-3
    theta, velocity, acceleration = MOTION.at(MOTION.times(T))
    phi, tau = JOINT.respond(theta, velocity, acceleration, T)
    c = 0.02 * 2 * np.sqrt(JOINT.k * JOINT.M)

    def derivatives(t: float, x: np.ndarray) -> list[float]:
        (position,), (velocity,), (acceleration,) = MOTION.at(np.array([t]))
        load = JOINT.M * acceleration + JOINT.D_q * velocity
        load += JOINT.weight * np.sin(JOINT.angle + position)
        return [x[1], (-load - JOINT.k * x[0] - (JOINT.D_q + c) * x[1]) / JOINT.M]

    start = [-JOINT.weight * np.sin(JOINT.angle) / JOINT.k, 0.0]
    t = MOTION.times(T)[:3000]
    solved = solve_ivp(derivatives, (0, 6), start, "Radau", t, rtol=1e-8, atol=1e-11)
    np.testing.assert_allclose(phi[:3000], solved.y[0], atol=2e-5 * np.abs(phi).max())
    friction = JOINT.D_theta * velocity + JOINT.tau_coulomb * np.tanh(velocity / 1e-3)
    np.testing.assert_allclose(tau, JOINT.B * acceleration + friction - JOINT.k * phi)


@pytest.fixture(scope="module")
def written(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Folder with the files of a motion that begins at 0.5 rad."""
    folder = tmp_path_factory.mktemp("motion")
    more = ["--seconds", "20", "--start", "0.5", "--out", str(folder), "--quiet"]
    corners = Ranges.corners

    def most_friction(of: Ranges) -> Iterator[Joint]:
        """Selects the corner joints with the largest inertia and friction of the motor."""
        most = (of.high.B, of.high.D_theta, of.high.tau_coulomb)
        return (each for each in corners(of) if (each.B, each.D_theta, each.tau_coulomb) == most)

    with pytest.MonkeyPatch.context() as patch:  # few motions and joints
        patch.setattr(Ranges, "corners", most_friction)
        spread = "sigmahat.experiments.pool.spread"
        patch.setattr(spread, lambda jobs, _: ((i, job()) for i, job in enumerate(jobs)))
        fewer = {"_OF_RESONANCE": (0.3, 0.5), "_EXPONENTS": (1.0,), "_COMPARED": 1, "_PROMISED": 1}
        for name, value in fewer.items():
            patch.setattr(f"sigmahat.motion.design.{name}", value)
        assert main(["motion", *OPTIONS.split(), *more]) == 0
    return folder


@pytest.fixture(scope="module")
def rows(written: Path) -> np.ndarray:
    return np.loadtxt(written / "motion.csv", delimiter=",", skiprows=1)


@pytest.mark.slow("a log is identified and estimated, to predict the result")
def test_the_csv_begins_and_ends_at_rest_and_keeps_the_limits(rows: np.ndarray) -> None:
    t, position, velocity, acceleration = rows.T
    np.testing.assert_allclose(np.diff(t), 1e-3)
    for end in (0, -1):
        assert position[end] == pytest.approx(0.5)
        assert abs(velocity[end]) < 1e-9 and abs(acceleration[end]) < 1e-9
    assert np.abs(position - 0.5).max() <= LIMITS.angle
    assert np.abs(velocity).max() <= LIMITS.velocity
    for joint in of_limits(LIMITS).draw(300, np.random.default_rng(4)):
        load = joint.M * acceleration + joint.D_q * velocity
        load += joint.weight * np.sin(joint.angle + position - 0.5)
        # Below the resonance, the torque of the spring hardly exceeds the torque of the load.
        assert np.abs(load).max() / joint.k <= LIMITS.deformation
        torque = joint.B * acceleration + joint.D_theta * velocity + load
        assert np.abs(torque).max() + joint.tau_coulomb <= LIMITS.torque


def test_the_c_code_and_the_trajectory_for_ros_are_the_csv(
    written: Path, rows: np.ndarray, tmp_path: Path
) -> None:
    program = tmp_path / "program.c"
    program.write_text(
        "#include <stdio.h>\nvoid motion(double, double *, double *, double *);\n"
        "int main(void) { double p, v, a; for (int k = 0; k <= 20000; k++) {"
        'motion(k * 1e-3, &p, &v, &a); printf("%.17g %.17g %.17g\\n", p, v, a); } return 0; }\n'
    )
    flags = ["-std=c99", "-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Werror"]
    binary = tmp_path / "program"
    run("cc", *flags, program, written / "motion.c", "-o", binary, "-lm")
    np.testing.assert_allclose(np.loadtxt(StringIO(run(binary))), rows[:, 1:], atol=1e-9)

    trajectory = yaml.safe_load((written / "motion.yaml").read_text())
    assert trajectory["joint_names"] == ["joint"]
    points = trajectory["points"]
    times = [p["time_from_start"]["sec"] + p["time_from_start"]["nanosec"] / 1e9 for p in points]
    np.testing.assert_allclose(times, rows[::10, 0], atol=1e-9)
    for column, key in ((1, "positions"), (2, "velocities"), (3, "accelerations")):
        np.testing.assert_allclose([p[key][0] for p in points], rows[::10, column], atol=1e-7)


def test_what_a_log_says_contains_the_joint() -> None:
    encoders = ("encoder.theta = 4e5", "encoder.q = 4e5")
    text = configured("motor.gamma = 100", "samplePeriod = 2e-3", *encoders)
    text = text.replace('time.column = "t"\n', "")
    log, document = _log(JOINT, MOTION, SENSORS), tomlkit.parse(text)
    update(document, identify(log, in_memory(text)))
    found = known.of_log(log, in_memory(tomlkit.dumps(document)), start=0.0)
    for name in ("k", "M", "weight", "B", "tau_coulomb"):
        low, true, high = (getattr(each, name) for each in (found.low, JOINT, found.high))
        assert low <= true <= high, name
    assert found.low.angle == pytest.approx(JOINT.angle, abs=0.1)


@pytest.mark.parametrize("half_width", [relative_half_width, compared_half_width])
def test_a_motion_that_is_larger_promises_more(
    half_width: Callable[[Joint, Multisine, Sensors], float],
) -> None:
    small, large = (half_width(JOINT, MOTION.scaled(f), SENSORS) for f in (0.2, 1.0))
    assert 1.96 * SENSORS.torque_gain * 0.99 < large < small  # no motion reveals the gain


def test_limits_that_the_weight_takes_are_named() -> None:
    heavy = Ranges(JOINT, replace(JOINT, weight=80))
    with pytest.raises(LogError, match=r"weight and friction alone need up to 82 N\.m"):
        design(heavy, LIMITS, SENSORS, 20.0)


def test_joints_of_limits_and_corners() -> None:
    joints = of_limits(LIMITS)
    assert joints.low.k * LIMITS.deformation == pytest.approx(LIMITS.torque)
    for joint in joints.draw(50, np.random.default_rng(1)):
        assert all(vars(joints.low)[n] <= v <= vars(joints.high)[n] for n, v in vars(joint).items())
    only = Ranges(JOINT, replace(JOINT, k=2 * JOINT.k))
    assert {each.k for each in only.corners()} == {JOINT.k, 2 * JOINT.k}
