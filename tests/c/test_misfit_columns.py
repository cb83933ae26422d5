"""Effects outside of the model: each is estimated, can be switched off, and causes doubt."""

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from c_library import Estimator, Library
from c_regression import covariance, kinds
from regression_joint import PLAIN, SETTINGS, STIFFNESS, Joint, MisfitJoint, at_rest

HYSTERESIS, GAP = 4, 6


def accuracy(estimator: Estimator, *of: str) -> float:
    """Standard deviation of the sum of the coefficients of some kinds, in their own unit."""
    regression = estimator.state.method.regression
    names = kinds(estimator)
    own = list(regression.posterior.column[0 : regression.posterior.information.size])
    chosen = np.array([regression.columns.column[i].prior * (names[i] in of) for i in own])
    return float(np.sqrt(chosen @ covariance(estimator) @ chosen))


# output: misfit, kinds of its columns
OUTPUTS: dict[str, tuple[dict[str, Any], tuple[str, ...]]] = {
    "bias_hat": ({"bias": 0.5}, ("BIAS",)),
    "load_friction_hat": ({"load_friction": 0.1}, ("LOAD", "DRIVE")),
    "delay_hat": ({"delay": 3e-3}, ("DELAY",)),
    "damping_hat": ({"damping": 0.6}, ("DAMPING",)),
    "hysteresis_hat": ({"hysteresis": 0.25}, ("HYSTERESIS",)),
}


@pytest.mark.parametrize(("way", "gamma"), [(1, -50.0), (-1, 50.0)])
@pytest.mark.parametrize("output", OUTPUTS)
def test_each_misfit_is_estimated(c: Library, output: str, way: int, gamma: float) -> None:
    """The output has the true value within a small tolerance, with the right sign for every gear;
    and the stiffness is right."""
    if output == "hysteresis_hat":
        way = 1  # no hysteresis gives energy
    misfit, columns = OUTPUTS[output]
    ((name, size),) = misfit.items()
    joint = replace(MisfitJoint(gamma=gamma), **{name: way * size})
    estimator = Estimator(c, {**SETTINGS, "motor.gamma": gamma})
    found = estimator.run(joint.measurements())
    std = accuracy(estimator, *columns)
    assert std < 0.3 * size
    assert found[output][-1] == pytest.approx(way * size, abs=3 * std + 0.03 * size)
    assert found["sigma"][-1] == pytest.approx(STIFFNESS, rel=0.01)
    assert found["misfit"][-1] < 1.3
    assert found["confident"][-1]


@pytest.mark.parametrize("scale", [1.0, 2.0])
def test_an_eccentric_encoder_of_the_link_is_estimated(c: Library, scale: float) -> None:
    """GIVEN a spring that is as stiff as its prior, or half as stiff."""
    estimator = Estimator(c, {**SETTINGS, "prior.tau_e": scale * SETTINGS["prior.tau_e"]})
    found = estimator.run(MisfitJoint(eccentric=8e-4).measurements())
    std = math.hypot(accuracy(estimator, "SIN_Q"), accuracy(estimator, "COS_Q")) / STIFFNESS
    assert std < 4e-4
    assert found["eccentric_hat"][-1] == pytest.approx(8e-4, abs=3 * std)
    assert found["sigma"][-1] == pytest.approx(STIFFNESS, abs=3 * found["sigma_std"][-1])


def test_a_dead_zone_is_left_out_of_the_stiffness(c: Library) -> None:
    """sigma is the slope where the spring is engaged."""
    joint = MisfitJoint(gap=4e-3)
    estimator = Estimator(c, SETTINGS)
    found = estimator.run(joint.measurements())
    assert estimator.state.method.regression.refit.used[GAP]
    late = slice(-3000, None)
    engaged = np.abs(joint.motion[3][late]) > 8e-3
    error = np.abs(found["sigma"][late] - STIFFNESS)[engaged]
    assert np.max(error) < 0.05 * STIFFNESS
    assert np.mean(error < 1.96 * found["sigma_std"][late][engaged]) > 0.85


