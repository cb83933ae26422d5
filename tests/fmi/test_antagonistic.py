"""The antagonistic estimator has the results of two single estimators."""

import math
import re

import numpy as np
import pytest

from fmi_instance import ERROR, OK, WARNING, Instance
from fmi_runs import FMI2, SIGNALS, names
from regression_joint import Joint

PAIR = "AntagonisticStiffnessEstimator"
CONFIDENT, NOT_EXCITED, MISFIT = 1, 3, 4  # items of the enumeration Doubt

MOTORS = [{"B": 2.3e-5, "D_theta": 1e-3}, {"B": 3e-5, "D_theta": 2e-3}]


def step(instances: list[Instance], k: int, bad: dict[str, float] | None = None) -> list[int]:
    """Makes one step of 1 ms with the same signals for all instances. Returns their statuses."""
    t, h = k * 1e-3, 1e-3
    for fmu, side in zip(instances, ("", "_1", "_2"), strict=True):
        for name in {*names(fmu, "input")} - {"theta_c"}:
            signal = SIGNALS.get(name + side, SIGNALS[name])
            fmu.set_all({name: signal(t)})
            assert fmu.set_derivative(name, (signal(t + h) - signal(t)) / h) == OK
    pair, _, two = instances
    for name, value in (bad or {}).items():
        pair.set_all({f"{name}_2": value})
        two.set_all({name: value})
    return [instance.step(t, h) for instance in instances]


def doubt_of_sum(pair: Instance, one: Instance, two: Instance) -> float:
    """The worse reason of the sides; too little motion of one side alone is no reason."""
    worst = max(one.get("doubt"), two.get("doubt"))
    if worst not in (CONFIDENT, NOT_EXCITED):
        return worst
    if pair.get("sigma_std") < pair.get("limit.relative_std") * abs(pair.get("sigma")):
        return CONFIDENT
    return max(worst, NOT_EXCITED)


@pytest.mark.parametrize(
    "values",
    [
        {},
        {"modality": 2, "filter.kind": 3, "rls.symmetric": 0, "samplePeriod": 4e-4},
        {"method": 2, "rls.n": 3, "rls.m": 1, "prior.B": 0.1, "prior.tau_coulomb": 0.02},
    ],
)
def test_bit_identical_to_two_estimators(values: dict[str, float]) -> None:
    with FMI2(PAIR) as pair, FMI2() as one, FMI2() as two:
        of_pair = {f"motor_{i}.{k}": v for i, m in enumerate(MOTORS, 1) for k, v in m.items()}
        pair.initialise(values | of_pair)
        for single, motor in zip((one, two), MOTORS, strict=True):
            single.initialise(values | {f"motor.{k}": v for k, v in motor.items()})
        outputs = names(one, "output")
        for k in range(200):
            bad = {"tau": math.nan} if 50 <= k < 53 else None
            statuses = step([pair, one, two], k, bad)
            expected = [WARNING, OK, WARNING] if bad else [OK, OK, OK]
            assert statuses == expected
            for i, single in ((1, one), (2, two)):
                of_side = [re.sub(r"(?=\[)|$", f"_{i}", name, count=1) for name in outputs]
                assert pair.get_all(of_side) == single.get_all(outputs)
            assert pair.get("sigma") == one.get("sigma") + two.get("sigma")
            sigma_std = math.hypot(one.get("sigma_std"), two.get("sigma_std"))
            assert pair.get("sigma_std") == pytest.approx(sigma_std, rel=1e-15)
            assert pair.get("doubt") == doubt_of_sum(pair, one, two)
            assert pair.get("confident") == (pair.get("doubt") == CONFIDENT)
            assert pair.get("valid") == (0 if bad else 1)
        assert pair.get("sigma") != 0.0


def test_a_new_misfit_of_a_side_is_a_doubt_of_the_sum() -> None:
    """GIVEN two equal sides that contradict the model from the first sample on, THEN the sum is
    also in doubt, although its sigma_std is small."""
    joint = Joint(duration=1.4, deformation=0.01)
    z = joint.measurements()
    z[:, 3] += 0.02 * np.sin(3 * 50 * joint.motion[0])
    with FMI2(PAIR) as pair:
        pair.initialise({"method": 2, "rls.n": 3, "rls.m": 1})
        for k, (theta, q, _, tau, _) in enumerate(z.tolist()):
            pair.set_all({"theta_1": theta, "theta_2": theta, "q": q, "tau_1": tau, "tau_2": tau})
            assert pair.step(k * 1e-3, 1e-3) == OK
            assert k < 500 or pair.get("doubt") == MISFIT
        assert pair.get("sigma_std") < 0.1 * pair.get("sigma")


def test_messages_name_the_motor() -> None:
    with FMI2(PAIR) as pair:
        pair.set_all({"motor_2.gamma": 0.0})
        assert pair.enter() == OK
        assert pair.exit() == ERROR
        assert "Motor 2" in pair.messages[-1][2] and "gamma" in pair.messages[-1][2]
        pair.set_all({"motor_2.gamma": 50.0})
        assert pair.exit() == OK
        pair.set_all({"tau_1": math.nan})
        assert pair.step(0.0, 1e-3) == WARNING
        assert "Motor 1" in pair.messages[-1][2]
