from collections.abc import Callable
from pathlib import Path

import pytest

import sigmahat
from fmi_instance import Instance, Instance3
from fmi_runs import Fmi


@pytest.fixture(params=["fmi2", "fmi3"])
def fmi(request: pytest.FixtureRequest, twin: Callable[[str], Path]) -> Fmi:
    """Each version of FMI in turn."""
    return Fmi(Instance, sigmahat.fmu) if request.param == "fmi2" else Fmi(Instance3, twin)
