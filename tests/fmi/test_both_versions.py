"""An FMU of FMI 3.0 does the same as that of FMI 2.0, bit for bit, and takes its states."""

from collections.abc import Callable
from pathlib import Path

import pytest

import sigmahat
from fmi_instance import OK, Instance, Instance3
from fmi_runs import ESTIMATORS, PLANTS, Driver, random_steps

STEPS = random_steps(120, seed=1)


@pytest.mark.parametrize(
    ("name", "start"),
    [*((n, {"method": m}) for n in ESTIMATORS for m in (1, 2)), *((n, {}) for n in PLANTS)],
)
def test_both_versions_give_the_same_bits(
    name: str, start: dict[str, float], twin: Callable[[str], Path]
) -> None:
    with Instance(sigmahat.fmu(name)) as old, Instance3(twin(name)) as new:
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
