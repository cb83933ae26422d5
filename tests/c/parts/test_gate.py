"""gate.c: samples that no joint can give."""

import math
from typing import Any

import pytest

from c_library import Library

T = 0.01  # [s]: a signal is refused for at most twelve samples
PARAMETERS = {
    **{"method": 2, "samplePeriod": T, "rls.n": 1, "rls.m": 1, "range.phi": 0.1},
    **{"encoder.theta": 2000 * math.pi, "encoder.q": 2000 * math.pi},  # counts of 1 mrad
    **{"motor.gamma": 10.0, "motor.B": 0.1, "prior.tau_e": 10.0, "prior.tau_coulomb": 0.0},
    **{"noise.tau": 0.01, "noise.tau_e": 0.1, "modality": 1},
}
"""Innovations of the torque are accepted up to 10 / 10 / 2 + 10 * 0.01 = 0.6 N.m. The motor alone
is accelerated by 10 / (100 * 0.1) = 1 rad/s2, so those of theta are accepted up to 0.1 + 4 mrad."""
THETA, PHI, TORQUE, SET_POINT = range(4)


class Gate:
    """A gate, and the number of samples it has refused in a row."""

    def __init__(self, c: Library, **values: float) -> None:
        self.c, self.p = c, c.parameters({**PARAMETERS, **values})
        self.state = c.new("sh_gate")
        c.lib.sh_gate_start(self.state, c.new("sh_columns"), self.p)
        self.refused = 0

    def take(self, theta: float = 0.0, phi: float = 0.0, tau: float = 0.0, **more: float) -> bool:
        z = self.c.new("sh_measurement", theta=theta, q=theta + phi, tau=tau)
        skipped = self.refused + int(more.get("lost", 0))
        z_set = more.get("set_point", 0.0)
        accepted = bool(self.c.lib.sh_gate_take(self.state, self.p, z, z_set, skipped))
        self.refused = 0 if accepted else skipped + 1
        return accepted

    def learn(self, **sample: float) -> None:
        """Twenty samples at rest: as many as it takes to know what is usual."""
        assert all(self.take(**sample) for _ in range(20))

    def peak(self, signal: int) -> float:
        return float(self.state.signal[signal].peak)


@pytest.mark.parametrize(
    ("sample", "limit"), [({"tau": 1.0}, 0.6), ({"theta": 1.0}, 4.1e-3), ({"phi": 1.0}, 8.1e-3)]
)
def test_a_joint_at_rest_accepts_what_it_may_do_next(
    c: Library, sample: dict[str, float], limit: float
) -> None:
    """The limits of the parameters (above), with 4 counts of theta, or 8 of two encoders."""
    for factor, accepted in ((0.999, True), (1.001, False)):
        gate = Gate(c)
        gate.learn()
        assert gate.take(**{name: factor * limit * x for name, x in sample.items()}) == accepted


def test_a_torque_is_compared_with_the_largest_innovation_of_late(c: Library) -> None:
    """A torque of +-0.2 N.m has innovations of 0.4 N.m, so 4 N.m is the limit. A minute later with
    one of 1e-4, e^-1 of it."""
    gate = Gate(c)
    gate.learn(tau=-0.2)
    for _ in range(20):
        assert gate.take(tau=0.2) and gate.take(tau=-0.2)
    assert gate.peak(TORQUE) == pytest.approx(0.4)
    assert not gate.take(tau=3.81)
    assert gate.take(tau=3.79)
    gate.state.signal[TORQUE].peak = 0.4
    for _ in range(6000):
        assert gate.take(tau=3.79)
    assert gate.peak(TORQUE) == pytest.approx(0.4 * math.exp(-1), rel=1e-3)


def test_a_position_is_predicted_by_its_last_step(c: Library) -> None:
    """0.5 rad per sample is far above the limit of 4.1 mrad, but no innovation."""
    gate = Gate(c)
    assert all(gate.take(theta=0.5 * k) for k in range(30))
    assert gate.peak(THETA) == pytest.approx(0.0, abs=1e-12)
    assert not gate.take(theta=0.5 * 29)  # it stops within a sample


