"""The examples run, and their results are right."""

import importlib
import re
import runpy
import sys
from functools import cache
from pathlib import Path

import fmpy.validation
import nbclient
import nbformat
import numpy as np
import pyarrow.csv
import pytest

import sigmahat
from controllers import run

EXAMPLES = Path(__file__).parents[2] / "examples"


def test_own_log(tmp_path: Path) -> None:
    printed = run(sys.executable, EXAMPLES / "own_log.py", cwd=tmp_path)
    tutorial = runpy.run_path(str(EXAMPLES / "tutorial" / "record.py"))
    for name in ("B", "D_theta", "tau_coulomb"):
        found = re.search(rf"^{name}: (\S+) \+- (\S+)$", printed, re.M)
        true = tutorial["JOINT"][f"motor.{name}"]
        assert found and abs(float(found[1]) - true) <= float(found[2])
    table = pyarrow.csv.read_csv(tmp_path / "own_log" / "estimate.csv")
    estimate = table["estimate.sigma [N.m/rad]"].to_numpy()
    joint = tutorial["record"](tmp_path / "knee.csv")
    late = joint.t >= joint.t[-1] / 2
    sigma = joint.plant["sigma"][late]
    assert np.max(np.abs(estimate[late] - sigma) / sigma) < 0.02
    assert (tmp_path / "own_log" / "estimate.png").stat().st_size > 0


def test_own_plant(tmp_path: Path) -> None:
    printed = run(sys.executable, EXAMPLES / "own_plant.py", cwd=tmp_path)
    found = re.search(r"after 1 s, MSREP (\S+) %", printed)
    assert found and float(found[1]) < 0.01  # the RMS error is below 1 %

    fmu = tmp_path / "PendulumPlant.fmu"
    assert fmpy.validation.validate_fmu(str(fmu)) == []


@pytest.mark.slow("two controlled runs, tick by tick")
def test_stiffness_control(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.syspath_prepend(EXAMPLES)
    example = importlib.import_module("stiffness_control")
    monkeypatch.setattr(example, "run", cache(example.run))
    example.main(tmp_path)
    assert (tmp_path / "stiffness_control.png").stat().st_size > 0
    t, wanted, true, _, _ = example.run(True).T
    for last, stiffness in ((7, 200.0), (14, 320.0), (20, 150.0)):  # last second of each step
        settled = (t >= last - 1) & (t < last)
        assert set(wanted[settled]) == {stiffness}
        np.testing.assert_allclose(true[settled], stiffness, rtol=0.015)
    sine = t >= example.DURATION - 20
    assert np.mean(np.abs(true - wanted)[sine] / wanted[sine]) < 0.03
    # Without the estimate, the controller does not know that the springs are 15 % softer.
    t, wanted, true, _, _ = example.run(False).T
    settled = (t >= 13) & (t < 14)
    np.testing.assert_allclose(true[settled], 0.85 * wanted[settled], rtol=0.01)


def test_notebook(tmp_path: Path) -> None:
    notebook = nbformat.read(EXAMPLES / "stiffness.ipynb", as_version=4)  # type: ignore[no-untyped-call]
    for cell in notebook.cells:  # the notebook has no stored outputs
        assert not cell.get("outputs") and cell.get("execution_count") is None
    resources = {"metadata": {"path": str(tmp_path)}}
    nbclient.NotebookClient(notebook, resources=resources).execute()
    outputs = [output for cell in notebook.cells for output in cell.get("outputs", [])]
    (text,) = (output["text"] for output in outputs if output.get("name") == "stdout")
    (picture,) = (output["data"] for output in outputs if "data" in output)
    assert "image/png" in picture
    exact, wrong = (float(found) for found in re.findall(r"after 1 s (\S+) %", text))
    once = sigmahat.run(sigmahat.scenario("table1"), seed=1)
    own = once.estimators["RESIDUAL"]["sigma"]
    found = sigmahat.indices(once.t, once.plant["sigma"], own)
    assert exact == float(f"{found.msrep_settled:.3g}")
    assert wrong > 25  # the RMS error is far above 5 %, as the notebook says
