"""The methods that are compared, by name; the docstring of each has its source."""

from __future__ import annotations

from collections.abc import Callable

from rivals.methods import least_squares, ours
from rivals.records import Estimate, JointLog

METHODS: dict[str, Callable[[JointLog], Estimate]] = {
    "FilteredRegression": ours.filtered_regression,
    "Paper2011": ours.paper2011,
    "least_squares": least_squares.estimate,
}
