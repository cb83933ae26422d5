"""The FMUs of FMI 3.0, with the binary of this machine."""

from collections.abc import Callable
from pathlib import Path

import pytest


@pytest.fixture(scope="session")
def twin(build: Path) -> Callable[[str], Path]:
    """Path of the FMU for FMI 3.0 of a name."""
    return lambda name: build / "fmi3" / f"{name}_FMI3.fmu"


@pytest.fixture
def estimator(twin: Callable[[str], Path]) -> Path:
    return twin("StiffnessEstimator")
