"""The plants of the Modelica package, run by rumoca, move as their FMUs do."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest
import rumoca
from numpy.typing import NDArray

import sigmahat
from c_sources import REPOSITORY
from modelica_package import NO_NOISE, compiled, modification
from sigmahat.export.templates import render, variables
from sigmahat.fmi.master import Plant, simulate
from sigmahat.fmi.series import Series
from sigmahat.paper.scenarios import SECTION_VI_B, scenario
from sigmahat.runs.scenario import Sine, T

AGREEMENT = 1e-6
"""Greatest difference of a state, relative to its range."""
STATES = {
    "AwasPlant": ("q", "q_dot", "theta", "theta_dot", "theta_c", "theta_c_dot"),
    "FlexibleJointPlant": ("q", "q_dot", "theta", "theta_dot"),
    "AntagonisticVsaPlant": ("q", "q_dot", "theta_1", "theta_dot_1", "theta_2", "theta_dot_2"),
    "RealJointPlant": ("q", "q_dot", "theta", "theta_dot"),
}
each_plant = pytest.mark.parametrize("plant", STATES)


def inputs_of_table1(plant: str) -> dict[str, Sine]:
    """The torque of Table I on every motor, and that of the secondary motor where there is one."""
    if plant == "AwasPlant":
        inputs = scenario("table1").plant.inputs
        return {name: each for name, each in inputs.items() if isinstance(each, Sine)}
    if plant == "AntagonisticVsaPlant":  # its springs are softer
        return {"tau_1": Sine(0.03, 0.1), "tau_2": Sine(0.02, 0.1, 1.0)}
    return {"tau": SECTION_VI_B}


@dataclass(frozen=True)
class Both:
    """One run of a plant in both forms."""

    fmu: Series
    """Of the FMU, at every T."""
    modelica: Mapping[str, NDArray[np.float64]]
    """The same variables of the model, at the same times."""

    def difference(self, name: str) -> float:
        """The greatest difference of a variable, relative to its range."""
        reference = self.fmu[name]
        return float(np.abs(self.modelica[name] - reference).max() / np.ptp(reference))


def fmu_variables(plant: str) -> dict[str, Any]:
    root = render(REPOSITORY / "modelDescription" / f"{plant}.xml", sigmahat.__version__)
    return {str(v.get("name")): v for v in variables(root)}


def run(
    plant: str, inputs: Mapping[str, Sine], start: Mapping[str, float], duration: float
) -> Both:
    """Both forms from the same parameters, the FMU without noise."""
    declared = fmu_variables(plant)
    names = [n for n, v in declared.items() if v.get("causality") == "output"]
    silent = {"noise.tau_variance": 0.0, "noise.tau_e_variance": 0.0}
    recording = simulate(
        Plant(plant, {**silent, **start}, inputs, names), {}, T, round(duration / T)
    )
    constants = {
        n: float(v[0].get("start"))
        for n, v in declared.items()
        if v.get("causality") == "input" and n not in inputs
    }
    equations = [f"p.{name} = {value!r};" for name, value in constants.items()]
    for name, s in inputs.items():
        phase = f"{2 * math.pi * s.frequency!r}*time + {s.phase!r}"
        equations.append(f"p.{name} = {s.amplitude!r}*sin({phase});")
    changed = ", ".join(filter(None, (NO_NOISE, modification(**start))))
    text = (
        f"model Test Sigmahat.Plants.{plant} p({changed}); equation {' '.join(equations)} end Test;"
    )
    # Its explicit solver: the implicit one of rumoca 0.10.2 stops at jumps of a derivative.
    config = rumoca.SimConfig(solver="rk-like", rtol=1e-11, atol=1e-13)
    result = compiled(text).simulate(t=(0.0, duration), dt=T, config=config)
    times = np.asarray(result.time)
    # Several rows at the time of an event: the last one is after it.
    rows = np.searchsorted(times, recording.t + 1e-9) - 1
    assert np.abs(times[rows] - recording.t).max() < 1e-9
    return Both(recording.plant, {n: np.asarray(result[f"p.{n}"])[rows] for n in names})


@each_plant
def test_under_the_torques_of_table1_each_state_is_that_of_the_fmu(plant: str) -> None:
    """For half a period, from the start values."""
    both = run(plant, inputs_of_table1(plant), {}, 5.0)
    assert {name: both.difference(name) for name in STATES[plant]} == pytest.approx(
        dict.fromkeys(STATES[plant], 0.0), abs=AGREEMENT
    )


OTHERWISE = {
    **{"1": 0.05, "s": 1e-3, "m": 0.05, "rad": 2e-3, "rad/s": 0.5, "N/m": 300.0},
    **{"N.m": 0.02, "N.m/rad": 5.0, "N.m/rad3": 100.0, "N.m.s/rad": 0.02},
}
"""Values by unit for what is 0 at the start, so that it has an effect."""


def other_values(plant: str) -> dict[str, float]:
    """Every parameter of the plant other than it is, but for the noise."""
    changed = {}
    for number, (name, v) in enumerate(fmu_variables(plant).items()):
        if v.get("causality") == "parameter" and not name.startswith(("noise.", "signal.")):
            value = float(v[0].get("start"))
            factor = 1 + 0.1 * math.sin(number)
            changed[name] = value * factor if value else OTHERWISE[v[0].get("unit")] * factor
    return changed


@each_plant
def test_every_parameter_and_input_has_the_effect_that_it_has_in_the_fmu(plant: str) -> None:
    names = [n for n, v in fmu_variables(plant).items() if v.get("causality") == "input"]
    amplitude = 0.03 if plant == "AntagonisticVsaPlant" else 0.3
    # Slow ones: the FMU takes them as linear over a step.
    inputs = {n: Sine(amplitude, 0.05 + 0.01 * i, 0.3) for i, n in enumerate(names)}
    start = other_values(plant)
    both = run(plant, inputs, start, 1.0)
    for name in both.modelica:
        if name.startswith(("q_measured", "theta_measured", "theta_c_measured")):
            # A position next to the border of two counts may be rounded to either of them.
            counts = start[f"encoder.{name.replace('_measured', '')}"]
            apart = np.abs(both.modelica[name] - both.fmu[name]) * counts / (2 * math.pi)
            assert np.mean(apart > 1e-3) < 0.01 and apart.max() < 1.001, name
        else:
            assert both.difference(name) < AGREEMENT, name


NOISE = """package Own
  function draw
    extends Sigmahat.Plants.partialNoise;
  algorithm
    normal := k + 100*channel + 1000*seed;
  end draw;
  model Test
    Sigmahat.Plants.AntagonisticVsaPlant p(
      noise(seed=3, tau_variance=4, tau_e_variance=9, samplePeriod=0.01),
      redeclare function drawNoise = draw);
  equation
    p.tau_1 = 0;
    p.tau_2 = 0;
    p.tau_ext = 0;
  end Test;
end Own;"""


def test_noise_is_drawn_every_sample_period_from_a_channel_for_each_signal() -> None:
    result = compiled(NOISE, "Own.Test").simulate(t=(0.0, 0.05), dt=T)
    noisy = {"tau_measured": 2, "tau_e_measured": 3}
    signals = [(f"{n}_{i}", deviation) for i in (1, 2) for n, deviation in noisy.items()]
    for moment, k in ((0.001, 0), (0.0098, 0), (0.0102, 1), (0.0398, 3)):
        row = int(np.searchsorted(result.time, moment + 1e-9)) - 1
        for channel, (name, deviation) in enumerate(signals):
            assert result[f"p.{name}"][row] == deviation * (k + 100 * channel + 3000), name
