"""The loop over samples: in C as in Python, to the last bit, and with FMUs of other makers."""

from __future__ import annotations

import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import sigmahat
from sigmahat.fmi import native
from sigmahat.fmi.instance import Fmu, FmuError, Slave
from sigmahat.fmi.master import EstimatorFmu, Plant, Recording, simulate
from sigmahat.fmi.sample_loop import SampleLoop
from sigmahat.paper.scenarios import SCENARIOS, scenario
from sigmahat.runs.scenario import Scenario, T

TABLE1 = scenario("table1")
MATCHED = {"method": "MatchedFilter"}


@pytest.fixture
def without_c(monkeypatch: pytest.MonkeyPatch) -> pytest.MonkeyPatch:
    """Call its undo() for the loop in C."""
    monkeypatch.setattr(native, "library", lambda: None)
    return monkeypatch


def test_the_library_is_installed() -> None:
    assert native.library() is not None


def short(whole: Scenario) -> Recording:
    """300 steps with all outputs of all FMUs."""

    def outputs(fmu: str) -> list[str]:
        with Fmu(sigmahat.fmu(fmu)) as opened:
            return [n for n, v in opened.variables.items() if v.causality == "output"]

    estimators = {**whole.estimators, **whole.variants}
    return simulate(
        replace(whole.plant, record=outputs(whole.plant.fmu)),
        {name: replace(e, record=outputs(e.fmu)) for name, e in estimators.items()},
        whole.T,
        300,
    )


@pytest.mark.parametrize("name", SCENARIOS)
def test_c_and_python_give_the_same_bits(name: str, without_c: pytest.MonkeyPatch) -> None:
    in_python = short(scenario(name))
    without_c.undo()
    in_c = short(scenario(name))
    every = [(in_python.plant, in_c.plant)]
    every += [(each, in_c.estimators[name]) for name, each in in_python.estimators.items()]
    for one, other in every:
        assert one.values.keys() == other.values.keys()
        for variable in one.values:
            np.testing.assert_array_equal(one[variable], other[variable], err_msg=variable)


def test_a_refused_step_ends_both_with_the_message_of_the_fmu(
    without_c: pytest.MonkeyPatch,
) -> None:
    def input_is_lost(t: np.typing.NDArray[np.float64]) -> np.typing.NDArray[np.float64]:
        return np.where(t < 0.0105, 0.1, np.nan)

    plant = replace(TABLE1.plant, inputs={"tau": input_is_lost})
    messages = []
    for _ in range(2):
        with pytest.raises(FmuError, match=r"Step from t = 0\.01 s refused.* finite") as caught:
            simulate(plant, {}, T, 20)
        messages.append(str(caught.value))
        without_c.undo()
    assert messages[0] == messages[1]


def test_calls_are_made_in_their_order_up_to_the_one_that_fails() -> None:
    with Fmu(sigmahat.fmu("StiffnessEstimator")) as fmu, Slave(fmu, "one") as slave:
        slave.initialize({})
        table, loop = np.zeros((5, 1)), SampleLoop()
        times = np.column_stack([T * np.arange(5.0), np.full(5, T)])
        times[3, 1] = -1.0
        loop.set_real(slave, fmu.references(["theta"], "input"), np.arange(5.0)[:, None])
        loop.step(slave, times)
        loop.get_real(slave, fmu.references(["theta"]), table)
        with pytest.raises(FmuError, match="fmi2DoStep"):
            loop.run(0, 5)
    assert table[:, 0].tolist() == [0.0, 1.0, 2.0, 0.0, 0.0]


def test_a_table_must_be_contiguous() -> None:
    with (
        Fmu(sigmahat.fmu("StiffnessEstimator")) as fmu,
        Slave(fmu, "one") as slave,
        pytest.raises(ValueError, match="C-contiguous"),
    ):
        SampleLoop().set_real(slave, fmu.references(["theta", "q"]), np.zeros((2, 5)).T)


def pythonfmu(script: str, folder: Path) -> str:
    """An FMU that PythonFMU makes of a script."""
    subprocess.run(
        [sys.executable, "-m", "pythonfmu", "build", "-f", script, "-d", folder],
        check=True,
        capture_output=True,
    )
    (made,) = folder.glob("*.fmu")
    return str(made)


def test_an_estimator_of_another_maker(tmp_path: Path) -> None:
    script = Path(__file__).parents[2] / "bench" / "paper2011_slave.py"
    ours = TABLE1.estimators["RESIDUAL"]
    theirs = EstimatorFmu(
        pythonfmu(str(script), tmp_path), {}, ours.connections, ["sigma", "theta_dot"]
    )
    found = simulate(TABLE1.plant, {"ours": ours, "theirs": theirs}, T, 1500).estimators
    late = slice(1000, None)
    np.testing.assert_allclose(
        found["theirs"]["sigma"][late], found["ours"]["sigma"][late], rtol=1e-3
    )


def test_a_plant_of_another_maker_that_takes_no_slopes(tmp_path: Path) -> None:
    script = tmp_path / "integrator.py"
    script.write_text(
        """
from pythonfmu import Boolean, Fmi2Causality, Fmi2Slave, Fmi2Variability, Integer, Real

class Integrator(Fmi2Slave):
    def __init__(self, **kwargs):
        super().__init__(**kwargs)
        self.u, self.x, self.steps, self.far = 0.0, 0.0, 0, False
        self.register_variable(Real("u", causality=Fmi2Causality.input))
        self.register_variable(Real("x", causality=Fmi2Causality.output))
        kind = dict(causality=Fmi2Causality.output, variability=Fmi2Variability.discrete)
        self.register_variable(Integer("steps", **kind))
        self.register_variable(Boolean("far", **kind))

    def do_step(self, t, h):
        self.x += self.u * h
        self.steps += 1
        self.far = self.x > 0.25
        return True
"""
    )
    plant = Plant(pythonfmu(str(script), tmp_path), {}, {"u": lambda t: t}, ["x", "steps", "far"])
    h, steps = 0.01, 100
    found = simulate(plant, {}, h, steps).plant
    k = np.arange(steps + 1)
    x = h * h * k * (k - 1) / 2  # inputs that are held: a sum, and not the integral
    np.testing.assert_allclose(found["x"], x, rtol=0, atol=1e-12)
    np.testing.assert_array_equal(found["steps"], k)
    np.testing.assert_array_equal(found["far"], x > 0.25)


def test_a_string_cannot_be_recorded(tmp_path: Path) -> None:
    script = tmp_path / "named.py"
    script.write_text(
        """
from pythonfmu import Fmi2Causality, Fmi2Slave, Fmi2Variability, String

class Named(Fmi2Slave):
    def __init__(self, **kwargs):
        super().__init__(**kwargs)
        self.label = "a"
        kind = dict(causality=Fmi2Causality.output, variability=Fmi2Variability.discrete)
        self.register_variable(String("label", **kind))

    def do_step(self, t, h):
        return True
"""
    )
    plant = Plant(pythonfmu(str(script), tmp_path), {}, {}, ["label"])
    with pytest.raises(ValueError, match=r"Named\.label: a String cannot be recorded"):
        simulate(plant, {}, 0.1, 1)
