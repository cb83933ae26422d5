"""The low pass of measured signals."""

import numpy as np

from sigmahat.motor.noise import low_pass


def test_a_filter_far_slower_than_the_samples_takes_no_longer() -> None:
    values = np.sin(0.01 * np.arange(2000))[:, None]
    smooth = low_pass(values, 1.0, 1e-7)  # the unit of the times was wrong
    assert smooth.shape == values.shape
