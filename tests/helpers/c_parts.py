"""The parts of FilteredRegression in C, each filled with a few numbers."""

from collections.abc import Mapping
from typing import Any

from c_library import Array, Library
from c_regression import factors

SENSOR, RESIDUAL = 2, 1


def columns(c: Library, priors: Mapping[str, float], **counts: int) -> Any:
    """A new `sh_columns *` with the prior of each kind: 'POWER'. All in unit 1, without a place."""
    listed = [
        {"kind": getattr(c.lib, f"SH_COLUMN_{kind}"), "prior": prior, "unit": 1.0}
        for kind, prior in priors.items()
    ]
    return c.new("sh_columns", size=len(listed), column=listed, **counts)


def start(c: Library, a: Any, size: int, precision: float = 1.0) -> None:
    """Starts a `sh_information` within another struct: as a rule, with the prior N(0, 1)."""
    c.lib.sh_information_start(c.ffi.addressof(a), size, precision)


def posterior_of_prior(c: Library, size: int, weight: float = 1.0) -> Any:
    """A new `sh_posterior *` with the prior N(0, 1) for each column."""
    posterior = c.new("sh_posterior", weight=weight, column=list(range(size)))
    start(c, posterior.information, size)
    return posterior


def estimate(
    c: Library, posterior: Any, size: int, prior_B: float = 0.0
) -> tuple[list[float], ...]:
    """beta and its change with the relative gain of the torque, of the columns of the data."""
    beta, per_gain = (c.ffi.new(f"{c.real}[]", size) for _ in range(2))
    c.lib.sh_posterior_estimate(posterior, size, prior_B, beta, per_gain)
    return list(beta), list(per_gain)


def normal_equations(a: Any) -> tuple[Array, Array]:
    """A [size: n x n] and b [size: n x 2] of A beta = b: the gain of the torque, then y."""
    U, D, z = factors(a)
    A = (U.T * D) @ U
    return A, (U.T * D) @ z