def test_a_joint_without_a_misfit_has_no_columns_of_one(c: Library) -> None:
    estimator = Estimator(c, SETTINGS)
    found = estimator.run(MisfitJoint().measurements())
    used = estimator.state.method.regression.refit.used
    assert not used[GAP] and not used[HYSTERESIS]
    assert found["hysteresis_hat"][-1] == 0.0
    assert found["misfit"][-1] < 1.2


COLUMNS_OF: dict[str, tuple[str, ...]] = {
    "prior.nominal": ("NOMINAL",),
    "prior.bias": ("BIAS",),
    "prior.damping": ("DAMPING",),
    "prior.eccentric": ("SIN_Q", "COS_Q"),
    "prior.load_friction": ("LOAD", "DRIVE"),
    "prior.delay": ("DELAY",),
    "prior.reversal": ("REVERSAL",),
    "prior.power": ("HIGHER_POWER", "SET_POWER", "POSSIBLE_KNEE"),
    "prior.gap": ("DEAD_ZONE",),
    "prior.hysteresis": ("HYSTERESIS",),
    "prior.eccentric_motor": ("SIN_M", "COS_M"),
    "prior.D_theta": ("VISCOUS",),
    "prior.tau_coulomb": ("COULOMB", "DRIVE", "REVERSAL"),
    "prior.B": ("INERTIA",),
}


@pytest.mark.parametrize("prior", COLUMNS_OF)
def test_a_prior_of_zero_removes_its_columns_and_no_other(c: Library, prior: str) -> None:
    eta_0 = [[1.0] + [0.0] * 4] * 8
    values = {"method": 2, "prior.B": 0.1, "prior.nominal": 0.2, "rls.eta_0": eta_0}
    of_all = kinds(Estimator(c, values))
    without = kinds(Estimator(c, {**values, prior: 0.0}))
    assert without == [kind for kind in of_all if kind not in COLUMNS_OF[prior]]
    assert set(of_all) - set(without) == set(COLUMNS_OF[prior])


# The gain of the torque


@pytest.mark.parametrize("values", [{}, {"prior.B": 0.1}], ids=["exact B", "unknown B"])
def test_the_effect_of_the_gain_is_that_of_a_wrong_gain(
    c: Library, values: dict[str, float]
) -> None:
    """GIVEN a recorded torque that is 1 % too large."""
    z = MisfitJoint(duration=3.0, tau_coulomb=0.0).measurements()
    larger = z.copy()
    larger[:, 3] *= 1.01
    # Without misfit, and without friction, whose size decides on the weights of samples.
    weights = {"prior.tau_coulomb": 0.0, "regression.memory": 0.0}
    settings = {**SETTINGS, **PLAIN, **weights, **values}
    first, second = (Estimator(c, settings).run(samples)[-1] for samples in (z, larger))
    change = (second["sigma"] / first["sigma"] - 1) / 0.01
    assert first["sigma_per_gain"] == pytest.approx(change, rel=5e-3)


# Doubt


@pytest.mark.parametrize(
    ("joint", "values", "doubt"),
    [
        (Joint(duration=4.0), {}, "NONE"),
        (Joint(duration=1.0), {"method": 1}, "NO_CLAIM"),
        (Joint(duration=1.0, deformation=0.0, amplitude=0.0), {}, "NOT_EXCITED"),
        (Joint(duration=0.3, deformation=2e-4), {}, "NOT_EXCITED"),
        (Joint(duration=4.0, frequency=2.0, D_theta=2.5e-3), {}, "FRICTION"),
        (Joint(duration=4.0, frequency=8.0, amplitude=0.1, B=4.6e-5), {"prior.B": 0.1}, "INERTIA"),
        (Joint(duration=4.0, stiffness=lambda t: -np.ones_like(t)), {}, "NEGATIVE_STIFFNESS"),
    ],
)
def test_the_reason_of_a_doubt(
    c: Library, joint: Joint, values: dict[str, float], doubt: str
) -> None:
    estimator = Estimator(c, {"method": 2, "rls.n": 3, **values})
    found = estimator.run(joint.measurements())["doubt"][-1]
    assert found == getattr(c.lib, f"SH_DOUBT_{doubt}")


