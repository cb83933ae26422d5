"""When the estimator computes its ticks, and with which inputs."""

import math
from collections.abc import Callable
from fractions import Fraction

import numpy as np
import pytest

import sigmahat
from fmi_instance import ERROR, OK, Instance
from fmi_runs import ESTIMATORS, FMI2, PLANTS, SIGNALS, Fmi, names
from sigmahat.fmi.instance import Fmu, Slave
from sigmahat.fmi.sample_loop import Recorder, SampleLoop, step_times

SENSOR, STANDARD = 2, 2
# One parameter, regressor phi = 1 and P_0 = 1: P(k) = 1 / (1 + k), so 1 / rho counts the ticks.
ONE_PARAMETER = {"rls.n": 1, "rls.m": 1, "rls.P_0": 1.0}
COUNTING = {**ONE_PARAMETER, "modality": SENSOR, "rls.kind": STANDARD, "q": 1.0}


def ticks(fmu: Instance) -> int:
    """Number of ticks, at least one, of an instance that was initialised with COUNTING."""
    return round(1.0 / fmu.get("rho"))


def test_a_million_steps_of_a_sample_period_are_a_million_ticks() -> None:
    with Fmu(sigmahat.fmu("StiffnessEstimator")) as fmu, Slave(fmu, "one") as slave:
        slave.initialize({**COUNTING, "modality": "Sensor", "rls.kind": "Standard"})
        h, loop, count = 1e-3, SampleLoop(), 1_000_000
        # The rounding errors are as in importers, which add up the time.
        times = np.concatenate([[0.0], np.cumsum(np.full(count - 1, h))])
        loop.step(slave, step_times(times, h))
        recorder = Recorder(slave, ["rho"], count)
        recorder.add_to(loop)
        loop.run(0, count)
        assert round(1.0 / recorder.columns()["rho"][-1]) == count


@pytest.mark.parametrize(
    ("h", "every"),  # length of a step, and time from one step to the next
    [
        *((h, h) for h in (1e-4, 1e-3, 2.5e-3, 1 / 60, 1e-3 / 7, 0.016666666666666677)),
        *((h, 1e-3) for h in (1.0009e-3, 0.9991e-3)),
    ],
)
def test_a_step_of_any_length_computes_the_ticks_within_it(h: float, every: float) -> None:
    with FMI2().initialise(COUNTING) as fmu:
        for k in range(3000):
            assert fmu.step(k * every, h) == OK
            # those with t_k < t + h: a tick at the end of the step belongs to the next one
            assert ticks(fmu) == math.ceil((k * every + h) / 1e-3 - 1e-6)


def test_steps_much_shorter_than_the_tolerance_add_up() -> None:
    with FMI2().initialise(COUNTING) as fmu:
        h = 1e-3 / 3e6
        for k in range(10):
            assert fmu.step(k * h, h) == OK
        assert ticks(fmu) == 1
        assert fmu.step(10 * h, 1e-3) == OK
        assert ticks(fmu) == 2


PIECE = Fraction(1, 20)  # s; a multiple of 10 ms and of 1/60 s


def on_a_line(signal: Callable[[float], float], t: Fraction) -> tuple[float, float]:
    """A piecewise linear signal and its slope, each computed exactly and rounded once."""
    begin = t // PIECE * PIECE
    start, end = (Fraction(signal(float(corner))) for corner in (begin, begin + PIECE))
    slope = (end - start) / PIECE
    return float(start + slope * (t - begin)), float(slope)


def run(name: str, h: Fraction) -> list[list[float]]:
    """All Real outputs at the ends of the linear pieces, over 0.5 s in steps of h."""
    # Without a set-point its powers cannot be distinguished, so rls.m is 1.
    start = {"rls.m": 1} if name == "AntagonisticStiffnessEstimator" else {}
    found = []
    with FMI2(name) as fmu:
        inputs = names(fmu, "input")
        outputs = [n for n in names(fmu, "output") if fmu.variables[n].type == "Real"]
        fmu.initialise(start)
        for k in range(int(Fraction(1, 2) / h)):
            for i in inputs:
                value, slope = on_a_line(SIGNALS[i], k * h)
                assert fmu.set(i, value) == fmu.set_derivative(i, slope) == OK
            assert fmu.step(float(k * h), float(h)) == OK
            if (k + 1) * h % PIECE == 0:
                found.append(fmu.get_all(outputs))
    return found


@pytest.mark.parametrize("name", ESTIMATORS)
def test_inputs_with_derivatives_give_the_same_ticks_for_any_step(name: str) -> None:
    reference = np.array(run(name, Fraction(1, 1000)))
    assert len(reference) == 10
    scale = np.max(np.abs(reference), axis=0)
    scale[scale == 0.0] = 1.0  # coefficients eta that are not used
    for h in (Fraction(1, n) for n in (2000, 400, 60)):
        np.testing.assert_allclose(run(name, h) / scale, reference / scale, rtol=0, atol=1e-12)


@pytest.mark.parametrize("start", [0.0, 1.7e9])
def test_a_missing_step_is_an_error_at_any_time(start: float) -> None:
    with FMI2().initialise(COUNTING, start=start) as fmu:
        for k in range(3000):  # at 1.7e9 s, where times are rounded to 0.2 us, too
            assert fmu.step(start + k * 1e-3, 1e-3) == OK
            assert ticks(fmu) == k + 1
        assert fmu.step(start + 3.001, 1e-3) == ERROR
        received, expected = fmu.last_message.split("; expected ")
        assert received.split()[-2] != expected.split()[0]
        assert fmu.step(start + 3.0, 1e-3) == OK


@pytest.mark.parametrize("name", ESTIMATORS + PLANTS)
def test_an_input_derivative_is_used_for_one_step_only(name: str) -> None:
    with FMI2(name) as fmu:
        inputs = names(fmu, "input")
    for changed in inputs:
        results = []
        for again in (None, 0.0):  # in the second step: no call, or a slope of 0
            with FMI2(name).initialise() as fmu:
                assert fmu.set_derivative(changed, 3.0) == OK
                assert fmu.step(0.0, 3e-3) == OK
                if again is not None:
                    assert fmu.set_derivative(changed, again) == OK
                assert fmu.step(3e-3, 3e-3) == OK
                results.append(fmu.get_all(names(fmu, "output")))
        assert results[0] == results[1], changed


def test_parameters_that_contradict_each_other_stop_the_step_until_they_are_corrected(
    fmi: Fmi,
) -> None:
    """The parameters were set, or come from a state."""
    with fmi().initialise(COUNTING) as fmu:
        assert fmu.step(0.0, 1e-3) == OK
        fmu.set_all({"filter.V_min": 11.0})
        state = fmu.save()
        for _ in range(2):
            assert fmu.step(1e-3, 1e-3) == ERROR
            assert "filter.V_min = 11" in fmu.last_message
            fmu.set_all({"filter.V_max": 12.0})  # now V_min < V_max again
            assert fmu.step(1e-3, 1e-3) == OK
            assert ticks(fmu) == 2
            assert fmu.restore(state) == OK
        fmu.free(state)
