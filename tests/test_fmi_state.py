"""Reset, copies of the state, and states that are not what they claim to be."""

from __future__ import annotations

import math
import subprocess
import sys
from pathlib import Path

import pytest

from fmi_instance import ERROR, OK, Instance

OUTPUTS = ["sigma", "tau_e", "tau_e_residual", "theta_dot", "a", "rho", "epsilon", "eta[2,1]"]


def feed(fmu: Instance, k: int) -> list[float]:
    """One step of 1 ms from k ms on, at measurements that excite everything; the outputs."""
    t = k * 1e-3
    theta = 0.5 * math.sin(9 * t)
    fmu.set_all(
        {
            "theta": theta,
            "q": theta + 0.01 * math.sin(13 * t),
            "theta_c": 20 * math.sin(3 * t),
            "tau": 0.3 * math.cos(9 * t),
        }
    )
    assert fmu.step(t, 1e-3) == OK
    return fmu.get_all(OUTPUTS)


def test_reset_is_a_fresh_instance(estimator_fmu: Path) -> None:
    with Instance(estimator_fmu) as fmu:
        fmu.initialise()
        fresh = [feed(fmu, k) for k in range(100)]
        assert fmu.call("fmi2Reset") == OK
        fmu.initialise()
        assert [feed(fmu, k) for k in range(100)] == fresh
        assert fmu.call("fmi2Reset") == OK
        fmu.initialise({"motor.D_theta": 2e-3})
        assert [feed(fmu, k) for k in range(100)] != fresh
        assert fmu.call("fmi2Reset") == OK  # also forgets parameters
        fmu.initialise()
        assert [feed(fmu, k) for k in range(100)] == fresh


@pytest.mark.parametrize("at", [0, 1, 37, 80])
def test_restored_state_goes_on_bit_for_bit(at: int, estimator_fmu: Path) -> None:
    with Instance(estimator_fmu) as fmu:
        fmu.initialise()
        for k in range(at):
            feed(fmu, k)
        state = fmu.save()
        first = [feed(fmu, k) for k in range(at, 120)]
        assert fmu.restore(state) == OK
        assert [feed(fmu, k) for k in range(at, 120)] == first
        fmu.free(state)


def test_serialised_state_goes_on_in_another_process(estimator_fmu: Path, tmp_path: Path) -> None:
    with Instance(estimator_fmu) as fmu:
        fmu.initialise()
        for k in range(50):
            feed(fmu, k)
        state = fmu.save()
        (tmp_path / "state").write_bytes(fmu.serialise(state))
        fmu.free(state)
        expected = [feed(fmu, k) for k in range(50, 80)]
    program = f"""
import sys
sys.path.insert(0, {str(Path(__file__).parent)!r})
from pathlib import Path
from fmi_instance import Instance
from test_fmi_state import feed
with Instance(Path({str(estimator_fmu)!r})) as fmu:
    status, state = fmu.deserialise(Path({str(tmp_path / "state")!r}).read_bytes())
    assert status == 0 and fmu.restore(state) == 0
    fmu.free(state)
    print(repr([feed(fmu, k) for k in range(50, 80)]))
"""
    done = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, check=True
    )
    assert done.stdout.strip() == repr(expected)


def test_a_damaged_or_foreign_state_is_refused(estimator_fmu: Path, plant_fmu: Path) -> None:
    with Instance(estimator_fmu) as fmu, Instance(plant_fmu) as other:
        fmu.initialise()
        feed(fmu, 0)
        state = fmu.save()
        good = fmu.serialise(state)
        fmu.free(state)
        foreign = other.serialise(other.save())
        flipped = bytearray(good)
        flipped[len(good) // 2] ^= 1
        for bad, reason in [
            (bytes(flipped), "damaged"),
            (good[:-1], "truncated"),
            (good[:10], "truncated"),
            (b"", "truncated"),
            (good + b"x", "too long"),
            (foreign, "another FMU"),
            (b"x" * len(good), "not a state"),
        ]:
            status, _ = fmu.deserialise(bad)
            assert status == ERROR
            assert reason in fmu.messages[-1][2]
        assert fmu.step(1e-3, 1e-3) == OK
        status, state = fmu.deserialise(good)
        assert status == OK
        fmu.free(state)


def test_two_instances_do_not_know_each_other(estimator_fmu: Path) -> None:
    with Instance(estimator_fmu) as alone:
        alone.initialise()
        expected = [feed(alone, k) for k in range(60)]
    with Instance(estimator_fmu) as one, Instance(estimator_fmu) as two:
        one.initialise()
        two.initialise({"motor.D_theta": 2e-3})
        results = [(feed(one, k), feed(two, k)) for k in range(60)]
    assert [first for first, _ in results] == expected
    assert [second for _, second in results] != expected
