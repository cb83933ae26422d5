"""Section 12 of FilteredRegression: a stiffness that changes is noticed and followed."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from itertools import product
from typing import Any

import numpy as np
import pytest

from c_library import Array, Estimator, Library, compile_library
from regression_joint import D_THETA, SETTINGS, STIFFNESS, Joint, MisfitJoint, T

REGRESSION = {"method": 2, "rls.n": 3}
CHANGE = 9
AT = 15.0  # [s]
WRONG_MOTOR = {"motor.D_theta": 1.3e-3, "prior.B": 0.1}


@dataclass(frozen=True)
class FreeLoad(MisfitJoint):
    """The spring carries an inertia alone, so the deformation is proportional to the acceleration.

    Another inertia of the motor, and no spring, then explain a run with two stiffnesses.
    """

    duration: float = 30.0
    inertia: float = 0.1  # [kg.m2]

    @property
    def motion(self) -> tuple[Array, Array, Array, Array, Array]:
        theta, theta_dot, theta_ddot, _, r = super().motion
        phi = -self.inertia * theta_ddot / (STIFFNESS * self.stiffness(self.t))
        return theta, theta_dot, theta_ddot, phi, r


def step(factor: float, at: float = AT) -> Callable[[Array], Array]:
    return lambda t: np.where(t < at, 1.0, factor)


def fast_step(factor: float) -> Callable[[Array], Array]:
    """Within 20 ms, because the deformation of a free load, which follows, cannot jump."""
    return lambda t: 1.0 + (factor - 1.0) * np.clip((t - AT) / 0.02, 0.0, 1.0)


@pytest.mark.parametrize(
    ("factor", "frequency"), [(2.0, 0.5), (0.5, 0.5), (1.3, 1.0), (2.0, 3.0), (1.3, 3.0)]
)
def test_a_step_of_the_stiffness_is_followed(c: Library, frequency: float, factor: float) -> None:
    """GIVEN a stiffness that changes at 15 s, THEN this is detected. The estimate is hardly ever
    confident and wrong by 20 %. At the end, the estimate is right and confident, and the motor data
    have not changed.
    """
    joint = Joint(
        duration=30.0, frequency=frequency, amplitude=0.8 / frequency, stiffness=step(factor)
    )
    found = Estimator(c, REGRESSION).run(joint.measurements())
    age, error = found["change_age"], np.abs(found["sigma"] / joint.sigma - 1)
    later = joint.t >= AT
    assert np.all(age[~later] == -1)
    first = np.flatnonzero(age >= 0)[0]
    assert joint.t[first] - AT < 0.55
    assert age[first] == pytest.approx(0.0, abs=2 * T)
    assert found["doubt"][first] == CHANGE and not found["confident"][first]
    assert T * np.count_nonzero(found["confident"].astype(bool) & (error > 0.2)) < 1.0
    assert error[-1] < 0.1 and found["confident"][-1]
    assert abs(found["sigma"][-1] - joint.sigma[-1]) < 4 * found["sigma_std"][-1]
    assert found["D_theta_hat"][-1] == pytest.approx(1e-3, rel=0.05)


@pytest.mark.parametrize("factor", [2.0, 0.5])
@pytest.mark.parametrize("place", [0.0, 0.25, 0.5, 0.75])
def test_samples_of_the_changed_spring_do_not_spoil_the_motor(
    c: Library, place: float, factor: float
) -> None:
    """GIVEN a step anywhere in a block of 50 ms, and other misfits, THEN the stiffness is right
    again a second later, and soon confident."""
    stiffness = step(factor, AT + 0.05 * place)
    slow = Joint(duration=22.0, frequency=0.5, amplitude=1.6, stiffness=stiffness)
    joint = replace(slow, load_friction=0.03, delay=1e-3)
    found = Estimator(c, {**REGRESSION, "prior.B": 0.1}).run(joint.measurements())
    error = np.abs(found["sigma"] / joint.sigma - 1)
    assert np.max(error[joint.t > AT + 1.0]) < 0.1
    assert np.all(found["confident"][joint.t > AT + 1.2])
    assert found["B_hat"][-1] == pytest.approx(2.3e-5, rel=0.1)


def test_a_hypothesis_that_began_before_the_change_begins_anew(c: Library) -> None:
    """GIVEN noise that gives a little evidence just before the change (6 of 40 seeds).

    At the change, the hypothesis already contains data of the old spring. The hypothesis must not
    take the contradiction for another motor.
    """
    stiffness = step(2.0, AT + 0.02)
    joint = Joint(duration=22.0, frequency=0.5, amplitude=1.6, stiffness=stiffness, seed=37)
    joint = replace(joint, load_friction=0.03, delay=1e-3, hysteresis=0.1, noise=10**-2.2)
    found = Estimator(c, {**REGRESSION, "prior.B": 0.1}).run(joint.measurements())
    later, error = joint.t > AT, np.abs(found["sigma"] / joint.sigma - 1)
    assert T * np.count_nonzero(later & ~found["confident"].astype(bool)) < 2.0
    assert T * np.count_nonzero(later & (error > 0.1)) < 2.0


@pytest.mark.parametrize("factor", [2.0, 0.5, 1.3])
@pytest.mark.parametrize("inertia", [0.05, 0.2])
def test_a_change_under_a_free_load_is_followed(c: Library, inertia: float, factor: float) -> None:
    """GIVEN motor data known to 3 %, THEN a changed spring differs from another inertia."""
    joint = FreeLoad(inertia=inertia, stiffness=fast_step(factor))
    found = Estimator(c, {**SETTINGS, "prior.B": 0.03}).run(joint.measurements())
    error = np.abs(found["sigma"] / joint.sigma - 1)
    assert np.max(error[joint.t > AT + 3.0]) < 0.1
    assert 14.0 < found["change_age"][-1] < 15.0


@pytest.mark.parametrize("factor", [0.6, 1.6])
def test_a_change_is_followed_where_the_zero_of_the_deformation_is_not_known(
    c: Library, factor: float
) -> None:
    """GIVEN a link encoder whose zero is 5 mrad off, THEN the torque at this zero changes, too."""
    joint = MisfitJoint(duration=22.0, stiffness=step(factor))
    z = joint.measurements()
    z[:, 1] += 5e-3
    found = Estimator(c, {**SETTINGS, **WRONG_MOTOR}).run(z)
    error = np.abs(found["sigma"] / joint.sigma - 1)
    assert np.max(error[joint.t > AT + 1.0]) < 0.05
    assert np.all(found["confident"][joint.t > AT + 1.5])


def test_a_slow_change_is_followed(c: Library) -> None:
    """GIVEN a stiffness that doubles from 15 to 25 s, THEN the estimate is right again at 28 s, and
    confident at the end."""
    joint = Joint(
        duration=36.0, frequency=0.5, amplitude=1.6, stiffness=lambda t: np.clip(t / 10 - 0.5, 1, 2)
    )
    found = Estimator(c, {**REGRESSION, "prior.B": 0.1}).run(joint.measurements())
    error = np.abs(found["sigma"] / joint.sigma - 1)
    assert T * np.count_nonzero(found["confident"].astype(bool) & (error > 0.2)) < 1.0
    assert np.max(error[joint.t > 28.0]) < 0.1 and found["confident"][-1]


def test_a_change_is_found_with_a_short_memory(c: Library) -> None:
    """A misfit makes the estimator forget, so that it never has 40 blocks."""
    joint = MisfitJoint(duration=20.0, seed=3, hysteresis=0.06, hysteresis_width=6e-3)
    z = joint.measurements()
    z[15_000:, 3] -= joint.tau_e[15_000:] / joint.gamma  # twice the spring
    p = {**SETTINGS, "regression.memory": 1.0, "prior.hysteresis": 0.0}
    age = Estimator(c, p).run(z)["change_age"]
    assert np.all(age[:15_000] == -1)
    assert age[16_000] >= 0


def test_the_doubt_begins_before_the_change_is_certain(c: Library) -> None:
    """GIVEN a change after 8 s, when no misfit is usual yet, THEN the evidence alone is doubt."""
    joint = Joint(duration=14.0, stiffness=lambda t: np.where(t < 8.0, 1.0, 1.3))
    found = Estimator(c, REGRESSION).run(joint.measurements())
    in_doubt, age = found["doubt"] == CHANGE, found["change_age"]
    assert not np.any(in_doubt[joint.t < 8.0])
    assert np.any(in_doubt & (age == -1))
    assert age[-1] > 0


def test_the_age_is_the_time_since_the_last_change(c: Library) -> None:
    """Ticks without a measurement count, too, and those in which the filters settle."""
    z = Joint(duration=25.0, stiffness=step(2.0)).measurements()
    z[22_000:23_000, 0] = np.nan
    age = Estimator(c, REGRESSION).run(z)["change_age"]
    assert age[-1] - age[21_999] == pytest.approx((len(age) - 22_000) * T)


def test_the_age_grows_in_float_for_days(tmp_path_factory: pytest.TempPathFactory) -> None:
    """A sum of samples of 0.1 ms no longer grows in float after 2048 s."""
    c = compile_library(tmp_path_factory.getbasetemp(), "float")
    e = Estimator(c, {**REGRESSION, "samplePeriod": 1e-4})
    e.state.method.regression.change_age = 700_000_000
    age = e.run(np.zeros((1000, 5)))["change_age"]
    assert age[-1] == pytest.approx(70_000.1, rel=1e-7)
    assert age[-1] > age[0]


@pytest.mark.parametrize(
    ("joint", "parameters"),
    [
        (Joint(duration=60.0), {}),
        (Joint(duration=60.0, tau_coulomb=0.03, seed=3), {}),
        (Joint(duration=60.0, noise=0.02, seed=4), {}),  # six times the configured noise
        (Joint(duration=60.0, tau_coulomb=0.015, seed=5), WRONG_MOTOR),
        (Joint(duration=60.0, deformation=0.2, seed=6), {"rls.n": 1, "prior.power": 0.0}),
    ],
    ids=["nothing", "friction", "noise", "wrong motor", "wrong basis"],
)
def test_a_misfit_is_no_change(c: Library, joint: Joint, parameters: dict[str, float]) -> None:
    found = Estimator(c, {**REGRESSION, **parameters}).run(joint.measurements())
    assert np.all(found["change_age"] == -1)


@pytest.mark.parametrize(
    "change",
    [{"tau_coulomb": 0.02}, {"tau_coulomb": 0.005}, {"load_friction": 0.08}]
    + [{"D_theta": D_THETA * factor} for factor in (0.7, 1.3)],
    ids=lambda change: " ".join(f"{name} {value:g}" for name, value in change.items()),
)
def test_friction_that_changes_is_told_from_the_spring(c: Library, change: dict[str, Any]) -> None:
    """GIVEN friction that changes at 12 s, in two motions with six seeds, THEN at most a quarter of
    the runs report a change of the spring, and the stiffness is right 10 s later."""
    reported = 0
    for kind, seed in product((MisfitJoint, Joint), range(1, 7)):
        slow: dict[str, Any] = {"frequency": 0.5, "amplitude": 1.6} if kind is Joint else {}
        joint = kind(duration=26.0, seed=seed, **slow)
        joint = replace(joint, tau_coulomb=0.01, load_friction=0.03)
        z, later = joint.measurements(), joint.t >= 12.0
        z[later] = replace(joint, **change).measurements()[later]
        found = Estimator(c, {**REGRESSION, "prior.B": 0.1}).run(z)
        error = np.abs(found["sigma"] / joint.sigma - 1)
        assert np.max(error[joint.t > 22.0]) < 0.1
        reported += bool(np.any(found["change_age"] >= 0))
    assert reported <= 3


@pytest.mark.parametrize("change", [{"tau_coulomb": 0.02}, {"D_theta": 1.4 * D_THETA}])
def test_friction_that_drifts_and_then_changes_is_told_from_the_spring(
    c: Library, change: dict[str, Any]
) -> None:
    """GIVEN misfits that look like friction that drifts, WHEN friction changes at 12 s."""
    misfits: dict[str, Any] = {
        "load_friction": 0.08,
        "delay": -1e-3,
        "damping": 0.2,
        "hysteresis": 0.1,
    }
    joint = MisfitJoint(duration=16.0, bias=0.2, D_theta=0.9 * D_THETA)
    joint = replace(joint, **misfits)
    z, later = joint.measurements(), joint.t >= 12.0
    z[later] = replace(joint, **change).measurements()[later]
    estimator = Estimator(c, {**REGRESSION, "prior.B": 0.1})
    estimator.run(z[~later])
    assert estimator.state.method.regression.bank.friction_drifts
    found = estimator.run(z[later])
    assert np.all(found["change_age"] == -1)
    assert found["sigma"][-1] == pytest.approx(joint.sigma[-1], rel=0.1)


@pytest.mark.parametrize("parameters", [{"regression.memory": 0.0}, {"method": 1}])
def test_no_change_is_looked_for(c: Library, parameters: dict[str, float]) -> None:
    """Runs without memory, and with the method of the paper."""
    joint = Joint(duration=20.0, stiffness=step(2.0))
    found = Estimator(c, {**REGRESSION, **parameters}).run(joint.measurements())
    assert np.all(found["change_age"] == -1)
    assert not np.any(found["doubt"] == CHANGE)


def test_a_misfit_that_begins_is_in_doubt_until_it_is_usual(c: Library) -> None:
    """GIVEN cogging from 20 s on, THEN the estimate is in doubt for a while, and later only where a
    few blocks are evidence. The motion does not repeat in step with the blocks."""
    joint = Joint(duration=60.0, frequency=1.03, tau_coulomb=0.02)
    z = joint.measurements()
    begun = joint.t >= 20.0
    z[begun, 3] += 0.02 * np.sin(6 * 50.0 * joint.motion[0][begun])
    found = Estimator(c, REGRESSION).run(z)
    in_doubt = found["doubt"] == CHANGE
    before = (joint.t >= 2.0) & ~begun
    assert not np.any(in_doubt[before]) and np.all(found["confident"][before])
    assert np.any(in_doubt[begun & (joint.t < 22.0)])
    assert np.mean(in_doubt[(joint.t > 22.0) & (joint.t < 30.0)]) > 0.9
    assert np.mean(in_doubt[joint.t > 55.0]) < 0.2
    assert np.all(found["change_age"] == -1)
