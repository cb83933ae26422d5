"""When the estimator ticks, and at which inputs."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from fmi_instance import ERROR, OK, Instance

SENSOR, STANDARD, FINITE_DIFFERENCE = 2, 2, 3
# One parameter, regressor phi = 1 and P_0 = 1: P(k) = 1 / (1 + k), so rho counts ticks.
COUNTING = {
    "modality": SENSOR,
    "rls.kind": STANDARD,
    "rls.n": 1,
    "rls.m": 1,
    "rls.P_0": 1.0,
    "q": 1.0,
}
OUTPUTS = ["sigma", "tau_e", "tau_e_residual", "theta_dot", "phi", "setPoint", "rho", "eta[1,1]"]


def ticks(fmu: Instance) -> int:
    """Number of ticks so far, at least one, of an instance with COUNTING."""
    return round(1.0 / fmu.get("rho"))


def test_one_tick_for_each_step_of_a_sample_period(estimator_fmu: Path) -> None:
    with Instance(estimator_fmu) as fmu:
        fmu.initialise(COUNTING)
        t = 0.0
        for k in range(20000):
            assert fmu.step(t, 1e-3) == OK
            t += 1e-3  # with the rounding that importers add up
            if k % 997 == 0 or k > 19990:
                assert ticks(fmu) == k + 1


@pytest.mark.parametrize(
    "h", [1e-4, 5e-4, 1e-3, 2.5e-3, 1e-2, 1 / 60, 1e-3 / 7, 0.016666666666666677]
)
def test_number_of_ticks_for_any_step(h: float, estimator_fmu: Path) -> None:
    with Instance(estimator_fmu) as fmu:
        fmu.initialise(COUNTING)
        for k in range(300):
            assert fmu.step(k * h, h) == OK
            # t_k < t + h, where a tick on the end belongs to the next step
            assert ticks(fmu) == math.ceil((k + 1) * h / 1e-3 - 1e-6)


def test_a_step_much_shorter_than_the_tolerance_still_counts(estimator_fmu: Path) -> None:
    with Instance(estimator_fmu) as fmu:
        fmu.initialise(COUNTING)
        h = 1e-3 / 3e6
        for k in range(10):
            assert fmu.step(k * h, h) == OK
        assert ticks(fmu) == 1
        assert fmu.step(10 * h, 1e-3) == OK
        assert ticks(fmu) == 2


def inputs(t: float) -> dict[str, float]:
    """Piecewise linear measurements with corners at multiples of 10 ms."""
    corners = np.arange(0.0, 2.0, 1e-2)
    return {
        "theta": float(np.interp(t, corners, np.sin(7 * corners))),
        "q": float(np.interp(t, corners, np.sin(7 * corners) + 0.01 * np.sin(11 * corners))),
        "theta_c": float(np.interp(t, corners, 10 * np.cos(3 * corners))),
        "tau": float(np.interp(t, corners, 0.3 * np.sin(5 * corners))),
    }


def run(fmu_path: Path, h: float, end: float) -> dict[int, list[float]]:
    """Outputs at the ends of the steps that fall on 10 ms, by time in units of 10 ms."""
    found = {}
    with Instance(fmu_path) as fmu:
        fmu.initialise()
        steps = round(end / h)
        for k in range(steps):
            t = k * h
            now = inputs(t)
            soon = inputs(t + h * 1e-3)
            for name, value in now.items():
                assert fmu.set(name, value) == OK
                assert fmu.set_derivative(name, (soon[name] - value) / (h * 1e-3)) == OK
            assert fmu.step(t, h) == OK
            if abs((k + 1) * h / 1e-2 - round((k + 1) * h / 1e-2)) < 1e-9:
                found[round((k + 1) * h / 1e-2)] = fmu.get_all(OUTPUTS)
    return found


@pytest.mark.parametrize("h", [1e-4, 5e-4, 2.5e-3, 1e-2])
def test_inputs_with_derivatives_give_the_same_ticks_for_any_step(
    h: float, estimator_fmu: Path
) -> None:
    reference, result = run(estimator_fmu, 1e-3, 0.5), run(estimator_fmu, h, 0.5)
    assert sorted(result) == sorted(reference) == list(range(1, 51))
    scale = np.max(np.abs(list(reference.values())), axis=0)
    for key, value in reference.items():
        # The interpolated inputs are rounded, and the residual differentiates them.
        np.testing.assert_allclose(result[key] / scale, value / scale, atol=1e-9)


@pytest.mark.parametrize("error", [9e-7, -9e-7])
def test_ticks_do_not_drift_from_their_times(error: float, estimator_fmu: Path) -> None:
    # GIVEN steps that are longer or shorter than a period by less than the tolerance
    # WHEN the difference has added up to two periods THEN there are two ticks more, or less
    h, steps = 1e-3 * (1 + error), 2_300_000
    with Instance(estimator_fmu) as fmu:
        fmu.initialise(COUNTING)
        for k in range(0, steps, 1000):
            for i in range(k, k + 1000):
                fmu.step(i * h, h)
        assert ticks(fmu) == math.ceil(steps * (1 + error) - 1e-6)


def test_inputs_without_derivatives_are_held(estimator_fmu: Path) -> None:
    with Instance(estimator_fmu) as fmu:
        fmu.initialise({"filter.kind": FINITE_DIFFERENCE})
        assert fmu.set("theta", 0.0) == OK
        assert fmu.set_derivative("theta", 2.0) == OK
        assert fmu.step(0.0, 1e-2) == OK
        assert fmu.get("theta_dot") == pytest.approx(2.0, rel=1e-12)
        assert fmu.set("theta", 0.02) == OK  # no derivative this time
        assert fmu.step(1e-2, 1e-2) == OK
        assert fmu.get("theta_dot") == 0.0


def test_ticks_start_at_the_start_time(estimator_fmu: Path) -> None:
    with Instance(estimator_fmu) as fmu:
        fmu.initialise(COUNTING, start=3.7)
        assert fmu.step(3.7, 1e-3) == OK
        assert ticks(fmu) == 1


@pytest.mark.parametrize(
    ("t", "h", "expected"),
    [
        (0.0, 0.0, "communicationStepSize"),
        (0.0, -1e-3, "communicationStepSize"),
        (0.0, math.nan, "communicationStepSize"),
        (0.0, math.inf, "communicationStepSize"),
        (0.5, 1e-3, "currentCommunicationPoint"),
        (-1e-3, 1e-3, "currentCommunicationPoint"),
        (math.nan, 1e-3, "currentCommunicationPoint"),
        (math.inf, 1e-3, "currentCommunicationPoint"),
        (0.0, 1e9, "communicationStepSize = 1e+09 s is more than 1e+09 times samplePeriod"),
    ],
)
def test_a_step_that_cannot_be_is_refused(
    t: float, h: float, expected: str, estimator_fmu: Path
) -> None:
    with Instance(estimator_fmu) as fmu:
        fmu.initialise(COUNTING)
        assert fmu.step(t, h) == ERROR
        assert expected in fmu.messages[-1][2]
        assert fmu.step(0.0, 1e-3) == OK  # and nothing was lost
        assert ticks(fmu) == 1


def test_a_tunable_parameter_takes_effect_at_the_next_tick(estimator_fmu: Path) -> None:
    with Instance(estimator_fmu) as fmu:
        fmu.initialise(COUNTING | {"tau_e_sensor": 4.0})
        for k in range(9):
            assert fmu.step(k * 1e-3, 1e-3) == OK
        assert fmu.get("sigma") == pytest.approx(4.0 * 9 / 10, rel=1e-12)  # ridge of P_0 = 1
        assert fmu.set("modality", 1) == OK  # Residual, which is 0 at rest
        assert fmu.step(9e-3, 1e-3) == OK
        assert fmu.get("epsilon") == pytest.approx(-3.6, rel=1e-12)
        assert ticks(fmu) == 10  # the state went on


def test_a_tunable_parameter_out_of_range_stops_the_step_until_it_is_mended(
    estimator_fmu: Path,
) -> None:
    with Instance(estimator_fmu) as fmu:
        fmu.initialise(COUNTING)
        assert fmu.step(0.0, 1e-3) == OK
        assert fmu.set("filter.V_min", 11.0) == OK
        assert fmu.step(1e-3, 1e-3) == ERROR
        assert "filter.V_min = 11" in fmu.messages[-1][2]
        assert fmu.set("filter.V_max", 12.0) == OK  # the pair is right again
        assert fmu.step(1e-3, 1e-3) == OK
        assert ticks(fmu) == 2
