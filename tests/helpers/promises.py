"""What the tests of the numerical promises share: docs/proof/promises.md.

SIGMAHAT_PROMISES=100 runs a hundred times as many examples.
"""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, settings

from c_library import REALS, Array, Library, compile_library

EPSILON = {"double": 2.0**-53, "float": 2.0**-24}
"""Unit roundoff."""
SMALLEST = {"double": 5e-324, "float": 1.4e-45}
"""Smallest subnormal number."""

often = settings(
    max_examples=20 * int(os.environ.get("SIGMAHAT_PROMISES", "1")),
    deadline=None,
    derandomize=True,
    database=None,
    suppress_health_check=list(HealthCheck),
)


@pytest.fixture(scope="module", params=REALS)
def c(
    request: pytest.FixtureRequest, build: Path, tmp_path_factory: pytest.TempPathFactory
) -> Library:
    """The library in double, that of the build, and in single precision."""
    if request.param == "double":
        return Library(build)
    return compile_library(tmp_path_factory.getbasetemp(), request.param)


def reals(c: Library, values: Any) -> Array:
    """An array of the library's type."""
    with np.errstate(over="ignore"):  # to infinity, as C does
        return np.ascontiguousarray(values, dtype="f8" if c.real == "double" else "f4")
