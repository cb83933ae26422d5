"""Data travel as data: other words in labels change no plot of a comparison."""

from __future__ import annotations

import pytest

import pictures
from sigmahat.compare import labels
from sigmahat.compare.conditions import JOINTS
from sigmahat.compare.figure import curves_over_frequency, draw
from sigmahat.compare.job import Row, rows_of
from sigmahat.compare.performance import Performance
from sigmahat.runs.metrics import Indices


def made_up() -> list[Row]:
    """All rows, each with figures of its own."""
    names = {c.name: k for k, c in enumerate(c for j in JOINTS for c in j.scenario.comparisons)}
    return [
        row
        for i, joint in enumerate(JOINTS)
        for row in rows_of(
            joint,
            [
                {
                    c.name: Performance(Indices(*[1.0 + i + names[c.name]] * 6), *[0.5] * 5)
                    for c in joint.scenario.comparisons
                }
            ],
        )
    ]


def test_other_words_change_no_plot(monkeypatch: pytest.MonkeyPatch) -> None:
    before = pictures.of_figure(draw(made_up()))
    assert [len(lines) for _, _, lines, _ in before] == [6, 4]
    for name in ("group", "lever_arm", "motion", "case", "case_and_part"):
        monkeypatch.setattr(labels, name, lambda of: "0.3 Hz: Coulomb friction, r(0) = 1 mm")
    assert pictures.of_figure(draw(made_up())) == before


def test_conditions_are_data() -> None:
    curves = curves_over_frequency(made_up())
    assert [[row.joint.frequency for row in curve] for curve in curves] == [
        [0.1, 0.3, 1, 3, 8, 20]
    ] * 5
    conditions = [
        (round(1e3 * c[0].joint.lever_arm), c[0].joint.coulomb, c[0].case.motor_errors)
        for c in curves
    ]
    assert conditions == [
        (70, 0.0, {"D_theta": 0.1}),
        (70, 0.0, {"D_theta": -0.1}),
        (130, 0.0, {"D_theta": 0.1}),
        (70, 0.02, {"D_theta": 0.1}),
        (70, 0.02, {"D_theta": 0.1, "B": 0.1}),
    ]
