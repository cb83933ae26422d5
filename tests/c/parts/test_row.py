"""row.c: the mean of K samples, its weight, and the error of its prediction."""

import pytest

from c_library import Library
from c_parts import SENSOR, columns


def test_a_row_is_the_mean_of_its_samples(c: Library) -> None:
    """K = 4 samples of a column, 1 2 3 6, have the mean 3; torques 2 4 6 8 have 5. The row is
    complete with the fourth sample. The motor moves with one sample of four: a share of 1/4."""
    lib, p = c.lib, c.parameters({"modality": SENSOR})
    spring = columns(c, {"POWER": 1.0}, filtered=1)
    row, mean, feedback = c.new("sh_row"), c.new("sh_mean"), c.new("sh_feedback")
    signals, now = c.new("sh_signals", decimation=4), c.new("sh_filtered")
    complete = []
    for column, torque, theta in (
        (1.0, 2.0, 0.0),
        (2.0, 4.0, 0.5),
        (3.0, 6.0, 0.0),
        (6.0, 8.0, 0.0),
    ):
        signals.filters.input[lib.SH_FILTERS] = column + 10.0  # the output is 10 behind
        signals.filters.behind[2][lib.SH_FILTERS] = 10.0
        signals.theta_before[0] = theta
        now.output[lib.SH_FILTER_TORQUE] = torque
        rough = 2 * column
        complete.append(lib.sh_row_add(row, mean, signals, spring, feedback, p, now, rough))
    assert complete == [0, 0, 0, 1]
    assert list(row.x[0:3]) == [3.0, 5.0, 5.0]  # the column, and both right-hand sides
    assert (row.rough, row.moved) == (6.0, 0.25)
    assert (mean.samples, mean.rough, mean.output[0]) == (0, 0.0, 0.0)


def test_the_weight_is_one_over_the_variance(c: Library) -> None:
    row, noise = c.new("sh_row", x=[1.0, 2.0]), c.new("sh_row_noise", R=4.0, lasting=3.0)
    assert c.lib.sh_row_weigh(row, noise, 1) == 1
    assert (row.w, row.lasting) == (0.25, 3.0)


def test_a_row_of_too_large_numbers_has_no_weight(c: Library) -> None:
    row, noise = c.new("sh_row", x=[1.0, 0.0, 1e80]), c.new("sh_row_noise", R=4.0)
    assert c.lib.sh_row_weigh(row, noise, 1) == 0
    assert row.w == 0.0


def test_the_error_is_y_minus_what_the_columns_predict(c: Library) -> None:
    """10 - (2 * 1 + 3 * 2) = 2"""
    both, left = columns(c, {"POWER": 1.0, "BIAS": 1.0}), c.new("sh_column_noise")
    row = c.new("sh_row", x=[2.0, 3.0, 0.0, 10.0])
    c.lib.sh_row_predict(row, both, [1.0, 2.0], c.new("sh_row_noise"), left)
    assert row.epsilon == 2.0
    assert (left.information, left.gain) == (0.0, 0.0)


def test_the_noise_of_the_torque_leaves_its_column(c: Library) -> None:
    """The column is s' = -1 times the torque 10, beta is 0.5, and the share of torque noise is 0.5:
    y = -4 has the error 1, of which nu = 0.5 / (1 - 0.5 * -0.5) = 0.4 is torque noise. Without it,
    the column is -10 (1 - 0.4 / 10) = -9.6, and the error is -4 + 0.5 * 9.6 = 0.8. Half of the
    noise's variance 2 is left."""
    drive, left = columns(c, {"DRIVE": 1.0}), c.new("sh_column_noise")
    row = c.new("sh_row", x=[-10.0, 10.0, -4.0])
    c.lib.sh_row_predict(row, drive, [0.5], c.new("sh_row_noise", share=0.5, torque=2.0), left)
    assert row.x[0] == pytest.approx(-9.6)
    assert row.epsilon == pytest.approx(0.8)
    assert (left.information, left.gain) == (1.0, -1.0)


def test_rho_is_the_variance_of_the_prediction_over_that_of_the_row(c: Library) -> None:
    """An update returns 1 / (1 + rho): 1/4 is rho = 3. While the filters settle, there is none."""
    row = c.new("sh_row", epsilon=1.0)
    c.lib.sh_row_compare(row, 0.25)
    assert row.rho == 3.0
    c.lib.sh_row_drop_prediction(row)
    assert (row.epsilon, row.rho) == (0.0, 0.0)