def test_one_bad_sample_does_not_change_what_follows(c: Library) -> None:
    """The prediction of the second next sample is two steps ahead."""
    gate = Gate(c)
    assert all(gate.take(theta=0.5 * k) for k in range(30))
    before = gate.peak(PHI)
    assert not gate.take(theta=0.5 * 30, phi=0.05)
    assert gate.take(theta=0.5 * 31)
    assert gate.take(theta=0.5 * 32)
    assert gate.peak(PHI) == pytest.approx(before)


@pytest.mark.parametrize(("name", "level"), [("tau", 5.0), ("phi", -0.09), ("theta", 3.0)])
def test_a_level_is_accepted_after_0_12_s_and_then_known(
    c: Library, name: str, level: float
) -> None:
    """The same jump in the other direction is then accepted at once, and one of three times not."""
    gate = Gate(c)
    gate.learn()
    assert [gate.take(**{name: level}) for _ in range(13)] == [False] * 11 + [True, True]
    assert not gate.take(**{name: 4 * level})
    assert gate.take(**{name: 0.0})


def test_a_signal_that_moves_while_it_is_refused_has_a_velocity(c: Library) -> None:
    """After a jump, theta goes on with 0.5 rad per sample."""
    gate = Gate(c)
    gate.learn()
    taken = [gate.take(theta=3.0 + 0.5 * k) for k in range(20)]
    assert taken == [False] * 11 + [True] * 9


@pytest.mark.parametrize(("name", "level"), [("tau", 1001.0), ("phi", 100.1), ("phi", -1e12)])
def test_the_impossible_is_never_accepted(c: Library, name: str, level: float) -> None:
    """1000 times the torque of 1 N.m, or the deformation of 0.1 rad: also as the first sample."""
    gate = Gate(c)
    assert not any(gate.take(**{name: level}) for _ in range(30))
    gate.learn()
    assert not any(gate.take(**{name: level}) for _ in range(30))
    assert gate.take()


def test_a_motion_may_begin_at_any_velocity(c: Library) -> None:
    """At the start and after lost samples, the second sample gives the velocity. The torque may
    change by its scale, 1.1 N.m, and a position may differ from its prediction by range.phi."""
    for lost in (0, 1):
        gate = Gate(c)
        if lost:
            gate.learn()
        assert gate.take(theta=1.0, lost=lost) and gate.take(theta=9.0, tau=1.09)
        assert gate.take(theta=17.09, tau=1.0)
        assert not gate.take(theta=25.18, tau=1.0, phi=0.11)
    gate = Gate(c)
    assert gate.take() and not gate.take(tau=1.11)


def test_the_set_point_counts_if_the_torque_depends_on_it(c: Library) -> None:
    """It is compared with its range, 100."""
    for m, accepted in ((1, True), (2, False)):
        gate = Gate(c, **{"rls.m": m})
        gate.learn(set_point=50.0)
        assert gate.take(set_point=149.0)
        assert gate.take(set_point=-1000.0) == accepted


@pytest.mark.parametrize(("modality", "limit"), [(1, 0.6), (2, 6.0)])
def test_a_measured_torque_has_the_scale_of_the_spring(
    c: Library, modality: int, limit: float
) -> None:
    """10 / 2 + 10 * 0.1 = 6 N.m for the sensor, behind the gear."""
    gate: Any = Gate(c, modality=modality)
    assert gate.state.signal[TORQUE].least == pytest.approx(limit)


def test_the_nominal_curve_has_a_scale(c: Library) -> None:
    """200 N.m/rad at 0.1 rad is a torque of 20 N.m, and as much again by its slope: 40 / 10 / 2."""
    p = c.parameters({**PARAMETERS, "prior.tau_e": 0.0, "prior.nominal": 0.1, "noise.tau": 1e-9})
    p.rls.eta_0[0][0] = 200.0
    gate = c.new("sh_gate")
    c.lib.sh_gate_start(gate, c.new("sh_columns", has_nominal=1), p)
    assert gate.signal[TORQUE].least == pytest.approx(2.0)
