"""Plant and estimator in the browser compute what the FMUs compute on this machine."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import fmpy
import numpy as np
import pytest

from live_page import LivePage, live_page
from sigmahat.paper.scenarios import scenario
from sigmahat.runs.engine import run

WITHIN = 1e-12  # of the range of each output; what the project promises
_SIMULATE = """
const [method, plant, estimator, count] = given;
joint.form.elements.method.value = METHODS[method];
const record = { plant, estimator };
const simulation = new Simulation(
  joint.plant, joint.estimator, joint.starts(), joint.torques(), record);
const found = {};
for (const [of, names] of Object.entries(record))
  for (const name of names) found[`${of} ${name}`] = new Float64Array(count);
for (let k = 0; k < count; k += 1) {
  simulation.advance();
  for (const [of, names] of Object.entries(record))
    names.forEach((name, i) => { found[`${of} ${name}`][k] = simulation.recorded[of].values[i]; });
}
return found;
"""


def outputs(fmu: Path) -> list[str]:
    variables = fmpy.read_model_description(str(fmu)).modelVariables
    return [v.name for v in variables if v.causality == "output" and v.type == "Real"]


@pytest.fixture(scope="module")
def page(site: Path) -> Iterator[LivePage]:
    """The page, with the settings that it opens with."""
    with live_page(site / "live") as page:
        yield page


@pytest.mark.parametrize("method", ["Paper2011", "FilteredRegression"])
def test_table1_in_the_browser_is_that_of_the_fmus(
    method: str, page: LivePage, estimator_fmu: Path, plant_fmu: Path
) -> None:
    """The page makes its own torques, by the settings that it opens with."""
    plant, estimator = outputs(plant_fmu), outputs(estimator_fmu)
    table1 = scenario("table1")
    residual = table1.estimators["RESIDUAL"]
    residual = replace(residual, start={**residual.start, "method": method}, record=estimator)
    of_all = replace(table1.plant, record=plant)
    expected = run(replace(table1, plant=of_all, estimators={"RESIDUAL": residual}), seed=1)
    found = page.arrays(_SIMULATE, method, plant, estimator, table1.steps + 1)
    differences = {}
    for name, values in found.items():
        of, variable = name.split(" ")
        series = expected.plant if of == "plant" else expected.estimators["RESIDUAL"]
        differences[name] = np.max(np.abs(values - series[variable])), np.ptp(series[variable])
    assert len(differences) == len(plant) + len(estimator) > 70
    assert {name: d for name, d in differences.items() if d[0] > WITHIN * d[1]} == {}
