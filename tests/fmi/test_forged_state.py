"""States with a right checksum that no FMU has saved: anybody can write one."""

from __future__ import annotations

import math
import struct

import pytest

import sigmahat
from fmi_instance import ERROR, OK, Instance

HEADER, CHECKSUM, STATE = 128, 120, 12


def signed(state: bytearray) -> bytes:
    """The state with its checksum: FNV-1a over all bytes but its own."""
    state[CHECKSUM:HEADER] = bytes(8)
    value = 14695981039346656037
    for byte in state:
        value = ((value ^ byte) * 1099511628211) % 2**64
    state[CHECKSUM:HEADER] = value.to_bytes(8, "little")
    return bytes(state)


def forge(fmu: Instance, format_: str, place: int, value: float) -> int:
    """The status when the state of an instance is read back with another value at a place."""
    state = fmu.save()
    forged = bytearray(fmu.serialise(state))
    fmu.free(state)
    struct.pack_into(f"<{format_}", forged, place, value)
    status, copy = fmu.deserialise(signed(forged))
    if status == OK:
        fmu.free(copy)
    return status


@pytest.mark.parametrize("name", ["StiffnessEstimator", "AwasPlant"])
def test_a_state_that_is_none_of_fmi_is_refused(name: str) -> None:
    with Instance(sigmahat.fmu(name)) as fmu:
        fmu.initialise()
        assert fmu.step(0.0, 1e-3) == OK
        for state in (0, 3, 5, 15, 16):
            assert forge(fmu, "I", STATE, state) == ERROR
            assert "values that this FMU never saves" in fmu.messages[-1][2]
        for state in (1, 2, 4, 8):
            assert forge(fmu, "I", STATE, state) == OK


def test_a_parameter_out_of_its_range_is_refused() -> None:
    with Instance(sigmahat.fmu("StiffnessEstimator")) as fmu:
        fmu.initialise()
        assert forge(fmu, "d", HEADER, -1.0) == ERROR  # samplePeriod
        assert "samplePeriod = -1 is out of its range" in fmu.messages[-1][2]


def test_a_plant_whose_position_is_no_number_is_refused() -> None:
    """The positions stand behind the parameters: each place of the state is tried."""
    with Instance(sigmahat.fmu("AwasPlant")) as fmu:
        fmu.initialise()
        state = fmu.save()
        size = len(fmu.serialise(state))
        fmu.free(state)
        refused = [forge(fmu, "d", place, math.nan) for place in range(HEADER, size, 8)]
        assert refused.count(ERROR) > 6
        assert any("never saves" in text for *_, text in fmu.messages)


def test_a_step_has_a_finite_end() -> None:
    with Instance(sigmahat.fmu("AwasPlant")) as fmu:
        fmu.initialise({"noise.samplePeriod": 1e300}, start=1e308)
        assert fmu.step(1e308, 1e308) == ERROR
        assert "ends beyond the largest number" in fmu.messages[-1][2]
