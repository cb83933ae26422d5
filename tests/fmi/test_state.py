"""Reset, copies of the state, and states that are damaged or of another FMU."""

from __future__ import annotations

import ctypes
import random
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from pathlib import Path

import pytest

import sigmahat
from fmi_instance import ERROR, OK, Instance
from fmi_runs import ESTIMATORS, PLANTS, Driver, continue_from, names, random_steps

every_fmu = pytest.mark.parametrize("name", ESTIMATORS + PLANTS)
STEPS = random_steps(120, seed=1)
POINTS = random.Random(2).sample(range(len(STEPS)), 50)


@every_fmu
def test_an_instance_after_a_reset_is_like_a_new_one(name: str) -> None:
    path = sigmahat.fmu(name)
    with Instance(path) as fmu:
        driver = Driver(fmu)
        fmu.initialise()
        initial, fresh = driver.result(), driver.run(STEPS)
    with Instance(path) as fmu:
        driver = Driver(fmu)
        tunable = names(fmu, "parameter", "tunable")[:3]
        other = {n: 1.5 * float(fmu.variables[n].start) for n in tunable}
        for point in POINTS:
            fmu.initialise(other)  # values that the reset has to replace
            driver.run(STEPS[:point])
            assert fmu.call("fmi2Reset") == OK
            fmu.initialise()
            assert driver.result() == initial
            assert driver.run(STEPS) == fresh
            assert fmu.call("fmi2Reset") == OK


@every_fmu
def test_after_a_reset_without_setup_the_start_time_is_0(name: str) -> None:
    with Instance(sigmahat.fmu(name)) as fmu:
        driver = Driver(fmu)
        fmu.initialise(start=0.0)
        fresh = driver.run(STEPS[:20])
        assert fmu.call("fmi2Reset") == OK
        fmu.initialise(start=3.7)
        assert fmu.step(3.7, 1e-3) == OK
        assert fmu.call("fmi2Reset") == OK
        assert fmu.enter() == OK and fmu.exit() == OK
        assert driver.run(STEPS[:20]) == fresh


@every_fmu
def test_a_restored_state_continues_bit_for_bit(name: str) -> None:
    with Instance(sigmahat.fmu(name)) as fmu:
        driver = Driver(fmu)
        fmu.initialise()
        states, results, whole = {}, {}, []
        for k, step in enumerate(STEPS):
            if k in POINTS:
                states[k], results[k] = fmu.save(), driver.result()
            whole.append(driver.step(*step))
        for point in POINTS:
            assert fmu.restore(states[point]) == OK
            assert driver.result() == results[point]
            assert driver.run(STEPS[point:]) == whole[point:]
            fmu.free(states[point])


@every_fmu
def test_a_serialised_state_continues_in_another_process(name: str) -> None:
    path = sigmahat.fmu(name)
    with Instance(path) as fmu:
        driver = Driver(fmu)
        fmu.initialise()
        states, whole = {}, []
        for k, step in enumerate(STEPS):
            if k in POINTS:
                state = fmu.save()
                states[k] = fmu.serialise(state)
                fmu.free(state)
            whole.append(driver.step(*step))
    with ProcessPoolExecutor(1, get_context("spawn")) as process:
        results = process.submit(
            continue_from, path, [states[p] for p in POINTS], [STEPS[p:] for p in POINTS]
        ).result()
    for point, result in zip(POINTS, results, strict=True):
        assert result == whole[point:]


@pytest.mark.parametrize("at", ["instantiated", "initialisation", "terminated"])
def test_a_state_contains_the_mode_of_the_instance(at: str, estimator_fmu: Path) -> None:
    with Instance(estimator_fmu) as fmu:
        if at != "instantiated":
            assert fmu.setup() == OK and fmu.enter() == OK
        if at == "terminated":
            assert fmu.exit() == OK and fmu.call("fmi2Terminate") == OK
        state = fmu.save()
        assert fmu.call("fmi2Reset") == OK
        fmu.initialise()
        assert fmu.step(0.0, 1e-3) == OK
        assert fmu.restore(state) == OK
        assert fmu.step(0.0, 1e-3) == ERROR
        assert fmu.enter() == (OK if at == "instantiated" else ERROR)
        assert fmu.exit() == (ERROR if at == "terminated" else OK)
        fmu.free(state)


