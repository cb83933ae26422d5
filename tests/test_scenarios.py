"""The scenarios, and the figures that the paper gives for them."""

from __future__ import annotations

import math

import numpy as np
import pytest

from recordings import one_seed
from sigmahat.metrics import mean_interval
from sigmahat.reproduce import Result, reproduce
from sigmahat.scenarios import SCENARIOS, scenario


@pytest.fixture(scope="module")
def twenty_seeds() -> Result:
    return reproduce(scenario("table1"), range(1, 21))


def mean(result: Result, name: str, index: str) -> float:
    return mean_interval([getattr(each[name], index) for each in result.indices])[0]


@pytest.mark.parametrize(("name", "lever_arm"), [("table1", 0.070), ("as-printed", 0.130)])
def test_initial_lever_arm(name: str, lever_arm: float) -> None:
    assert one_seed(name).recording.plant["r"][0] == pytest.approx(lever_arm, rel=1e-12)


@pytest.mark.parametrize("name", SCENARIOS)
def test_torques_are_those_of_the_paper(name: str) -> None:
    t = np.array([0.0, 1.0, 2.5, 7.5])
    inputs = scenario(name).plant.inputs
    wave = [math.sin(0.2 * math.pi * x) for x in t]
    np.testing.assert_allclose(inputs["tau"](t), 0.3 * np.array(wave), rtol=1e-15)
    np.testing.assert_allclose(inputs["tau_c"](t), 8.0 * np.array(wave), rtol=1e-15)


@pytest.mark.parametrize("name", SCENARIOS)
def test_description_is_one_short_line(name: str) -> None:
    assert SCENARIOS[name].name == name
    assert 20 < len(SCENARIOS[name].description) < 100
    assert "\n" not in SCENARIOS[name].description


def test_unknown_scenario_is_refused_with_a_suggestion() -> None:
    with pytest.raises(ValueError, match=r"'tabel1'; did you mean 'table1'\?.*as-printed"):
        scenario("tabel1")


def test_table_1_model() -> None:
    model = one_seed("table1").indices[0]["MODEL"]
    assert model.mse == pytest.approx(23.5, abs=1.0)
    assert model.msrep == pytest.approx(0.12, abs=0.01)


def test_table_1_modality_model_of_the_fmu() -> None:
    """(28) at the measured positions, which are quantised but carry no noise."""
    measured = one_seed("table1").indices[0]["MODEL-measured"]
    assert measured.msrep == pytest.approx(0.12, abs=0.01)
    assert measured.msrep_settled < 0.01


def test_table_1_residual_over_20_seeds(twenty_seeds: Result) -> None:
    assert mean(twenty_seeds, "RESIDUAL", "mse") <= 128.16
    assert mean(twenty_seeds, "RESIDUAL", "msrep") <= 0.58


@pytest.mark.parametrize("name", ["MODEL", "SENSOR", "RESIDUAL"])
def test_table_1_is_start_up(twenty_seeds: Result, name: str) -> None:
    assert mean(twenty_seeds, name, "msrep_settled") < 0.01


@pytest.mark.parametrize("name", ["MODEL", "SENSOR", "RESIDUAL"])
def test_as_printed(name: str) -> None:
    assert one_seed("as-printed").indices[0][name].msrep < 0.25


def test_noise_differs_between_seeds_and_nothing_else_does(twenty_seeds: Result) -> None:
    assert len({each["RESIDUAL"].mse for each in twenty_seeds.indices}) == 20
    assert len({each["MODEL"].mse for each in twenty_seeds.indices}) == 1  # it sees no noise


def test_result_does_not_depend_on_the_number_of_processes(twenty_seeds: Result) -> None:
    alone = one_seed("table1")
    assert alone.indices[0] == twenty_seeds.indices[0]
    one_process = reproduce(scenario("table1"), [1, 2], processes=1)
    assert one_process.indices == list(twenty_seeds.indices[:2])
    for series, other in (
        (alone.recording.plant, one_process.recording.plant),
        (
            alone.recording.estimators["RESIDUAL"],
            one_process.recording.estimators["RESIDUAL"],
        ),
    ):
        for output in series.values:
            np.testing.assert_array_equal(series[output], other[output])


def test_progress_counts_runs() -> None:
    done: list[int] = []
    reproduce(scenario("table1"), [1, 2, 3], progress=done.append)
    assert done == [1, 1, 1]


def test_constant_factors_show_what_the_enhanced_one_is_for() -> None:
    """Figure 8: one converges too slowly, the other quickly and then goes astray."""
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
    assert np.abs(np.diff(small[1000:])).max() < 0.01  # slow, but undisturbed
