"""Parsers read the Modelica package, its examples compile, and rumoca simulates its models.

rumoca cannot call C, so Modelica functions replace the C functions.
"""

import math
import re
import shutil
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pymoca.parser
import pytest
import rumoca
from numpy.typing import NDArray

import sigmahat
from c_sources import REPOSITORY
from fmi_instance import unpacked
from fmi_runs import OTHER_THAN_0, PLANTS
from modelica_package import FILES, NO_NOISE, PACKAGE, compiled, modification
from sigmahat.experiments.scenario import Sine, T
from sigmahat.fmi.master import Plant, simulate
from sigmahat.fmi.series import Series

SPECIAL = {
    "sigma": "estimator.reals[3] + t",  # the gear ratio identifies the motor
    "sigma_std": "tau_e_sensor",
    "phi": "q - theta",
    "setPoint": "theta_c",
    "epsilon": "tau",
    "eta": "zeros(8, 5)",
    "doubt": "if theta > 2 then Types.Doubt.OutOfRange elseif theta > 1 then Types.Doubt.Misfit"
    " elseif theta > 0.5 then Types.Doubt.NotExcited else Types.Doubt.None",
    "confident": "true",
    "valid": "theta < 10",
}
"""Values of some outputs of the test function. Each other output equals its index in the list."""


def outputs() -> list[str]:
    text = (PACKAGE / "Estimators" / "Internal.mo").read_text(encoding="utf-8")
    within = pymoca.parser.parse(text).classes["Sigmahat"].classes["Estimators"]
    tick = within.classes["Internal"].classes["tick"]
    return [name for name, each in tick.symbols.items() if "output" in each.prefixes]


