"""Tests of the system sigmahat-awas.ssp: validity, FMUs, and simulation in libcosim.

The file tests/project/test_how_to.py simulates the same system in FMPy.
"""

import zipfile
from pathlib import Path

import pytest
from fmpy.ssp.ssd import read_ssd, read_ssv
from libcosimpy.CosimExecution import CosimExecution
from libcosimpy.CosimObserver import CosimObserver

import sigmahat
from sigmahat.experiments.scenario import T
from sigmahat.fmi.instance import Fmu
from sigmahat.fmi.master import simulate
from sigmahat.paper.scenarios import scenario

TABLE1 = scenario("table1")
RESIDUAL = TABLE1.estimators["RESIDUAL"]
STEPS = 1500  # a part of the first motion


@pytest.fixture(scope="module")
def ssp() -> Path:
    """The system in the build tree; the released system only differs in its binaries."""
    return sigmahat.fmu("StiffnessEstimator").with_name("sigmahat-awas.ssp")


def test_it_is_valid_against_the_schema(ssp: Path) -> None:
    assert read_ssd(str(ssp), validate=True).version == "1.0"
    for element in ("plant", "estimator"):
        # ecos applies the parameter sets of one name, so both have the same.
        assert read_ssv(str(ssp), f"resources/{element}.ssv", validate=True).name == "table1"


@pytest.mark.parametrize("folder", ["development", "release"])
def test_it_contains_the_fmus_of_the_same_folder(
    folder: str, ssp: Path, request: pytest.FixtureRequest
) -> None:
    if folder == "release":
        ssp = request.getfixturevalue("released") / ssp.name
    with zipfile.ZipFile(ssp) as archive:
        for name in ("AwasPlant", "StiffnessEstimator"):
            fmu = ssp.with_name(f"{name}.fmu")
            assert archive.read(f"resources/{name}.fmu") == fmu.read_bytes()


def test_libcosim_takes_the_parameters_and_gives_the_estimate_one_sample_later(ssp: Path) -> None:
    recording = simulate(TABLE1.plant, {"RESIDUAL": RESIDUAL}, T, STEPS)
    execution = CosimExecution.from_ssp_file(ssp_path=str(ssp), step_size=T * 1e9)
    observer = CosimObserver.create_last_value()
    execution.add_observer(observer)
    slaves = {slave.name.decode(): slave.index for slave in execution.slave_infos()}
    for k in (1000, STEPS - 1):
        assert execution.simulate_until(round(k * T * 1e9))
        for element, name, expected in (
            ("plant", "AwasPlant", recording.plant["sigma"][k]),
            ("estimator", "StiffnessEstimator", recording.estimators["RESIDUAL"]["sigma"][k - 1]),
        ):
            with Fmu(sigmahat.fmu(name)) as fmu:
                sigma = fmu.variables["sigma"].valueReference
            found = observer.last_real_values(slaves[element], [sigma])
            assert found == pytest.approx([expected], rel=1e-9)
