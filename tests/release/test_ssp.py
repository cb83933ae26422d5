"""The system sigmahat-awas.ssp: validity, reproducibility, and its simulation in FMPy."""

import zipfile
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from fmpy.ssp.simulation import simulate_ssp
from fmpy.ssp.ssd import read_ssd, read_ssv
from libcosimpy.CosimExecution import CosimExecution
from libcosimpy.CosimObserver import CosimObserver

import sigmahat
from plant_runs import run_plant
from sigmahat.fmi.instance import Fmu
from sigmahat.fmi.master import simulate
from sigmahat.paper.scenarios import scenario
from sigmahat.runs.scenario import T

TABLE1 = scenario("table1")
RESIDUAL = TABLE1.estimators["RESIDUAL"]
SIGNALS = {  # section VI.B
    "signal.tau.amplitude": 0.3,
    "signal.tau.frequency": 0.1,
    "signal.tau_c.amplitude": 8.0,
    "signal.tau_c.frequency": 0.1,
}
STEPS = 1500  # half of the first motion to one side


@pytest.fixture(scope="module")
def ssp() -> Path:
    """The system of the build for development; the released one differs in its binaries."""
    return sigmahat.fmu("StiffnessEstimator").with_name("sigmahat-awas.ssp")


def test_it_is_valid_against_the_schema(ssp: Path) -> None:
    assert read_ssd(str(ssp), validate=True).version == "1.0"
    for element in ("plant", "estimator"):
        assert read_ssv(str(ssp), f"resources/{element}.ssv", validate=True).name == element


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


@pytest.fixture(scope="module")
def result(ssp: Path) -> Any:
    """What FMPy computes of the system as it is. It takes one set of parameters."""
    parameters = read_ssv(str(ssp), "resources/plant.ssv")
    for parameter in parameters.parameters:
        parameter.name = f"plant.{parameter.name}"
    for parameter in read_ssv(str(ssp), "resources/estimator.ssv").parameters:
        parameter.name = f"estimator.{parameter.name}"
        parameters.parameters.append(parameter)
    return simulate_ssp(str(ssp), stop_time=STEPS * T, step_size=T, parameter_set=parameters)


def test_fmpy_passes_zeros_to_the_first_tick_and_is_else_exact(result: Any) -> None:
    """The plant in the loop of the package, and the estimator without an FMU, are identical."""
    still, record = np.zeros((len(result), 1)), ("sigma", *RESIDUAL.connections.values())
    plant = run_plant("AwasPlant", ["tau"], T, still, SIGNALS, record, t=result["time"])
    # FMPy records the outputs of the plant after the step with the time of its begin.
    np.testing.assert_array_equal(result["plant.sigma"][:-1], plant["sigma"][1:])
    measured = {to: np.append(0.0, plant[of][1:]) for to, of in RESIDUAL.connections.items()}
    ticks = sigmahat.Estimator({}).run(**measured)["sigma"]
    np.testing.assert_array_equal(result["estimator.sigma"], ticks)
    assert ticks.any()


def test_the_system_as_it_is_gives_table_1(result: Any) -> None:
    recording = simulate(TABLE1.plant, {"RESIDUAL": RESIDUAL}, T, STEPS)
    plant, estimate = recording.plant["sigma"], recording.estimators["RESIDUAL"]["sigma"]
    np.testing.assert_allclose(result["plant.sigma"][:STEPS], plant[1:], rtol=1e-10)
    # What is left after a second is the first tick, whose inputs FMPy sets to 0.
    settled = slice(round(1.0 / T) + 1, STEPS)
    np.testing.assert_allclose(result["estimator.sigma"][settled], estimate[settled], rtol=1e-6)


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
                references = [fmu.variables["sigma"].valueReference]
            (found,) = observer.last_real_values(
                slave_index=slaves[element], variable_references=references
            )
            assert found == pytest.approx(expected, rel=1e-9)
