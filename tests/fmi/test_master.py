"""The co-simulation master of the harness."""

import gc
import logging
import math
import os
import shutil
import sys
from dataclasses import replace
from pathlib import Path
from typing import Any

import fmpy
import numpy as np
import pytest
from fmpy import fmi2

import sigmahat
from controllers import run
from plant_runs import QUIET
from recordings import one_seed
from sigmahat.experiments.scenario import T
from sigmahat.fmi.instance import Fmu, Slave, opened
from sigmahat.fmi.master import simulate
from sigmahat.fmi.model import FmuError
from sigmahat.paper.scenarios import scenario

PLANT = scenario("table1").plant
RESIDUAL = scenario("table1").estimators["RESIDUAL"]


def test_fmpy_gives_the_same_estimate_from_the_recorded_measurements() -> None:
    """Outputs of an estimator that ran beside five others, without an effect of these others."""
    recording = one_seed("table1").recording
    names = ["time", *RESIDUAL.connections]
    inputs = np.zeros(len(recording.t), [(name, np.float64) for name in names])
    inputs["time"] = recording.t
    for to, source in RESIDUAL.connections.items():
        inputs[to] = recording.plant[source]
    path = sigmahat.fmu("StiffnessEstimator")
    with Fmu(path) as fmu:  # FMPy requires enumerations as numbers
        start = {name: fmu.number(name, value) for name, value in RESIDUAL.start.items()}
    alone = fmpy.simulate_fmu(
        path,
        start_values=start,
        stop_time=recording.t[-1],
        output_interval=T,
        step_size=T,
        input=inputs,
        output=["sigma", "tau_e", "a"],
    )
    # Row k + 1 of FMPy contains the outputs after the step from t_k, hence of the tick at t_k.
    for output in ("sigma", "tau_e", "a"):
        ours = recording.estimators["RESIDUAL"][output][: len(alone) - 1]
        np.testing.assert_array_equal(ours, alone[output][1:])


def test_inputs_are_linear_between_samples() -> None:
    plant = replace(PLANT, start={**PLANT.start, **QUIET}, record=("tau_measured", "theta"))
    coarse, fine = (simulate(plant, {}, h, round(0.5 / h)) for h in (1e-2, 1e-4))
    tau = PLANT.inputs["tau"]
    np.testing.assert_allclose(coarse.plant["tau_measured"], tau(coarse.t), rtol=0, atol=1e-15)
    # A torque held over the step would be late by 5 ms, which is 4 % of the final position here.
    np.testing.assert_allclose(coarse.plant["theta"], fine.plant["theta"][::100], rtol=0, atol=1e-5)


def test_an_enumeration_is_recorded_by_the_names_of_its_items() -> None:
    start = {**RESIDUAL.start, "method": "FilteredRegression"}
    regression = replace(RESIDUAL, start=start, record=["sigma", "doubt", "confident"])
    paper = replace(RESIDUAL, record=["doubt"])
    recording = simulate(PLANT, {"regression": regression, "paper": paper}, T, 6000)
    doubt = recording.estimators["regression"]["doubt"]
    assert np.array_equal(doubt == "None", recording.estimators["regression"]["confident"] == 1)
    assert {"None", "NotExcited"} <= set(doubt)
    assert set(recording.estimators["paper"]["doubt"]) == {"NoClaim"}


@pytest.mark.parametrize("steps", [99, 250])
def test_progress_adds_up_to_the_number_of_steps(steps: int) -> None:
    done: list[int] = []
    simulate(PLANT, {}, T, steps, progress=done.append)
    assert sum(done) == steps


@pytest.mark.parametrize(
    ("plant", "estimator", "message"),
    [
        (
            {"start": {"initial.thetac": 1.0}},
            {},
            "'initial.thetac'; did you mean 'initial.theta_c'",
        ),
        (
            {"inputs": {"tau_d": PLANT.inputs["tau"]}},
            {},
            r"input of AwasPlant 'tau_d'; .*\(there are: tau, tau_c, tau_ext\)",
        ),
        ({"record": ("sigmaa",)}, {}, "'sigmaa'; did you mean 'sigma'"),
        (
            {},
            {"start": {"modality": "Sensr"}},
            r"value of StiffnessEstimator.modality 'Sensr'; did you mean 'Sensor'\?"
            r" \(there are: Model, Residual, Sensor\)",
        ),
        ({}, {"start": {"rls.n": "six"}}, "rls.n: expected Integer, got 'six'"),
        ({}, {"start": {"rls.n": 2.5}}, "rls.n: expected Integer, got 2.5"),
        (
            {},
            {"connections": {"theta_d": "theta"}},
            r"input of StiffnessEstimator 'theta_d'; did you mean 'theta_c' or 'theta'\?",
        ),
        ({}, {"connections": {"theta": "noise.seed"}}, "output of AwasPlant 'noise.seed'"),
    ],
)
def test_wrong_names_are_refused(
    plant: dict[str, Any], estimator: dict[str, Any], message: str
) -> None:
    with pytest.raises(ValueError, match=message):
        simulate(replace(PLANT, **plant), {"one": replace(RESIDUAL, **estimator)}, T, 1)


