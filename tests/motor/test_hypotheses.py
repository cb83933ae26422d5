"""Tests of hypotheses about a configuration: their effects on a log, and a torque without units."""

from functools import cache
from pathlib import Path

import numpy as np
import pytest

from checked_logs import RIGHT, Array, knee_log, log_by_hand
from recorded_logs import in_memory
from sigmahat.motor.hypotheses.drive import Drive, drive
from sigmahat.motor.hypotheses.hypothesis import (
    Hypothesis,
    mistyped_gears,
    scales,
    unit_of_same_turn,
    with_value,
)
from sigmahat.motor.log_view import LogView, liveliest_part
from sigmahat.recording.log import LogInMemory

COLUMNS = ("motor_counts", "link_deg", "current")


@cache
def view() -> LogView:
    """The first 4 s of the log, which are enough to compare signals."""
    begin = {name: values[:4000] for name, values in knee_log().items()}
    return liveliest_part(LogInMemory(Path("log"), begin), in_memory(RIGHT))


def hypotheses() -> list[Hypothesis]:
    ports = in_memory(RIGHT).ports
    of_ports = [other for name in ("theta", "q") for other in scales(name, ports[name], 80.0)]
    return [*of_ports, *mistyped_gears(ports["theta"])]


@pytest.mark.parametrize("hypothesis", hypotheses(), ids=lambda h: f"{h.key} = {h.value}")
def test_a_hypothesis_changes_the_signals_as_its_value_in_the_configuration(
    hypothesis: Hypothesis,
) -> None:
    before = view()
    other = with_value(before.configuration, hypothesis.key, hypothesis.value)
    (expected,) = liveliest_part(before.log, other).pieces
    (signals,) = hypothesis.applied(before).pieces
    for name in ("theta", "phi", "tau"):
        assert getattr(signals, name) == pytest.approx(getattr(expected, name), rel=1e-9, abs=1e-9)


def test_a_signal_is_moved_to_earlier_times() -> None:
    before = view()
    (piece,) = before.pieces
    (moved,) = before.earlier("tau", 10 * before.T).pieces
    assert np.array_equal(moved.tau[:-10], piece.tau[10:])
    (moved,) = before.earlier("q", 10 * before.T).pieces
    q = piece.theta + piece.phi
    assert moved.phi[:-10] == pytest.approx(q[10:] - piece.theta[:-10], abs=1e-12)


def test_a_unit_of_the_same_turn() -> None:
    assert unit_of_same_turn("deg", 2 * np.pi / 360, 0.1) == "rad"
    assert unit_of_same_turn("rad", 1000.0, 0.1) == "mrad"
    assert unit_of_same_turn("rad", 100.0, 0.1) is None


def columns() -> tuple[Array, Array, Array]:
    motor, link, current = (knee_log()[name] for name in COLUMNS)
    return motor, link, current


def test_the_motion_of_the_motor_explains_a_torque_in_any_unit() -> None:
    motor, link, current = columns()
    found = drive(motor, link, current)
    assert found.sign == 1
    assert found.explained > 0.99
    scaled = drive(1e-3 * motor + 7.0, -20.0 * link, 1e4 * current)
    assert scaled.sign == 1
    assert scaled.explained == pytest.approx(found.explained, abs=1e-6)
    assert drive(motor, link, -current).sign == -1


def test_the_motion_of_the_link_explains_the_torque_of_its_motor_less() -> None:
    motor, link, current = columns()
    as_motor = 1 - drive(motor, link, current).explained
    assert as_motor < 0.5 * (1 - drive(link, motor, current).explained)


def test_a_torque_against_a_hand_has_no_sure_sign() -> None:
    log = log_by_hand(0.05)
    assert drive(*(log[name] for name in COLUMNS)).sign == 0


def test_a_torque_without_motion_has_no_relation() -> None:
    motor, link, current = columns()
    nothing = Drive(0.0, 0)
    assert drive(0 * motor, link, current) == nothing
    assert drive(motor, link, 0 * current) == nothing
    assert drive(motor[:100], link[:100], current[:100]) == nothing
