"""Both versions of FMI give the same bits. Reset, copies of the state, states that are damaged."""

import ctypes
import math
import random
import struct
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context

import pytest

from fmi_instance import ERROR, OK, Instance
from fmi_runs import ESTIMATORS, FMI2, PLANTS, Driver, Fmi, continue_from, names, random_steps
from forged_states import signed

each_kind = pytest.mark.parametrize("name", [*ESTIMATORS, "AwasPlant"])
STEPS = random_steps(120, seed=1)
POINTS = random.Random(2).sample(range(len(STEPS)), 12)


@pytest.mark.parametrize(
    ("name", "start"),
    [*((n, {"method": m}) for n in ESTIMATORS for m in (1, 2)), *((n, {}) for n in PLANTS)],
)
def test_both_versions_give_the_same_bits(name: str, start: dict[str, float], fmi3: Fmi) -> None:
    with FMI2(name) as old, fmi3(name) as new:
        old_run, new_run = Driver(old, held=True), Driver(new)
        assert old_run.outputs == new_run.outputs and len(new_run.outputs) >= 10
        for fmu in (old, new):
            fmu.initialise(start)
        assert new_run.result() == old_run.result()
        for t, h in STEPS[:40]:
            assert new_run.step(t, h) == old_run.step(t, h)
        for variable in old.variables:
            assert new.get(variable) == old.get(variable)
        state = old.save()
        status, copied = new.deserialise(old.serialise(state))  # also a state of the other version
        old_run.run(STEPS[40:80])
        assert old.restore(state) == status == new.restore(copied) == OK
        assert new_run.run(STEPS[40:]) == old_run.run(STEPS[40:])
        old.free(state)
        new.free(copied)


@each_kind
def test_an_instance_after_a_reset_is_like_a_new_one(name: str, fmi: Fmi) -> None:
    with fmi(name) as fmu:
        driver, new = Driver(fmu), fmu.saved()
        tunable = names(fmu, "parameter", "tunable")[:3]
        other = {n: 1.5 * float(fmu.variables[n].start) for n in tunable}
        fmu.initialise()
        fresh = driver.run(STEPS)
        for point in POINTS[:3]:
            assert fmu.call("Reset") == OK
            assert fmu.saved() == new
            fmu.initialise(other, start=3.7)  # values that the reset has to replace
            driver.run([(3.7 + t, h) for t, h in STEPS[:point]])
        assert fmu.call("Reset") == OK
        if fmu.prefix == "fmi2":  # an importer may leave out the times: the start is 0
            assert fmu.call("EnterInitializationMode") == OK
        else:
            assert fmu.enter() == OK
        assert fmu.exit() == OK
        assert driver.run(STEPS) == fresh


@each_kind
def test_a_restored_state_continues_bit_for_bit(name: str, fmi: Fmi) -> None:
    """The state is restored in its own instance and, serialised, in another process."""
    with fmi(name) as fmu:
        driver = Driver(fmu)
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
            fmi.kind,
            fmi.path(name),
            [serialised[p] for p in POINTS],
            [STEPS[p:] for p in POINTS],
        ).result()
    for point, result in zip(POINTS, continued, strict=True):
        assert result == whole[point:]


@pytest.mark.parametrize("at", ["instantiated", "initialisation", "terminated"])
def test_a_state_contains_the_mode_of_the_instance(at: str, fmi: Fmi) -> None:
    with fmi() as fmu:
        if at != "instantiated":
            assert fmu.enter() == OK
        if at == "terminated":
            assert fmu.exit() == OK and fmu.call("Terminate") == OK
        state = fmu.save()
        assert fmu.call("Reset") == OK
        fmu.initialise()
        assert fmu.step(0.0, 1e-3) == OK
        assert fmu.restore(state) == OK
        assert fmu.step(0.0, 1e-3) == ERROR
        assert fmu.enter() == (OK if at == "instantiated" else ERROR)
        assert fmu.exit() == (ERROR if at == "terminated" else OK)
        fmu.free(state)


