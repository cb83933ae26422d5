"""Errors of the estimators in all scenarios, compared with the numbers in the paper."""

import math

import numpy as np
import pytest

from recordings import eight_seeds, one_seed
from sigmahat.experiments.scenario import nominal_awas
from sigmahat.paper.scenarios import scenario
from sigmahat.studies.reproduce_results import Reproduced


def worst(result: Reproduced, name: str, index: str) -> float:
    return max(abs(float(getattr(each[name], index))) for each in result.indices)


def test_table_1_model() -> None:
    model = one_seed("table1").indices[0]["MODEL"]
    assert model.mse == pytest.approx(23.5, abs=1.0)
    assert model.msrep == pytest.approx(0.12, abs=0.01)


@pytest.mark.slow("8 seeds")
def test_table_1_residual_over_8_seeds() -> None:
    assert eight_seeds("table1").mean("RESIDUAL", "mse")[0] <= 128.16
    assert eight_seeds("table1").mean("RESIDUAL", "msrep")[0] <= 0.58


@pytest.mark.parametrize("name", ["MODEL", "SENSOR", "RESIDUAL"])
def test_table_1_is_start_up(name: str) -> None:
    assert eight_seeds("table1").mean(name, "msrep_settled")[0] < 0.01


@pytest.mark.parametrize("name", ["MODEL", "SENSOR", "RESIDUAL"])
def test_as_printed(name: str) -> None:
    assert one_seed("as-printed").indices[0][name].msrep < 0.25


def test_noise_differs_between_seeds_and_nothing_else_does() -> None:
    assert len({each["RESIDUAL"].mse for each in eight_seeds("table1").indices}) == 8
    # MODEL uses no noisy measurement.
    assert len({each["MODEL"].mse for each in eight_seeds("table1").indices}) == 1


def test_constant_factors_show_what_the_enhanced_one_is_for() -> None:
    """Figure 8 of the paper: RLS with a small constant factor is slow; a large factor diverges."""
    recording = one_seed("table1").recording
    error = {
        series.parameters["rls.a"]: np.abs(series["sigma"] / recording.plant["sigma"] - 1)
        for series in recording.estimators.values()
        if series.parameters["rls.kind"] == "ConstantFactor"
    }
    small, large = (error[a] for a in sorted(error))
    second = slice(1000, 2000)
    assert small[second].min() > 0.5
    assert large[second].max() < 0.1
    assert large[2000:].max() > 0.5
    assert np.abs(np.diff(small[1000:])).max() < 0.01  # slow, but without disturbances


@pytest.mark.parametrize("spring", ["linear", "hardening"])
@pytest.mark.slow("8 seeds")
def test_single_transmission_over_8_seeds(spring: str) -> None:
    result = eight_seeds(f"single-{spring}")
    assert worst(result, "RESIDUAL", "msrep_settled") < 0.1
    assert worst(result, "RESIDUAL", "msrep") <= 1.5


def test_ridge_of_the_paper_is_too_strong_without_set_point() -> None:
    for each in eight_seeds("single-linear").indices:
        assert each["RESIDUAL-paper-prior"].msrep_settled > 30


@pytest.mark.slow("8 seeds of 30 s")
def test_antagonistic_device_after_the_first_co_contraction() -> None:
    assert scenario("antagonistic").settled == 10.0
    assert worst(eight_seeds("antagonistic"), "device", "msrep_settled") < 1.0


@pytest.mark.slow("8 seeds of an experiment of 60 s")
def test_experiment_paper_figures() -> None:
    result = eight_seeds("experiment")
    assert worst(result, "RESIDUAL against SENSOR", "msrep_settled") <= 1.55
    assert worst(result, "RESIDUAL against SENSOR", "mse_settled") <= 63.02
    assert worst(result, "MODEL against nominal", "msrep_settled") <= 0.034
    assert worst(result, "MODEL against nominal", "msrep") <= 0.034


def test_experiment_model_confirms_wrong_data_and_residual_finds_the_truth() -> None:
    result = eight_seeds("experiment")
    assert worst(result, "MODEL against nominal", "error_settled") < 0.1
    assert worst(result, "RESIDUAL against true", "error_settled") < 1
    for each in result.indices:
        assert each["MODEL against true"].error_settled > 5
        assert each["SENSOR against true"].error_settled == pytest.approx(3.0, abs=0.2)  # its gain


def test_device_of_the_experiment_differs_from_its_data_as_asked() -> None:
    recording = one_seed("experiment").recording
    plant, data = recording.plant, nominal_awas(recording)
    np.testing.assert_allclose(plant["r"] - data["r"], 0.002, rtol=1e-9)
    spring = plant["sigma"] / plant["r"] ** 2 / (data["sigma"] / data["r"] ** 2)
    np.testing.assert_allclose(spring, 0.85, rtol=1e-9)
    start = scenario("experiment").plant.start
    assert start["link.D_q"] == pytest.approx(0.225)
    assert (start["link.tau_coulomb"], start["sensor.gain"]) == (0.05, 1.03)
    error = plant["tau_e_measured"] - 1.03 * plant["tau_e"]
    assert np.mean(error) == pytest.approx(0.0, abs=5 * math.sqrt(1e-3 / len(error)))
    assert np.var(error) == pytest.approx(1e-3, rel=0.05)
