"""Tunable parameters that are changed during a run: they act at once and change nothing else."""

import random
from collections.abc import Mapping, Sequence
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import sigmahat
from c_library import MEASUREMENTS, Estimator, load
from fmi_instance import OK, unpacked
from fmi_runs import ESTIMATORS, FMI2, OTHER_THAN_0, PLANTS, SIGNALS, Fmi, names
from regression_joint import WITHOUT_MISFITS

T = 1e-3  # s
STEPS = 260  # a second pass begins after 0.2 s
CHANGE = random.Random(4).randrange(20, 40)  # the parameter is changed before this step
SIDES = {"StiffnessEstimator": [""], "AntagonisticStiffnessEstimator": ["_1", "_2"]}
# Start values with which a parameter has an effect; the others have one with the defaults.
CONFIGURATION: dict[str, dict[str, float]] = {
    "filter.R": {"filter.kind": 2},
    "filter.V_max": {"encoder.theta": 2000},  # so the motion is slow in counts
    "filter.alpha": {"encoder.theta": 2000},
    "model.k_s": {"modality": 3},
    "model.r_0": {"modality": 3},
    "model.b": {"modality": 3},
    "noise.tau_e": {"modality": 2},
    "motor.uneven": {"motor.tau_coulomb": 0.02},
    "motor.stribeck": {"motor.tau_coulomb": 0.02, "motor.v_stribeck": 5.0},
    # With the torque from tau, the stiffness is negative here.
    "limit.relative_std": {"limit.relative_std": 1e12, "modality": 2},
    # So few columns that two passes take less than the run.
    "regression.drift": {"rls.n": 1, "rls.m": 1, **WITHOUT_MISFITS},
}
# Start values for each method. SIGNALS start in motion, from which a fast filter soon settles; the
# estimator makes it slower than regression.bandwidth unless the encoder is fine.
FAST = {"method": 2, "regression.bandwidth": 1900, "encoder.theta": 4e6}
METHODS: dict[int, dict[str, float]] = {1: {}, 2: FAST}
# The parameter has its effect at the end of a pass, and not already at the next tick.
LATER = "regression.drift"
# New values for parameters for which 1.5 times the start value has too little effect.
CHANGED = {
    "modality": 2,
    "limit.relative_std": 1e-12,
    "regression.slow": 1e3,
    "torque.held": 1,
    "motor_c.B": 1.29e-6,
}


def other_value(name: str, variable: Any) -> float:
    """A value that changes the effect of a parameter."""
    if name in CHANGED:
        return CHANGED[name]
    return 1.5 * float(variable.start) or OTHER_THAN_0[variable.unit]


SCALARS = [
    v.name
    for v in unpacked(sigmahat.fmu("StiffnessEstimator"))[0].modelVariables
    if v.causality == "output" and "[" not in v.name and v.name != "valid"
]
ETA = [(i, j) for i in range(8) for j in range(5)]


def tunables(fmus: list[str]) -> list[tuple[str, str]]:
    return [
        (fmu, variable.name)
        for fmu in fmus
        for variable in unpacked(sigmahat.fmu(fmu))[0].modelVariables
        if variable.variability == "tunable"
    ]


def run_fmu(
    fmu: str, outputs: Sequence[str], start: Mapping[str, float], change: Mapping[str, float]
) -> list[list[float]]:
    """Outputs after every step. Parameters are changed before step number CHANGE."""
    results = []
    with FMI2(fmu).initialise(start) as instance:
        inputs = names(instance, "input")
        for k in range(STEPS):
            if k == CHANGE:
                instance.set_all(change)
            instance.set_all({name: SIGNALS[name](k * T) for name in inputs})
            assert instance.step(k * T, T) == OK, instance.messages
            results.append(instance.get_all(outputs))
    return results


@cache
def unchanged_run(
    fmu: str, outputs: tuple[str, ...], start: tuple[tuple[str, float], ...]
) -> list[list[float]]:
    """The same without a change: most tests begin alike."""
    return run_fmu(fmu, outputs, dict(start), {})


def run_library(
    build: Path, side: str, start: Mapping[str, float], change: Mapping[str, float]
) -> list[list[float]]:
    """The same for an estimator of the library, with inputs and motor of one side of the FMU."""
    estimator = Estimator(load(build), start)
    signals = [SIGNALS.get(name + side, SIGNALS[name]) for name in MEASUREMENTS]
    z = np.array([[signal(k * T) for signal in signals] for k in range(STEPS)])
    if side:
        z[:, MEASUREMENTS.index("theta_c")] = 0.0
    before = estimator.run(z[:CHANGE])
    for name, value in change.items():
        own = name.replace(f"motor{side}.", "motor.")
        if not own.startswith("motor_"):  # that of the other side
            estimator.library.set(estimator.parameters, own, value)
    found = np.concatenate([before, estimator.run(z[CHANGE:])])
    assert found["valid"].all()
    return [[*(row[name] for name in SCALARS), *row["eta"].ravel()] for row in found]


def methods(name: str) -> list[int]:
    """The methods in which a parameter has an effect."""
    if name.startswith(("residual.", "filter.")):
        return [1]
    if name == "regression.memory":
        return []  # acts on a misfit, which shows after four blocks of 50 ms
    return [2] if name.startswith(("regression.", "torque.", "limit.relative_std")) else [1, 2]


