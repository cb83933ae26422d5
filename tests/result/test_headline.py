"""Tests of the line about a whole log: confidence and changes of the stiffness."""

import numpy as np
import pytest

from sigmahat.result.curve import Branch, Curve
from sigmahat.result.headline import Confidence, StiffnessChange, headline, told


@pytest.mark.parametrize(
    ("at_end", "shares", "doubt", "words"),
    [
        ("None", {"None": 1.0}, None, "confident"),
        ("None", {"None": 0.6, "Misfit": 0.4}, None, "confident"),
        (
            "None",
            {"Misfit": 0.9, "NotExcited": 0.094, "None": 0.006},
            "Misfit",
            "not confident for 99.4 % of the second half (Misfit)",
        ),
        ("Change", {"None": 0.9, "Change": 0.1}, "Change", "not confident (Change)"),
    ],
)
def test_confidence_is_about_the_second_half(
    at_end: str, shares: dict[str, float], doubt: str | None, words: str
) -> None:
    confidence = Confidence(at_end, shares)
    assert confidence.doubt == doubt
    assert confidence.in_words == words


def test_a_change_in_words() -> None:
    assert StiffnessChange(20.0, 0.3).in_words == "the stiffness changed by +30 % at 20 s"


def curve(std: float) -> Curve:
    phi = np.linspace(-0.1, 0.1, 5)
    branch = Branch(0.0, (-0.1, 0.1), phi, 2 * phi, 0 * phi, 2 + 0 * phi, std + 0 * phi)
    return Curve(polynomial=None, branches=[branch])  # type: ignore[arg-type]


@pytest.mark.parametrize(("std", "says"), [(20.0, False), (0.1, True)])
def test_without_any_stiffness_no_change_of_it_is_told(std: float, says: bool) -> None:
    """GIVEN an encoder that died, THEN the estimator sees a change, but of what is not known."""
    unknown, known = StiffnessChange(6.2, None), StiffnessChange(9.0, 0.3)
    line = headline(curve(std), Confidence("Change", {"Change": 1.0}), [unknown])
    assert ("changed" in line) is says
    assert list(told([unknown, known], curve(std))) == ([unknown, known] if says else [known])


def test_a_dead_zone_in_the_middle_leaves_the_stiffness_beyond_it() -> None:
    """GIVEN a curve that is known at 0.05 rad and beyond, but not at 0 rad."""
    phi = np.linspace(-0.1, 0.1, 5)
    std = np.array([0.5, 0.2, 30.0, 0.1, 0.6])
    branch = Branch(0.0, (-0.1, 0.1), phi, 2 * phi, 0 * phi, np.array([2.0, 2, 1, 2, 2]), std)
    curve = Curve(polynomial=None, branches=[branch])  # type: ignore[arg-type]
    line = headline(curve, Confidence("None", {"None": 1.0}))
    assert line == "2 +- 0.196 N.m/rad at 0.05 rad, cannot tell at 0 rad, confident"
    # WHEN the estimate is not confident, THEN no other deformation is chosen
    doubted = headline(curve, Confidence("Misfit", {"Misfit": 1.0}))
    assert doubted.startswith("cannot tell (1 +- 58.8) N.m/rad at 0 rad")
