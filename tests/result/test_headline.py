"""Tests of the line about a whole log: confidence and changes of the stiffness."""

import pytest

from sigmahat.result.headline import Confidence, StiffnessChange


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
