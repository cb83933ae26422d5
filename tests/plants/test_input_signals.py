"""The sines that plants add to the torques of their motors, so that they move without a source."""

import math

import numpy as np
import pytest

import sigmahat
from fmi_instance import OK, Instance
from fmi_runs import PLANTS
from plant_runs import QUIET, STATES, run_awas, run_plant, sinusoids, times

FIRST = {"signal.tau.amplitude": 0.3, "signal.tau.frequency": 2.0}
SECOND = {"signal.tau_c.amplitude": 8.0, "signal.tau_c.frequency": 3.0}
RECORD = (*STATES, "tau_measured")


def test_a_signal_is_an_input_that_is_linear_over_a_step() -> None:
    h = 1e-2
    t = times(h, 0.5)
    driven = run_awas(h, sinusoids(t, (0.3, 2.0), (8.0, 3.0), (0.0, 0.0)), QUIET, RECORD)
    still = run_awas(h, np.zeros((len(t), 3)), {**QUIET, **FIRST, **SECOND}, RECORD)
    for name in RECORD:
        np.testing.assert_allclose(still[name], driven[name], rtol=0, atol=1e-9)
    assert np.ptp(still["q"]) > 0.01


@pytest.mark.parametrize("name", PLANTS)
def test_every_motor_of_every_plant_has_its_own(name: str) -> None:
    motors = {"AwasPlant": ["tau", "tau_c"], "AntagonisticVsaPlant": ["tau_1", "tau_2"]}
    t = times(1e-3, 0.05)
    for motor in motors.get(name, ["tau"]):
        sine = 0.2 * np.sin(10 * np.pi * t)[:, None]
        angle = motor.replace("tau", "theta")
        driven = run_plant(name, [motor], 1e-3, sine, QUIET, [angle])
        start = {f"signal.{motor}.amplitude": 0.2, f"signal.{motor}.frequency": 5.0}
        still = run_plant(name, [motor], 1e-3, 0 * sine, {**QUIET, **start}, [angle])
        np.testing.assert_allclose(still[angle], driven[angle], rtol=0, atol=1e-12)
        assert np.ptp(still[angle]) > 1e-3


def test_a_signal_begins_at_zero_at_any_start_time() -> None:
    with Instance(sigmahat.fmu("AwasPlant")) as early, Instance(sigmahat.fmu("AwasPlant")) as late:
        for fmu, begin in ((early, 0.0), (late, 0.125)):
            fmu.set_all({**QUIET, **FIRST})
            assert (fmu.enter(begin), fmu.exit()) == (OK, OK)
            assert fmu.get("tau_measured") == 0.0
            for k in range(100):
                assert fmu.step(begin + k / 1024, 1 / 1024) == OK
        names = [n for n, v in early.variables.items() if v.causality == "output"]
        assert late.get_all(names) == early.get_all(names)
        assert early.get("tau_measured") == pytest.approx(0.3 * np.sin(4 * np.pi * 100 / 1024))
        assert early.get("q") != 0.0


def test_a_late_importer_gets_the_sine_of_the_right_time() -> None:
    """A communication point may differ a little from the end of the last step."""
    late, h, k = 0.9e-6, 1e-3, 2
    with Instance(sigmahat.fmu("AwasPlant")) as fmu:
        values = {"signal.tau.amplitude": 1.0, "signal.tau.frequency": 100.0}
        fmu.initialise({**values, "noise.tau_variance": 0.0})
        for i in range(k):
            assert fmu.step(i * h, h) == OK
        assert fmu.step(k * h + late, h) == OK
        expected = math.sin(2 * math.pi * 100.0 * ((k + 1) * h + late))
        assert fmu.get("tau_measured") == pytest.approx(expected, abs=1e-9)
