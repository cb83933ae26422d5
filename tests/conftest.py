"""Where the tests find what the build made."""

import os
from pathlib import Path

import pytest

import sigmahat


@pytest.fixture(scope="session")
def build() -> Path:
    """Build tree, from SIGMAHAT_BUILD or ``build`` in the checkout."""
    return Path(os.environ.get("SIGMAHAT_BUILD", Path(__file__).parent.parent / "build"))


@pytest.fixture(scope="session")
def estimator_fmu() -> Path:
    """Path of StiffnessEstimator.fmu."""
    return sigmahat.fmu("StiffnessEstimator")


@pytest.fixture(scope="session")
def plant_fmu() -> Path:
    """Path of AwasPlant.fmu."""
    return sigmahat.fmu("AwasPlant")


@pytest.fixture(scope="session")
def antagonistic_fmu() -> Path:
    """Path of AntagonisticStiffnessEstimator.fmu."""
    return sigmahat.fmu("AntagonisticStiffnessEstimator")


@pytest.fixture(scope="session")
def flexible_joint_fmu() -> Path:
    """Path of FlexibleJointPlant.fmu."""
    return sigmahat.fmu("FlexibleJointPlant")


@pytest.fixture(scope="session")
def antagonistic_plant_fmu() -> Path:
    """Path of AntagonisticVsaPlant.fmu."""
    return sigmahat.fmu("AntagonisticVsaPlant")


@pytest.fixture(scope="session")
def released(build: Path) -> Path:
    """Folder of the FMUs as ``cmake --workflow --preset release`` makes them."""
    folder = build / "release"
    if not folder.is_dir():
        pytest.fail("there is no release to test; make it: cmake --workflow --preset release")
    return folder