@pytest.mark.parametrize(
    ("fmu", "name", "method"),
    [(fmu, name, method) for fmu, name in tunables(ESTIMATORS) for method in methods(name)],
)
def test_an_estimator_continues_like_the_library_with_the_new_value(
    fmu: str, name: str, method: int, build: Path
) -> None:
    sides = SIDES[fmu]
    outputs = [
        output
        for side in sides
        for output in [f"{n}{side}" for n in SCALARS] + [f"eta{side}[{i},{j}]" for i, j in ETA]
    ]
    start: Mapping[str, float] = METHODS[method] | CONFIGURATION.get(name, {})
    with FMI2(fmu) as instance:
        value = other_value(name, instance.variables[name])
    with_change = run_fmu(fmu, outputs, start, {name: value})
    without = unchanged_run(fmu, tuple(outputs), tuple(start.items()))
    assert with_change[:CHANGE] == without[:CHANGE]
    assert with_change != without
    assert name == LATER or with_change[CHANGE] != without[CHANGE]  # already at the next tick

    runs = [run_library(build, side, start, {name: value}) for side in sides]
    expected = [[value for row in rows for value in row] for rows in zip(*runs, strict=True)]
    assert with_change == expected


@pytest.mark.parametrize(("fmu", "name"), tunables(PLANTS))
def test_a_plant_continues_from_its_state_with_the_new_value(fmu: str, name: str) -> None:
    """The plant then moves like another plant that starts in this state with the new value."""
    with FMI2(fmu) as instance:
        variables = instance.variables
        outputs = names(instance, "output")
        value = other_value(name, variables[name])
        exact = {n: 0.0 for n in variables if n.endswith("_variance") or n.startswith("encoder.")}
        exact |= CONFIGURATION.get(name, {})
        states = [n.removeprefix("initial.") for n in variables if n.startswith("initial.")]
    with_change = np.array(run_fmu(fmu, outputs, exact, {name: value}))
    without = np.array(unchanged_run(fmu, tuple(outputs), tuple(exact.items())))
    np.testing.assert_array_equal(with_change[:CHANGE], without[:CHANGE])
    assert (with_change[CHANGE] != without[CHANGE]).any()  # already in the next step

    at_change = dict(zip(outputs, with_change[CHANGE - 1], strict=True))
    with FMI2(fmu) as other:
        other.initialise(
            exact | {f"initial.{n}": at_change[n] for n in states} | {name: value}, start=CHANGE * T
        )
        expected = []
        for k in range(CHANGE, STEPS):
            other.set_all({n: SIGNALS[n](k * T) for n in names(other, "input")})
            assert other.step(k * T, T) == OK, other.messages
            expected.append(other.get_all(outputs))
    scale = np.max(np.abs(with_change), axis=0)
    scale[scale == 0.0] = 1.0
    error = np.abs(with_change[CHANGE:] - expected) / scale
    effect = np.abs(with_change[CHANGE:] - without[CHANGE:]) / scale
    # The internal steps differ, so the error is that of the integrator: its tolerance for one step.
    assert error.max() < 1e-8
    assert effect.max() > 1e-7


# Start values that follow another parameter

RATES = {"residual.K_I": 300.0, "regression.bandwidth": 350.0}


@pytest.mark.parametrize("name", ESTIMATORS)
@pytest.mark.parametrize("period", [1e-3, 1 / 320, 0.01, 2.0])
@pytest.mark.parametrize("method", [1, 2])
def test_the_sample_period_alone_is_enough(fmi: Fmi, name: str, period: float, method: int) -> None:
    expected = {rate: min(start, 1 / period) for rate, start in RATES.items()}
    with fmi(name).initialise({"method": method, "samplePeriod": period}) as fmu:
        assert {rate: fmu.get(rate) for rate in RATES} == expected
        assert fmu.step(0.0, period) == OK
        assert fmu.call("Reset") == OK
        fmu.initialise()
        assert {rate: fmu.get(rate) for rate in RATES} == RATES


@pytest.mark.parametrize("before", [True, False])
def test_a_rate_that_was_set_does_not_follow_the_sample_period(fmi: Fmi, before: bool) -> None:
    """Even if it was set to its start value, and by an importer that restores a state."""
    set_first = {"residual.K_I": 50.0, "samplePeriod": 0.01}
    with fmi() as fmu:
        fmu.set_all(set_first if before else dict(reversed(set_first.items())))
        state = fmu.save()
        fmu.set_all({"samplePeriod": 0.02})
        assert fmu.enter() == OK
        assert (fmu.get("residual.K_I"), fmu.get("regression.bandwidth")) == (50.0, 50.0)
        fmu.set_all({"samplePeriod": 0.004})
        assert (fmu.get("residual.K_I"), fmu.get("regression.bandwidth")) == (50.0, 250.0)
        assert fmu.restore(state) == OK
        fmu.set_all({"samplePeriod": 1e-3})
        assert fmu.enter() == OK
        assert (fmu.get("residual.K_I"), fmu.get("regression.bandwidth")) == (50.0, 350.0)
        fmu.free(state)
    with fmi() as fmu:
        fmu.set_all({"residual.K_I": 300.0, "samplePeriod": 0.01})
        assert fmu.enter() == OK and fmu.exit() != OK
        assert "residual.K_I = 300" in fmu.last_message


def test_the_library_and_the_estimator_of_python_have_the_same_rule(build: Path) -> None:
    library = load(build)
    for period in (1e-3, 1 / 320, 0.01):
        p = library.ffi.new("sh_parameters *")
        library.lib.sh_parameters_default_at(p, period)
        present = sigmahat.Estimator({"samplePeriod": period}).parameters[0]
        for rate, start in RATES.items():
            group, name = rate.split(".")
            assert getattr(getattr(p, group), name) == present[rate] == min(start, 1 / period)
        assert library.violation(p) is None
    own = {"samplePeriod": 0.01, "regression.bandwidth": 120.0}
    assert sigmahat.Estimator(own).parameters[0]["regression.bandwidth"] == 120.0
