"""A position that keeps its value while the other one moves on."""

import numpy as np
import pytest

from sigmahat.recording.column import frozen_from

MOTOR = np.sin(0.01 * np.arange(3000))
LINK = np.round(0.98 * MOTOR, 4)


def test_an_encoder_that_dies() -> None:
    dead = np.where(np.arange(3000) < 1000, LINK, LINK[1000])
    assert frozen_from(dead, MOTOR) in (1000, 1001)


@pytest.mark.parametrize(
    ("values", "other"),
    [
        (LINK, MOTOR),
        (np.zeros(3000), MOTOR),  # at rest throughout, which is another finding
        (np.append(LINK, np.full(500, LINK[-1])), np.append(MOTOR, np.full(500, MOTOR[-1]))),
        (LINK, MOTOR[::2]),
    ],
)
def test_what_is_no_dead_encoder(values: np.ndarray, other: np.ndarray) -> None:
    assert frozen_from(values, other) is None