def test_data_that_contradict_the_model_are_a_doubt(c: Library) -> None:
    joint = Joint(duration=6.0, deformation=0.01)
    z = joint.measurements()
    z[:, 3] += 0.1 * np.sin(3 * 50 * joint.motion[0])
    found = Estimator(c, {"method": 2, "rls.n": 3, "limit.relative_std": 0.02}).run(z)[-1]
    assert found["misfit"] > 2
    assert found["doubt"] == c.lib.SH_DOUBT_MISFIT


def test_the_first_misfit_is_a_doubt(c: Library) -> None:
    """GIVEN a misfit from the first sample on, or none, THEN from 0.6 to 1.4 s only the joint
    without a misfit is confident."""
    joint = Joint(duration=1.4, deformation=0.01)
    clean, contradicted = joint.measurements(), joint.measurements()
    contradicted[:, 3] += 0.02 * np.sin(3 * 50 * joint.motion[0])
    values = {"method": 2, "rls.n": 3}
    found = Estimator(c, values).run(clean)
    assert np.all(found["confident"][600:])
    found = Estimator(c, values).run(contradicted)
    assert not np.any(found["confident"][600:])
    assert found["doubt"][-1] == c.lib.SH_DOUBT_MISFIT
    assert found["sigma_std"][-1] < 0.1 * found["sigma"][-1]
    found = Estimator(c, {**values, "regression.memory": 0.0}).run(contradicted)
    assert np.all(found["confident"][600:])  # the misfit is switched off


@pytest.mark.parametrize(("n", "times"), [(1, 32), (2, 32 ** (1 / 3)), (3, 2), (4, 2)])
def test_a_deformation_far_beyond_the_range_is_a_doubt(c: Library, n: int, times: float) -> None:
    """The doubt begins where the highest power is over 32 times as large as at range.phi."""
    z = Joint(duration=4.0).measurements()
    estimator = Estimator(c, {"method": 2, "rls.n": n, "range.phi": 0.02})
    found = estimator.run(z)
    assert np.all(np.abs(found["phi"]) < 0.04)
    # The jump to the first deformation is accepted after 0.12 s.
    for share, is_beyond, samples in ((0.98, False, 120), (1.02, True, 1)):
        z[-1, 1] = z[-1, 0] + share * times * 0.02
        doubt = estimator.run(z[-1:].repeat(samples, 0))["doubt"][-1]
        assert doubt != c.lib.SH_DOUBT_NEGATIVE_STIFFNESS
        assert (doubt == c.lib.SH_DOUBT_OUT_OF_RANGE) == is_beyond


# Rest


def test_a_long_rest_changes_neither_the_estimate_nor_the_misfit(c: Library) -> None:
    z = MisfitJoint(load_friction=0.15, duration=4.0).measurements()
    z[:, 3] += 0.02 * np.sin(150 * z[:, 0])  # a misfit that no column explains
    estimator = Estimator(c, {**SETTINGS, "prior.B": 0.1})
    estimator.run(z)
    rest = at_rest(z)
    assert estimator.repeat(rest, 1000) == 1000 - 119  # the joint jumps to its rest
    before = c.ffi.new("sh_estimate *", estimator.estimate[0])
    assert before.misfit > 1.2
    assert estimator.repeat(rest, 1_000_000) == 1_000_000
    after = estimator.estimate
    assert after.sigma == pytest.approx(before.sigma, abs=0.5 * before.sigma_std)
    assert after.sigma_std > 0.5 * before.sigma_std
    assert after.misfit == pytest.approx(before.misfit, rel=0.1)
    assert np.all(np.isfinite(covariance(estimator)))
