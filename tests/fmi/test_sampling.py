"""When the estimator computes its ticks, and with which inputs."""

import math
from collections.abc import Callable
from fractions import Fraction

import numpy as np
import pytest

import sigmahat
from fmi_instance import ERROR, OK, WARNING, Instance, Instance3
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


# Held inputs

HELD_INPUTS = 10
MOVING = {"method": 2, "rls.n": 1, "rls.m": 1, "encoder.theta": 4e6}


def warnings(fmu: Instance | Instance3) -> list[str]:
    return [text for status, _, text in fmu.messages if status == WARNING]


def held_step(fmu: Instance | Instance3, t: float, h: float) -> None:
    """A step with inputs in motion that are set at its begin."""
    fmu.set_all({name: SIGNALS[name](t) for name in names(fmu, "input")})
    assert fmu.step(t, h) == OK, fmu.messages


@pytest.mark.parametrize("name", ESTIMATORS)
@pytest.mark.parametrize("method", [1, 2])
def test_the_first_step_of_several_ticks_with_held_inputs_warns_once(
    fmi: Fmi, name: str, method: int
) -> None:
    """Also if the importer restores a state from before the warning."""
    with fmi(name).initialise({**MOVING, "method": method}) as fmu:
        held_step(fmu, 0.0, 1e-3)
        assert warnings(fmu) == []
        before = fmu.save()
        held_step(fmu, 1e-3, 16e-3)
        held_step(fmu, 17e-3, 16e-3)
        assert fmu.restore(before) == OK
        held_step(fmu, 1e-3, 16e-3)
        (text,) = warnings(fmu)
        for part in ("0.016 s", "16 ticks", "samplePeriod = 0.001 s", "output_interval"):
            assert part in text
        assert "input derivatives (FMI 2.0)" in text
        fmu.free(before)
        assert fmu.call("Reset") == OK
        fmu.initialise({**MOVING, "method": method})
        held_step(fmu, 0.0, 2e-3)
        assert len(warnings(fmu)) == 2


@pytest.mark.parametrize("name", ESTIMATORS)
def test_a_step_of_one_tick_or_with_input_derivatives_says_nothing(name: str) -> None:
    with FMI2(name).initialise(MOVING) as fmu:
        held_step(fmu, 0.0, 1e-3)
        held_step(fmu, 1e-3, 4e-4)  # no tick is due in the next one
        held_step(fmu, 14e-4, 1e-4)
        assert fmu.set_derivative(names(fmu, "input")[-1], 0.0) == OK  # a value is no question
        state = fmu.save()
        held_step(fmu, 15e-4, 20e-3)
        assert fmu.restore(state) == OK  # the derivative is a part of the state
        held_step(fmu, 15e-4, 20e-3)
        assert warnings(fmu) == [] and fmu.get("doubt") != HELD_INPUTS
        fmu.free(state)


@pytest.mark.parametrize(("name", "side"), [(ESTIMATORS[0], ""), (ESTIMATORS[1], "_1")])
def test_held_inputs_are_a_doubt_until_a_second_of_single_ticks_has_passed(
    fmi: Fmi, name: str, side: str
) -> None:
    start = {**MOVING, "limit.relative_std": 1e12, "regression.memory": 0.0, "modality": SENSOR}
    # With coarse encoders, a sample that is repeated once is no outlier.
    start |= {"encoder.theta": 1000.0, "encoder.q": 1000.0}
    with fmi(name).initialise(start) as fmu:
        outputs = [n for n in names(fmu, "output") if n.partition("_")[0] != "doubt"]
        for k in range(1000):
            held_step(fmu, k * 1e-3, 1e-3)
        assert fmu.get(f"doubt{side}") == 1 and fmu.get(f"confident{side}")
        for again in (0, 1):  # a second step of two ticks starts the second anew
            held_step(fmu, 1.0 + again * 0.5, 2e-3)
            assert fmu.get("doubt") == HELD_INPUTS == fmu.get(f"doubt{side}")
            assert not fmu.get("confident") and not fmu.get(f"confident{side}")
            ticks_until = 498 if again == 0 else 999
            for k in range(ticks_until):
                held_step(fmu, 1.002 + again * 0.5 + k * 1e-3, 1e-3)
            assert fmu.get("doubt") == HELD_INPUTS
        state = fmu.save()
        held_step(fmu, 2.501, 1e-3)
        assert fmu.get("doubt") != HELD_INPUTS != fmu.get(f"doubt{side}")
        assert fmu.get(f"confident{side}")
        assert fmu.restore(state) == OK and fmu.get("doubt") == HELD_INPUTS
        fmu.free(state)
        assert all(map(math.isfinite, fmu.get_all(outputs)))


def test_paper2011_keeps_its_numbers_and_its_doubt() -> None:
    """With held inputs, as with derivatives of 0: only the messages differ."""
    found = []
    for told in (False, True):
        with FMI2().initialise() as fmu:
            for k in range(50):
                if told:
                    assert fmu.set_derivative("tau", 0.0) == OK
                held_step(fmu, k * 16e-3, 16e-3)
            found.append(fmu.get_all(names(fmu, "output")))
            assert fmu.get("doubt") == 2 and len(warnings(fmu)) == (0 if told else 1)
    assert found[0] == found[1]