def test_a_state_of_initialisation_mode_gives_initial_outputs(
    estimator_fmu: Path,
) -> None:
    with Instance(estimator_fmu) as fmu:
        assert fmu.setup() == OK and fmu.enter() == OK
        fmu.set_all({"rls.eta_0[0,0]": 5.0})
        state = fmu.save()
        fmu.set_all({"rls.eta_0[0,0]": 7.0})
        assert fmu.exit() == OK
        assert fmu.restore(state) == OK
        assert fmu.get("sigma") == 5.0
        assert fmu.exit() == OK
        assert fmu.get("sigma") == 5.0
        fmu.free(state)


def test_a_state_with_contradictory_parameters_refuses_a_step(estimator_fmu: Path) -> None:
    with Instance(estimator_fmu) as fmu:
        fmu.initialise()
        fmu.set_all({"filter.V_min": 20.0})  # above filter.V_max
        state = fmu.save()
        fmu.set_all({"filter.V_min": 0.1})
        assert fmu.step(0.0, 1e-3) == OK
        assert fmu.restore(state) == OK
        assert fmu.step(0.0, 1e-3) == ERROR
        assert "filter.V_min = 20" in fmu.messages[-1][2]
        fmu.free(state)


@every_fmu
def test_a_damaged_or_foreign_state_is_refused(name: str) -> None:
    foreign_name = "AwasPlant" if name != "AwasPlant" else "StiffnessEstimator"
    with Instance(sigmahat.fmu(name)) as fmu, Instance(sigmahat.fmu(foreign_name)) as other:
        driver = Driver(fmu)
        fmu.initialise()
        driver.run(STEPS[:5])
        state = fmu.save()
        good, expected = fmu.serialise(state), driver.run(STEPS[5:10])
        foreign_state = other.save()
        foreign = other.serialise(foreign_state)
        other.free(foreign_state)
        refused = [
            (good[:-1], "truncated"),
            (good[:10], "truncated"),
            (b"", "truncated"),
            (good + b"x", "too long"),
            (foreign, "another FMU"),
            (b"x" * len(good), "not a state"),
        ]
        for byte in random.Random(3).sample(range(len(good)), 200):
            flipped = bytearray(good)
            flipped[byte] ^= 1 << byte % 8
            refused.append((bytes(flipped), ""))
        reached = driver.result()
        for bad, reason in refused:
            fmu.messages.clear()
            status, _ = fmu.deserialise(bad)
            assert status == ERROR
            assert "fmi2DeSerializeFMUstate" in fmu.messages[-1][2]
            assert reason in fmu.messages[-1][2]
            assert driver.result() == reached
        # A state that is damaged after it was saved.
        memory = (ctypes.c_ubyte * len(good)).from_address(state.value or 0)
        memory[len(good) // 2] ^= 1
        assert fmu.restore(state) == ERROR
        assert "damaged" in fmu.messages[-1][2]
        assert driver.result() == reached
        fmu.free(state)
        status, state = fmu.deserialise(good)
        assert status == OK and fmu.restore(state) == OK
        assert driver.run(STEPS[5:10]) == expected
        fmu.free(state)


def test_a_buffer_that_is_too_small_for_a_state_is_refused(estimator_fmu: Path) -> None:
    with Instance(estimator_fmu) as fmu:
        fmu.initialise()
        state = fmu.save()
        size = len(fmu.serialise(state))
        buffer = ctypes.create_string_buffer(b"\xa5" * size, size)
        status = fmu.call("fmi2SerializeFMUstate", state, buffer, ctypes.c_size_t(size - 1))
        assert status == ERROR
        assert f"size = {size - 1} bytes; expected {size}" in fmu.messages[-1][2]
        assert buffer.raw == b"\xa5" * size
        assert fmu.call("fmi2SerializeFMUstate", state, buffer, ctypes.c_size_t(size)) == OK
        fmu.free(state)


def test_freeing_a_state_releases_its_memory(estimator_fmu: Path) -> None:
    with Instance(estimator_fmu, memory=True) as fmu:
        fmu.initialise()
        without = set(fmu.blocks)
        assert without
        state = fmu.save()
        block = state.value
        assert fmu.blocks == without | {block}
        assert fmu.call("fmi2GetFMUstate", ctypes.byref(state)) == OK  # uses the same memory
        assert state.value == block and fmu.blocks == without | {block}
        status, copy = fmu.deserialise(fmu.serialise(state))
        assert status == OK
        assert fmu.blocks == without | {block, copy.value}
        fmu.free(state)
        assert state.value is None
        assert fmu.blocks == without | {copy.value}
        fmu.free(state)  # a null pointer
        fmu.free(copy)
        assert fmu.blocks == without
        fmu.dll.fmi2FreeInstance(ctypes.c_void_p(fmu.component))
        fmu.component = None
        assert fmu.blocks == set()