def test_a_missing_fmu_is_an_error_that_lists_the_existing_ones() -> None:
    with pytest.raises(FileNotFoundError, match=r"no NoSuchPlant\.fmu in .*StiffnessEstimator"):
        simulate(replace(PLANT, fmu="NoSuchPlant"), {}, T, 1)


def test_unpacked_files_are_there_once_and_are_removed_in_the_end(tmp_path: Path) -> None:
    program = """
from dataclasses import replace
import os, sigmahat
table1 = sigmahat.scenario("table1")
one = table1.estimators["RESIDUAL"]
for K_I in (300.0, -1.0, 300.0):
    changed = replace(one, start={**one.start, "residual.K_I": K_I})
    try:
        sigmahat.simulate(table1.plant, {"one": changed}, 1e-3, 1)
    except sigmahat.FmuError:
        pass
    print(len(os.listdir(os.environ["TMPDIR"])))
"""
    assert run(sys.executable, "-c", program, environment={"TMPDIR": str(tmp_path)}) == "2\n2\n2\n"
    assert list(tmp_path.iterdir()) == []


def test_a_file_that_has_changed_is_unpacked_again(tmp_path: Path) -> None:
    copy = tmp_path / "copy.fmu"
    shutil.copy(sigmahat.fmu("AwasPlant"), copy)
    assert opened(copy) is opened(copy)
    shutil.copy(sigmahat.fmu("FlexibleJointPlant"), copy)
    assert opened(copy).name == "FlexibleJointPlant"


@pytest.mark.parametrize("content", [b"", b"not a zip file", b"PK\x05\x06" + bytes(18)])
def test_a_file_that_is_no_fmu_is_refused(content: bytes, tmp_path: Path) -> None:
    file = tmp_path / "broken.fmu"
    file.write_bytes(content)
    with pytest.raises(FmuError, match=r"broken\.fmu: not a readable FMU"):
        Fmu(file)


@pytest.mark.skipif(not hasattr(os, "fork"), reason="each try is a fork")
def test_threads_may_read_their_first_fmus_at_the_same_time() -> None:
    """Each of 200 new processes reads the schema of descriptions in four threads at once. Without
    the remedy in sigmahat.fmi.instance, one of some fifty fails or crashes."""
    program = """
import os, threading
from pathlib import Path
import fmpy, sigmahat.fmi.instance
from lxml import etree

schema = Path(fmpy.__file__).parent / "schema" / "fmi2" / "fmi2ModelDescription.xsd"

def read():
    begin.wait()
    try:
        etree.XMLSchema(file=str(schema))
    except Exception:
        os._exit(1)

failed = 0
for _ in range(200):
    child = os.fork()
    if child == 0:
        begin = threading.Barrier(4)
        threads = [threading.Thread(target=read) for _ in range(4)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        os._exit(0)
    failed += os.waitpid(child, 0)[1] != 0
print(failed)
"""
    assert run(sys.executable, "-c", program) == "0\n"


# Messages of FMUs: each message is assigned to its slave


def step_without_theta(slave: Slave) -> None:
    theta = slave.fmu.references(["theta"])
    one = (fmi2.fmi2Real * 1)(math.nan)
    slave.call(slave.functions.fmi2SetReal, theta, 1, one)
    slave.call(slave.functions.fmi2DoStep, 0.0, T, 1)


def test_a_warning_has_the_name_of_its_slave_also_after_another_one_is_gone(
    caplog: pytest.LogCaptureFixture,
) -> None:
    with (
        caplog.at_level(logging.WARNING, "sigmahat"),
        Fmu(sigmahat.fmu("StiffnessEstimator")) as fmu,
        Slave(fmu, "older") as older,
    ):
        older.initialize({})
        with Slave(fmu, "newer") as newer:
            newer.initialize({})
            step_without_theta(newer)
        del newer
        gc.collect()
        step_without_theta(older)
    assert [record.getMessage().split(":")[0] for record in caplog.records] == ["newer", "older"]


def test_an_error_is_raised_with_the_messages_of_its_slave() -> None:
    with (
        Fmu(sigmahat.fmu("StiffnessEstimator")) as fmu,
        Slave(fmu, "wrong") as wrong,
        Slave(fmu, "later"),
        pytest.raises(FmuError, match=r"^wrong: .*residual\.K_I.* out of its range"),
    ):
        wrong.initialize({"residual.K_I": -1.0})
