"""An FMU of FMI 3.0 does the same as that of FMI 2.0, bit for bit, and takes its states."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

import sigmahat
from fmi3_instance import HeldInputs, Instance3, driver3
from fmi_instance import OK, Instance
from fmi_runs import ESTIMATORS, PLANTS, random_steps

STEPS = random_steps(120, seed=1)
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
        for variable in old.variables:
            assert new.get(variable) == old.get(variable)


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
