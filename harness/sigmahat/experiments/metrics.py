"""Performance indices of a stiffness estimate, their descriptions, and their mean over seeds."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sigmahat.files import tables


@dataclass(frozen=True)
class Indices:
    """Performance indices of one estimate over one run.

    Relative indices are nan if their reference is zero at some time.
    """

    mse: float  #: (35) [(N.m/rad)2]
    msrep: float  #: (36) [%]
    error: float  #: Mean relative error [%]
    mse_settled: float  #: (35) without the start-up [(N.m/rad)2]
    msrep_settled: float  #: (36) without the start-up [%]
    error_settled: float  #: Mean relative error without the start-up [%]


@dataclass(frozen=True)
class Index:
    """Description of a performance index."""

    field: str  # field of Indices
    symbol: str  # symbol in the paper
    unit: str
    settled: bool  # whether this error index ignores the start-up

    def when(self, settled: float) -> str:
        """The part of a run that the index covers, in words; settled: end of the start-up [s]."""
        return f"after {settled:g} s" if self.settled else ""

    def name(self, when: str = "") -> str:
        """Name of the index, with the part of the run that the index covers."""
        return f"{self.symbol} {when}" if when else self.symbol

    def title(self, when: str = "") -> str:
        """name() with the unit."""
        return tables.title(self.name(when), self.unit)


INDICES = {
    index.field: index
    for settled, end in ((False, ""), (True, "_settled"))
    for index in (
        Index(f"mse{end}", "MSE", "(N.m/rad)2", settled),
        Index(f"msrep{end}", "MSREP", "%", settled),
        Index(f"error{end}", "mean error", "%", settled),
    )
}
"""Every performance index by its field of Indices, in their order."""

MSREP_IN_WORDS = "MSREP: mean square of the relative error; 1 % is an RMS error of 10 %"


def mse(sigma: ArrayLike, estimate: ArrayLike) -> float:
    """Mean square error, (35), in the square of the unit of sigma.

    Both arguments have the shape (p + 1,), p >= 1: samples k = 0..p. As the paper prints it, the
    sum of the p + 1 squares is divided by p. Raises ValueError for other shapes and values that
    are not finite.
    """
    true, estimated = _equal_shapes(sigma, estimate)
    return float(np.sum((true - estimated) ** 2) / (len(true) - 1))


def msrep(sigma: ArrayLike, estimate: ArrayLike, relative_to: ArrayLike | None = None) -> float:
    """Mean square relative error, (36) [%]; arguments as for mse.

    The error is relative to sigma, or to another stiffness of the same shape, which must not be 0.
    """
    return mse(*_relative(sigma, estimate, relative_to)) * 100


def mean_error(
    sigma: ArrayLike, estimate: ArrayLike, relative_to: ArrayLike | None = None
) -> float:
    """Mean relative error [%], positive if the estimate is too stiff; arguments as for msrep."""
    true, estimated = _relative(sigma, estimate, relative_to)
    return float(np.mean(estimated - true)) * 100


def indices(
    t: NDArray[np.float64],
    sigma: ArrayLike,
    estimate: ArrayLike,
    relative_to: ArrayLike | None = None,
    settled: float = 1.0,
) -> Indices:
    """All indices of one run, for the whole run and without its start-up.

    `t` [s] has the shape of `sigma` and `estimate` [N.m/rad], (p + 1,). Errors are relative to
    `relative_to` [N.m/rad], which is `sigma` if not given and may be zero here. The start-up ends
    at the time `settled` [s].

    Raises ValueError for other shapes and values that are not finite.
    """
    given = sigma if relative_to is None else relative_to
    true, estimated, scale = _equal_shapes(sigma, estimate, given)
    values = []
    for part in (slice(None), t >= settled):
        arguments = true[part], estimated[part], scale[part]
        defined = bool(np.all(scale[part]))
        values += [
            mse(*arguments[:2]),
            msrep(*arguments) if defined else math.nan,
            mean_error(*arguments) if defined else math.nan,
        ]
    return Indices(*values)


def mean_interval(values: Sequence[float]) -> tuple[float, float]:
    """Mean over independent runs and half the width of its 95 % interval (Student t).

    The mean of no value and the half width of a single value are not defined: nan. For equal
    values, the half width is exactly 0.
    """
    mean = float(np.mean(values)) if len(values) else math.nan
    if len(values) < 2:
        return mean, math.nan
    if len(set(values)) == 1:
        return values[0], 0.0
    from scipy.special import stdtrit

    deviation = float(np.std(values, ddof=1))
    return mean, float(stdtrit(len(values) - 1, 0.975)) * deviation / math.sqrt(len(values))


def _relative(
    sigma: ArrayLike, estimate: ArrayLike, relative_to: ArrayLike | None
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    scale = sigma if relative_to is None else relative_to
    true, estimated, scale = _equal_shapes(sigma, estimate, scale)
    if not np.all(scale):
        raise ValueError("expected true stiffness without zeros, for the relative error")
    return true / scale, estimated / scale


def _equal_shapes(*signals: ArrayLike) -> list[NDArray[np.float64]]:
    arrays = [np.asarray(signal, float) for signal in signals]
    shapes = [array.shape for array in arrays]
    if len(set(shapes)) > 1 or arrays[0].ndim != 1 or len(arrays[0]) < 2:
        raise ValueError(
            "expected true and estimated stiffness of the same shape (p + 1,), p >= 1, "
            f"got {', '.join(map(str, shapes))}"
        )
    if not all(np.all(np.isfinite(array)) for array in arrays):
        raise ValueError("expected finite stiffness, got NaN or infinite values")
    return arrays
