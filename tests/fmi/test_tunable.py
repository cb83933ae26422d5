"""Tunable parameters that are changed during a run: they act at once and change nothing else."""

from __future__ import annotations

import random
from collections.abc import Mapping
from pathlib import Path

import fmpy
import numpy as np
import pytest

import sigmahat
from c_library import MEASUREMENTS, Estimator, load
from fmi_instance import OK, Instance
from fmi_runs import ESTIMATORS, PLANTS, SIGNALS, names

T = 1e-3  # s
STEPS = 60
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
    "spring.k_knee_1": {"spring.knee_1": 0.0},
    "spring.k_knee_2": {"spring.knee_2": 0.0},
    "motor.stribeck": {"motor.tau_coulomb": 0.02, "motor.v_stribeck": 5.0},
    "limit.relative_std": {
        "limit.relative_std": 1e12,
        "modality": 2,
    },  # by tau the stiffness is negative
    "regression.drift": {  # so few columns that a pass takes less than the run
        "rls.n": 1,
        "rls.m": 1,
        **{f"prior.{name}": 0 for name in ("bias", "damping", "load_friction", "eccentric")},
        **{f"prior.{name}": 0 for name in ("delay", "reversal", "power", "gap", "hysteresis")},
        "prior.eccentric_motor": 0,
    },
}
# Start values for each method. SIGNALS start in motion, from which a fast filter soon settles; the
# estimator makes it slower than regression.bandwidth unless the encoder is fine.
FAST = {"method": 2, "regression.bandwidth": 1900, "encoder.theta": 4e6}
METHODS: dict[int, dict[str, float]] = {1: {}, 2: FAST}
# Has its effect at the end of a pass, and not already at the next tick.
LATER = "regression.drift"
# The new value if 1.5 times the start value is the same, or has too little effect.
CHANGED = {
    "modality": 2,
    "limit.relative_std": 1e-12,
    "regression.slow": 1e3,
    "regression.drift": 1.0,
    "torque.held": 1,
    "motor_c.B": 1.29e-6,
    "spring.k_3": 1e4,
    "link.tau_coulomb": 0.05,
    "link.mgl": 1.0,
    "motor.tau_coulomb": 0.02,
    "motor_1.tau_coulomb": 0.02,
    "motor_2.tau_coulomb": 0.02,
    "motor.v_bend": 0.1,
    "motor.uneven": 0.2,
    "motor.load_friction": 0.2,
    "motor.stribeck": 0.5,
    "motor.cogging": 0.01,
    "motor.ripple": 0.1,
    "motor.lugre": 0.02,
    "motor.lugre_load": 0.1,
    "gear.kinematic_error": 3e-4,
    "spring.k_s": 1e4,
    "spring.k_knee_1": 50.0,
    "spring.k_knee_2": 50.0,
    "spring.k_step": 0.5,
    "spring.gap": 1e-4,
    "spring.damping": 1e-3,
    "spring.dahl": 0.1,
    "contact.k": 1e3,
    "contact.d": 10.0,
    "sensor.tau_bias": 0.01,
}
SCALARS = [
    v.name
    for v in fmpy.read_model_description(str(sigmahat.fmu("StiffnessEstimator"))).modelVariables
    if v.causality == "output" and "[" not in v.name and v.name != "valid"
]
ETA = [(i, j) for i in range(8) for j in range(5)]


def tunables(fmus: list[str]) -> list[tuple[str, str]]:
    return [
        (fmu, variable.name)
        for fmu in fmus
        for variable in fmpy.read_model_description(str(sigmahat.fmu(fmu))).modelVariables
        if variable.variability == "tunable"
    ]


def run_fmu(
    fmu: str, outputs: list[str], start: Mapping[str, float], change: Mapping[str, float]
) -> list[list[float]]:
    """Outputs after every step. Parameters are changed before step number CHANGE."""
    results = []
    with Instance(sigmahat.fmu(fmu)) as instance:
        instance.initialise(start)
        inputs = names(instance, "input")
        for k in range(STEPS):
            if k == CHANGE:
                instance.set_all(change)
            instance.set_all({name: SIGNALS[name](k * T) for name in inputs})
            assert instance.step(k * T, T) == OK, instance.messages
            results.append(instance.get_all(outputs))
    return results


def run_library(
    build: Path, side: str, start: Mapping[str, float], change: Mapping[str, float]
) -> list[list[float]]:
    """The same for an estimator of the library, with inputs and motor of one side of the FMU."""
    estimator = Estimator(load(build), start)
    results = []
    for k in range(STEPS):
        if k == CHANGE:
            for name, value in change.items():
                group, dot, last = name.rpartition(".")
                if group in ("motor_1", "motor_2"):
                    if not group.endswith(side):
                        continue
                    group = "motor"
                estimator.library.set(estimator.parameters, group + dot + last, value)
        signals = {name: SIGNALS.get(name + side) or SIGNALS[name] for name in MEASUREMENTS}
        if side:
            signals["theta_c"] = lambda t: 0.0
        assert estimator.tick([signals[name](k * T) for name in MEASUREMENTS])
        estimate = estimator.estimate
        results.append(
            [getattr(estimate, name) for name in SCALARS] + [estimate.eta[i][j] for i, j in ETA]
        )
    return results


def methods(name: str) -> list[int]:
    """The methods in which a parameter has an effect."""
    if name.startswith(("residual.", "filter.")):
        return [1]
    if name == "regression.memory":
        return []  # it acts on a misfit, which takes 20 blocks of 50 ms to be seen
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
    with Instance(sigmahat.fmu(fmu)) as instance:
        value = CHANGED[name] if name in CHANGED else 1.5 * float(instance.variables[name].start)
    with_change = run_fmu(fmu, outputs, start, {name: value})
    without = run_fmu(fmu, outputs, start, {})
    assert with_change[:CHANGE] == without[:CHANGE]
    assert with_change != without
    assert name == LATER or with_change[CHANGE] != without[CHANGE]  # already at the next tick

    runs = [run_library(build, side, start, {name: value}) for side in sides]
    expected = [[value for row in rows for value in row] for rows in zip(*runs, strict=True)]
    assert with_change == expected


@pytest.mark.parametrize(("fmu", "name"), tunables(PLANTS))
def test_a_plant_continues_from_its_state_with_the_new_value(fmu: str, name: str) -> None:
    """Like another plant that has the new value from the start and starts in that state."""
    with Instance(sigmahat.fmu(fmu)) as instance:
        variables = instance.variables
        outputs = names(instance, "output")
        value = CHANGED.get(name, 1.5 * float(variables[name].start))
        exact = {n: 0.0 for n in variables if n.endswith("_variance") or n.startswith("encoder.")}
        exact |= CONFIGURATION.get(name, {})
        states = [n.removeprefix("initial.") for n in variables if n.startswith("initial.")]
    with_change = np.array(run_fmu(fmu, outputs, exact, {name: value}))
    without = np.array(run_fmu(fmu, outputs, exact, {}))
    np.testing.assert_array_equal(with_change[:CHANGE], without[:CHANGE])
    assert (with_change[CHANGE] != without[CHANGE]).any()  # already in the next step

    at_change = dict(zip(outputs, with_change[CHANGE - 1], strict=True))
    with Instance(sigmahat.fmu(fmu)) as other:
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
