"""A twin of FMI 3.0 does the same as the FMU of FMI 2.0, and as itself after a reset or a copy."""

from __future__ import annotations

import random
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from pathlib import Path

import pytest

import sigmahat
from fmi3_instance import HeldInputs, Instance3, driver3
from fmi_instance import ERROR, OK, Instance
from fmi_runs import ESTIMATORS, PLANTS, continue_from, names, random_steps

every_fmu = pytest.mark.parametrize("name", ESTIMATORS + PLANTS)
STEPS = random_steps(120, seed=1)
POINTS = random.Random(3).sample(range(len(STEPS)), 50)
Twin = Callable[[str], Path]


@pytest.mark.parametrize(
    ("name", "start"),
    [*((n, {"method": m}) for n in ESTIMATORS for m in (1, 2)), *((n, {}) for n in PLANTS)],
)
def test_both_versions_give_the_same_bits(name: str, start: dict[str, float], twin: Twin) -> None:
    with Instance(sigmahat.fmu(name)) as old, Instance3(twin(name)) as new:
        new_run = driver3(new)
        old_run = HeldInputs(old, new_run.inputs, new_run.outputs)
        for fmu in (old, new):
            fmu.initialise(start)
        assert new_run.result() == old_run.result()
        assert len(new_run.outputs) >= 10
        for t, h in STEPS:
            assert new_run.step(t, h) == old_run.step(t, h)
        arrays = [n for n, v in new.variables.items() if v.dimensions]
        assert len(arrays) == {"StiffnessEstimator": 2, ESTIMATORS[1]: 3}.get(name, 0)
        for array in arrays:
            of_array = [n for n in old.variables if n.startswith(array + "[")]
            assert new.elements(array) == old.get_all(of_array)
        for other in ("doubt", "confident", "valid") if name in ESTIMATORS else ():
            for side in ("", "_1", "_2"):
                if other + side in old.variables:
                    assert new.get(other + side) == old.get(other + side)


def test_a_state_goes_from_one_version_to_the_other(
    estimator_twin: Path, estimator_fmu: Path
) -> None:
    with Instance(estimator_fmu) as old, Instance3(estimator_twin) as new:
        new_run = driver3(new)
        old_run = HeldInputs(old, new_run.inputs, new_run.outputs)
        old.initialise({"rls.n": 3})
        old_run.run(STEPS[:40])
        state = old.save()
        status, copied = new.deserialise(old.serialise(state))
        assert status == OK and new.restore(copied) == OK
        assert new_run.run(STEPS[40:]) == old_run.run(STEPS[40:])
        old.free(state)
        new.free(copied)


@every_fmu
def test_an_instance_after_a_reset_is_like_a_new_one(name: str, twin: Twin) -> None:
    with Instance3(twin(name)) as fmu:
        driver = driver3(fmu)
        fmu.initialise()
        initial, fresh = driver.result(), driver.run(STEPS)
    with Instance3(twin(name)) as fmu:
        driver = driver3(fmu)
        tunable = [n for n in names(fmu, "parameter", "tunable") if fmu.length(n) == 1][:3]
        other = {n: 1.5 * float(fmu.variables[n].start) for n in tunable}
        for point in POINTS[:10]:
            fmu.initialise(other, start=3.7)  # values that the reset has to replace
            driver.run([(3.7 + t, h) for t, h in STEPS[:point]])
            assert fmu.call("fmi3Reset") == OK
            fmu.initialise()
            assert driver.result() == initial
            assert driver.run(STEPS) == fresh
            assert fmu.call("fmi3Reset") == OK


@every_fmu
def test_a_restored_state_continues_bit_for_bit(name: str, twin: Twin) -> None:
    with Instance3(twin(name)) as fmu:
        driver = driver3(fmu)
        fmu.initialise()
        states, serialised, results, whole = {}, {}, {}, []
        for k, step in enumerate(STEPS):
            if k in POINTS:
                states[k], results[k] = fmu.save(), driver.result()
                serialised[k] = fmu.serialise(states[k])
            whole.append(driver.step(*step))
        for point in POINTS:
            assert fmu.restore(states[point]) == OK
            assert driver.result() == results[point]
            assert driver.run(STEPS[point:]) == whole[point:]
            fmu.free(states[point])
    with ProcessPoolExecutor(1, get_context("spawn")) as process:
        continued = process.submit(
            continue_from,
            twin(name),
            [serialised[p] for p in POINTS],
            [STEPS[p:] for p in POINTS],
            Instance3,
            driver3,
        ).result()
    for point, result in zip(POINTS, continued, strict=True):
        assert result == whole[point:]


@every_fmu
def test_a_damaged_or_foreign_state_is_refused(name: str, twin: Twin) -> None:
    foreign_name = "AwasPlant" if name != "AwasPlant" else "StiffnessEstimator"
    with Instance3(twin(name)) as fmu, Instance3(twin(foreign_name)) as other:
        driver = driver3(fmu)
        fmu.initialise()
        driver.run(STEPS[:5])
        state, foreign_state = fmu.save(), other.save()
        good, foreign = fmu.serialise(state), other.serialise(foreign_state)
        other.free(foreign_state)
        source = random.Random(4)
        flips = [source.randrange(len(good)) for _ in range(200)]
        damaged = [good[:i] + bytes([good[i] ^ 0x10]) + good[i + 1 :] for i in flips]
        for data in (good[:-1], good[:10], b"", good + b"x", foreign, *damaged):
            status, made = fmu.deserialise(data)
            assert status == ERROR and made.value is None
            assert fmu.messages[-1][1] == "logStatusError"
        expected = driver.run(STEPS[5:10])
        assert fmu.restore(state) == OK
        assert driver.run(STEPS[5:10]) == expected
        fmu.free(state)


@every_fmu
def test_instances_do_not_influence_each_other(name: str, twin: Twin) -> None:
    expected = []
    for start in (0.0, 1.0):
        with Instance3(twin(name)) as alone:
            alone.initialise(start=start)
            expected.append(driver3(alone).run([(start + t, h) for t, h in STEPS]))
    with Instance3(twin(name)) as first, Instance3(twin(name)) as second:
        drivers = [driver3(first), driver3(second)]
        first.initialise()
        second.initialise(start=1.0)
        got: list[list[bytes]] = [[], []]
        for t, h in STEPS:
            got[0].append(drivers[0].step(t, h))
            got[1].append(drivers[1].step(1.0 + t, h))
        assert got == expected
