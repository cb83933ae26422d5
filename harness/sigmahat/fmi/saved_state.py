"""The state of an FMU as bytes: parameters, inputs, outputs, time, and all that it has learned."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from ctypes import byref, c_size_t
from typing import Any

from fmpy import fmi2

from sigmahat.fmi.instance import Slave


def save(slave: Slave) -> bytes:
    """The state of a slave. Raises FmuError if the FMU cannot give its state."""
    fmi = slave.functions
    with _freed(slave) as state:
        slave.call(fmi.fmi2GetFMUstate, byref(state))
        size = c_size_t()
        slave.call(fmi.fmi2SerializedFMUstateSize, state, byref(size))
        saved = (fmi2.fmi2Byte * size.value)()
        slave.call(fmi.fmi2SerializeFMUstate, state, saved, size)
        return bytes(saved)


def restore(slave: Slave, saved: bytes) -> float:
    """Gives a slave a state that was saved. Returns the time of this state [s].

    Raises FmuError, whose message says what is wrong, for bytes that are no state of this FMU.
    """
    fmi = slave.functions
    with _freed(slave) as state:
        block = (fmi2.fmi2Byte * len(saved)).from_buffer_copy(saved)
        slave.call(fmi.fmi2DeSerializeFMUstate, block, len(saved), byref(state))
        slave.call(fmi.fmi2SetFMUstate, state)
    time = fmi2.fmi2Real()
    slave.call(fmi.fmi2GetRealStatus, fmi2.fmi2LastSuccessfulTime, byref(time))
    return float(time.value)


@contextmanager
def _freed(slave: Slave) -> Iterator[Any]:
    """A pointer to a state, whose memory is freed at the end of the block."""
    state = fmi2.fmi2FMUstate()
    try:
        yield state
    finally:
        if state:
            slave.functions.fmi2FreeFMUstate(slave.component, byref(state))