def test_a_state_of_initialisation_mode_gives_initial_outputs(fmi: Fmi) -> None:
    with fmi() as fmu:
        assert fmu.enter() == OK
        fmu.set_all({"rls.eta_0[0,0]": 5.0})
        state = fmu.save()
        fmu.set_all({"rls.eta_0[0,0]": 7.0})
        assert fmu.exit() == OK
        assert fmu.restore(state) == OK
        assert fmu.get("sigma") == 5.0
        assert fmu.exit() == OK
        assert fmu.get("sigma") == 5.0
        fmu.free(state)


@each_kind
def test_a_damaged_or_foreign_state_is_refused(name: str, fmi: Fmi) -> None:
    foreign_name = "AwasPlant" if name != "AwasPlant" else "StiffnessEstimator"
    with fmi(name) as fmu, fmi(foreign_name) as other:
        driver = Driver(fmu)
        fmu.initialise()
        driver.run(STEPS[:5])
        state, foreign_state = fmu.save(), other.save()
        good, expected = fmu.serialise(state), driver.run(STEPS[5:10])
        foreign = other.serialise(foreign_state)
        assert fmu.restore(foreign_state) == ERROR
        assert "another FMU" in fmu.last_message
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
            status, made = fmu.deserialise(bad)
            assert status == ERROR and made.value is None
            category, message = fmu.messages[-1][1:]
            assert category == "logStatusError"
            assert message.startswith(f"{fmu.prefix}De") and reason in message
            assert driver.result() == reached
        assert fmu.restore(state) == OK
        assert driver.run(STEPS[5:10]) == expected
        fmu.free(state)


def test_a_buffer_that_is_too_small_for_a_state_is_refused(fmi: Fmi) -> None:
    with fmi().initialise() as fmu:
        state = fmu.save()
        size = len(fmu.serialise(state))
        buffer = ctypes.create_string_buffer(b"\xa5" * size, size)
        status = fmu.call(f"Serialize{fmu.state}", state, buffer, ctypes.c_size_t(size - 1))
        assert status == ERROR
        assert f"size = {size - 1} bytes; expected {size}" in fmu.last_message
        assert buffer.raw == b"\xa5" * size
        assert fmu.call(f"Serialize{fmu.state}", state, buffer, ctypes.c_size_t(size)) == OK
        fmu.free(state)


def test_freeing_a_state_releases_its_memory() -> None:
    with FMI2(memory=True).initialise() as fmu:
        without = set(fmu.blocks)
        assert without
        state = fmu.save()
        block = state.value
        assert fmu.blocks == without | {block}
        assert fmu.call("GetFMUstate", ctypes.byref(state)) == OK  # uses the same memory
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


# States with a right checksum that no FMU has saved: anybody can write one

HEADER, CHECKSUM, MODE = 128, 120, 12  # places in a serialised state


def forge(fmu: Instance, format_: str, place: int, value: float) -> int:
    """The status when the state of an instance is read back with another value at a place."""
    forged = bytearray(fmu.saved())
    struct.pack_into(f"<{format_}", forged, place, value)
    status, copy = fmu.deserialise(signed(forged, CHECKSUM))
    if status == OK:
        fmu.free(copy)
    return status


def test_a_forged_state_that_is_none_of_fmi_or_out_of_range_is_refused() -> None:
    with FMI2().initialise() as fmu:
        assert fmu.step(0.0, 1e-3) == OK
        for state in (0, 3, 5, 15, 16):
            assert forge(fmu, "I", MODE, state) == ERROR
            assert "values that this FMU never saves" in fmu.last_message
        for state in (1, 2, 4, 8):
            assert forge(fmu, "I", MODE, state) == OK
        assert forge(fmu, "d", HEADER, -1.0) == ERROR  # samplePeriod
        assert "samplePeriod = -1 is out of its range" in fmu.last_message


def test_a_plant_whose_position_is_no_number_is_refused() -> None:
    """The positions stand behind the parameters: each place of the state is tried."""
    with FMI2("AwasPlant").initialise() as fmu:
        places = range(HEADER, len(fmu.saved()), 8)
        refused = [forge(fmu, "d", place, math.nan) for place in places]
        assert refused.count(ERROR) > 6
        assert any("never saves" in text for *_, text in fmu.messages)
