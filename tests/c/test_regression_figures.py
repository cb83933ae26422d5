"""The figures of docs/filtered-regression/ show what its text says."""

import numpy as np

from c_library import Estimator, Library
from regression_figures import AT, CHANGES, DOES_NOT, FITS, REGRESSION, blocks, rows
from regression_joint import PLAIN, SETTINGS


def test_the_run_of_the_first_figure_is_as_the_page_describes_it(c: Library) -> None:
    """Confident after half a second; 50 ms to doubt, half a second to learn, another to trust."""
    found, t = Estimator(c, REGRESSION).run(CHANGES.measurements()), CHANGES.t
    confident, age = found["confident"].astype(bool), found["change_age"]
    assert 0.4 < t[confident][0] < 0.6
    doubts = t[(t > AT) & ~confident]
    assert doubts[0] - AT < 0.1
    assert 0.3 < t[age >= 0][0] - AT < 0.6
    assert 0.8 < doubts[-1] - AT < 1.2


def test_rows_are_means_of_the_filtered_samples(c: Library) -> None:
    found = rows(c, 8.0, 8.08)
    assert found.samples == 7
    for end, row in zip(found.end[1:], found.row[1:], strict=True):
        samples = (found.t > end - 0.0065) & (found.t < end + 0.0005)
        # The row also has the correction (F5), T^2 / 12 times the second derivative.
        np.testing.assert_allclose(row[0], np.mean(found.torque[1][samples]), rtol=1e-3)


def test_kappa_grows_only_where_the_model_does_not_hold(c: Library) -> None:
    values = {**SETTINGS, **PLAIN}
    fits, other = blocks(c, FITS, values), blocks(c, DOES_NOT, values)
    assert np.mean(fits.errors[0]) < 1.5 and np.max(fits.kappa_squared) < 1.5
    assert np.all(other.kappa_squared[other.t > 2] > 10 * fits.kappa_squared[-1])