@pytest.fixture(scope="module")
def package(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The package, with a record as external object and a Modelica algorithm as tick function."""
    copy = tmp_path_factory.mktemp("package") / "Sigmahat"
    shutil.copytree(PACKAGE, copy)
    file = copy / "Estimators" / "Internal.mo"
    text = file.read_text(encoding="utf-8")
    constructor = text[text.index("function constructor") : text.index("output Estimator")]
    fields = re.findall(r"^ *input (.*;)", constructor, re.MULTILINE)
    record = f"record Estimator {' '.join(fields)} end Estimator;"
    given = " ".join(
        f"{name} := {SPECIAL.get(name, number)};" for number, name in enumerate(outputs())
    )
    text, objects = re.subn(r"class Estimator .*?end Estimator;", record, text, flags=re.DOTALL)
    text, calls = re.subn(
        r'external "C" sigmahat_estimator_tick.*?C-Sources"\);',
        lambda _: f"algorithm {given}",
        text,
        flags=re.DOTALL,
    )
    assert (objects, calls) == (1, 1)
    file.write_text(text.replace("impure function tick", "function tick"), encoding="utf-8")
    return copy


def simulated(package: Path, block: str, values: Mapping[str, str], changed: str) -> Any:
    """Simulates a block for 50 ms; its inputs are Modelica expressions."""
    equations = " ".join(f"b.{name} = {value};" for name, value in values.items())
    text = f"model Test Sigmahat.Estimators.{block} b({changed}); equation {equations} end Test;"
    return compiled(text, package=package).simulate(t=(0.0, 0.05), dt=1e-3)


def test_two_parsers_read_every_file_without_error() -> None:
    for file in FILES:
        assert [each.message for each in rumoca.validate(file)] == []
        assert pymoca.parser.parse(file.read_text(encoding="utf-8")) is not None


@pytest.mark.parametrize(
    "example", sorted({file.stem for file in (PACKAGE / "Examples").glob("*.mo")} - {"package"})
)
def test_an_example_compiles(example: str, package: Path) -> None:
    text = f"model Test extends Sigmahat.Examples.{example}; end Test;"
    assert compiled(text, package=package)


def test_the_model_of_the_page_compiles(package: Path) -> None:
    page = (REPOSITORY / "docs" / "how-to" / "modelica.md").read_text(encoding="utf-8")
    ((text, name),) = re.findall(r"```modelica\n(model (\w+)\n.*?)```", page, re.DOTALL)
    assert compiled(text, name, package)


def test_ticks_are_at_the_start_time_and_every_sample_period_after_it(package: Path) -> None:
    inputs = {"theta": "time", "q": "3*time", "theta_c": "0", "tau": "0", "tau_e_sensor": "0"}
    changed = "samplePeriod=0.01, startTime=0.005"
    found = simulated(package, "StiffnessEstimator", inputs, changed)
    for moment in (0.002, 0.0052, 0.0148, 0.0152, 0.0448):
        row = int(np.searchsorted(found.time, moment + 1e-9)) - 1
        last = 0.005 + 0.01 * np.floor((moment - 0.005) / 0.01) if moment > 0.005 else None
        # Before the first tick, an output has its start value.
        assert found["b.sigma"][row] == pytest.approx(0 if last is None else 50 + last)
        assert found["b.phi"][row] == pytest.approx(0 if last is None else 2 * last)


def test_every_output_and_input_has_its_place(package: Path) -> None:
    inputs = {"theta": "0.1", "q": "0.3", "theta_c": "7", "tau": "8", "tau_e_sensor": "9"}
    found = simulated(package, "StiffnessEstimator", inputs, "motor(gamma=60)")
    expected = {"sigma": 60.05, "sigma_std": 9, "phi": 0.2, "setPoint_used": 7, "epsilon": 8}
    for number, name in enumerate(outputs()):
        if name not in SPECIAL:
            expected[name] = number
    for name, value in {**expected, "doubt": 1, "confident": 1, "valid": 1}.items():
        assert found[f"b.{name}"][-1] == pytest.approx(value), name


NONE, NOT_EXCITED, MISFIT, OUT_OF_RANGE = 1, 3, 4, 5


@pytest.mark.parametrize(
    ("theta", "sigma_std", "doubt"),
    [
        ((0.1, 0.1), 1.0, NONE),
        ((0.1, 0.1), 100.0, NOT_EXCITED),
        ((0.7, 0.1), 1.0, NONE),  # one motor may hardly move
        ((0.7, 0.1), 100.0, NOT_EXCITED),
        ((1.5, 0.1), 1.0, MISFIT),
        ((0.1, 2.5), 1.0, OUT_OF_RANGE),
        ((1.5, 2.5), 100.0, OUT_OF_RANGE),
    ],
)
def test_the_device_is_the_sum_of_its_sides(
    theta: tuple[float, float], sigma_std: float, doubt: int, package: Path
) -> None:
    """The block has the same output `doubt` as fmu_src/AntagonisticStiffnessEstimator.c."""
    inputs = {
        **{f"theta_{i}": str(value) for i, value in enumerate(theta, start=1)},
        **{"q": "0.3", "tau_1": "0.1", "tau_2": "0.2"},
        **{"tau_e_sensor_1": str(sigma_std), "tau_e_sensor_2": "0.5"},
    }
    changed = "motor_1(gamma=60), motor_2(gamma=70)"
    found = simulated(package, "AntagonisticStiffnessEstimator", inputs, changed)
    last = {name.removeprefix("b."): found[name][-1] for name in found.names}
    assert last["sigma"] == pytest.approx(60.05 + 70.05)
    assert (last["sigma_1"], last["sigma_2"]) == pytest.approx((60.05, 70.05))
    assert last["sigma_std"] == pytest.approx(np.hypot(sigma_std, 0.5))
    assert (last["side_1.phi"], last["side_2.phi"]) == pytest.approx(
        (0.3 - theta[0], 0.3 - theta[1])
    )
    assert (last["side_1.epsilon"], last["side_2.epsilon"]) == pytest.approx((0.1, 0.2))
    assert (last["doubt"], last["confident"], last["valid"]) == (doubt, doubt == NONE, True)


@pytest.mark.parametrize(
    ("changed", "expected"),
    [
        ("", (300.0, 350.0)),
        ("samplePeriod=0.01", (100.0, 100.0)),
        ("samplePeriod=0.01, regression(bandwidth=77)", (100.0, 77.0)),
        ("residual(K_I=20), samplePeriod=0.01", (20.0, 100.0)),
    ],
)
def test_rates_follow_the_sample_period_until_they_are_set(
    changed: str, expected: tuple[float, float]
) -> None:
    text = (
        f"model Test extends Sigmahat.Estimators.Settings({changed}); Real K_I, w; "
        "equation K_I = residual.K_I; w = regression.bandwidth; end Test;"
    )
    found = compiled(text).simulate(t=(0.0, 0.01), dt=1e-2)
    assert (found["K_I"][-1], found["w"][-1]) == expected


# The Modelica plants have the same outputs as the FMUs of the plants

AGREEMENT = 1e-6
"""Largest allowed difference of an output, relative to the range of this output."""


def fmu_variables(plant: str) -> dict[str, Any]:
    return {v.name: v for v in unpacked(sigmahat.fmu(plant))[0].modelVariables}


def outputs_of_fmu(
    plant: str, inputs: Mapping[str, Sine], start: Mapping[str, float], duration: float
) -> Series:
    """Simulates the FMU of a plant without noise and returns its outputs with the period T."""
    names = [n for n, v in fmu_variables(plant).items() if v.causality == "output"]
    silent = {"noise.tau_variance": 0.0, "noise.tau_e_variance": 0.0}
    model = Plant(plant, {**silent, **start}, inputs, names)
    return simulate(model, {}, T, round(duration / T)).plant


def run(
    plant: str, inputs: Mapping[str, Sine], start: Mapping[str, float], duration: float
) -> tuple[Series, dict[str, NDArray[np.float64]]]:
    """Simulates the FMU and the Modelica model of a plant without noise; returns both outputs."""
    recorded = outputs_of_fmu(plant, inputs, start, duration)
    equations = []
    for name, s in inputs.items():
        phase = f"{2 * math.pi * s.frequency!r}*time + {s.phase!r}"
        equations.append(f"p.{name} = {s.amplitude!r}*sin({phase});")
    changed = ", ".join(filter(None, (NO_NOISE, modification(**start))))
    text = (
        f"model Test Sigmahat.Plants.{plant} p({changed}); equation {' '.join(equations)} end Test;"
    )
    # The solver is explicit: the implicit solver of rumoca 0.10.2 fails at jumps of a derivative.
    config = rumoca.SimConfig(solver="rk-like", rtol=1e-11, atol=1e-13)
    result = compiled(text).simulate(t=(0.0, duration), dt=T, config=config)
    times = np.asarray(result.time)
    # If an event causes several rows at the same time, the last row is after the event.
    t = T * np.arange(round(duration / T) + 1)
    rows = np.searchsorted(times, t + 1e-9) - 1
    assert np.abs(times[rows] - t).max() < 1e-9
    return recorded, {n: np.asarray(result[f"p.{n}"])[rows] for n in recorded.values}


OTHER_VALUES = {
    "motor_c.B": 1e-6,
    "spring.knee_1": 5e-4,
    "spring.knee_2": 1e-3,
    "spring.step_at": 0.3,
    "spring.step_for": 0.4,
}
"""Values of parameters that would otherwise have hardly any effect."""


def other_values(plant: str) -> dict[str, float]:
    """Returns values different from the defaults for all parameters of a plant but its noise."""
    changed = {}
    for number, (name, v) in enumerate(fmu_variables(plant).items()):
        if v.causality == "parameter" and not name.startswith(("noise.", "signal.")):
            value = OTHER_VALUES.get(name) or float(v.start) or OTHER_THAN_0[v.unit]
            changed[name] = value * (1 + 0.1 * math.sin(number))
    return changed


def slow_inputs(plant: str) -> dict[str, Sine]:
    """Returns slow sines, because the FMU interpolates its inputs linearly over a step."""
    names = [n for n, v in fmu_variables(plant).items() if v.causality == "input"]
    amplitudes = {"tau_c": 8.0, "tau_1": 0.03, "tau_2": 0.03}
    return {n: Sine(amplitudes.get(n, 0.3), 0.05 + 0.01 * i, 0.3) for i, n in enumerate(names)}


@pytest.mark.parametrize(("as_it_starts", "duration"), [(True, 5.0), (False, 1.0)])
@pytest.mark.parametrize("plant", PLANTS)
def test_every_output_is_that_of_the_fmu(plant: str, as_it_starts: bool, duration: float) -> None:
    """The test shows that the equations of a plant in CasADi and in Modelica are equivalent."""
    start = {} if as_it_starts else other_values(plant)
    fmu, model = run(plant, slow_inputs(plant), start, duration)
    for name, values in model.items():
        error = np.abs(values - fmu[name])
        if name.startswith(("q_measured", "theta_measured", "theta_c_measured")):
            # A position halfway between two counts may be rounded to either count.
            counts = float(fmu.parameters[f"encoder.{name.replace('_measured', '')}"])
            apart = error * counts / (2 * math.pi)
            assert np.mean(apart > 1e-3) < 0.01 and apart.max() < 1.001, name
        else:
            assert error.max() <= AGREEMENT * np.ptp(fmu[name]), name


@pytest.mark.parametrize("plant", PLANTS)
def test_every_parameter_has_an_effect_that_this_shows(plant: str) -> None:
    every = other_values(plant)
    expected = outputs_of_fmu(plant, slow_inputs(plant), every, 1.0)
    for name in every:
        others = {n: value for n, value in every.items() if n != name}
        found = outputs_of_fmu(plant, slow_inputs(plant), others, 1.0)
        effect = [np.abs(found[n] - expected[n]).max() / np.ptp(expected[n]) for n in found.values]
        assert max(effect) > 30 * AGREEMENT, name


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
