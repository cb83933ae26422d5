"""The simulated joint in the browser: the numbers of the FMUs, settings, time, how it looks."""

import re
import time
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import fmpy
import numpy as np
import pytest
from selenium.webdriver.common.keys import Keys

import sigmahat
from browser import opened
from sigmahat.experiments.simulation import run
from sigmahat.paper.scenarios import scenario
from web_page import WebPage, web_page

_DRAWN = """
const canvas = document.getElementById(arguments[0]), color = getComputedStyle(
  document.documentElement).getPropertyValue(`--${arguments[1]}`);
const pen = canvas.getContext("2d"), one = document.createElement("canvas").getContext("2d");
one.fillStyle = color;
one.fillRect(0, 0, 1, 1);
const [r, g, b] = one.getImageData(0, 0, 1, 1).data;
const { data } = pen.getImageData(0, 0, canvas.width, canvas.height);
let count = 0;
for (let i = 0; i < data.length; i += 4)
  count += data[i] === r && data[i + 1] === g && data[i + 2] === b && data[i + 3] === 255;
return count;
"""


WITHIN = 1e-12  # error over the range of each output
_SIMULATE = """
const [method, plant, estimator, count] = given;
joint.form.elements.method.value = METHODS[method];
const record = { plant, estimator };
const simulation = new Simulation(joint.plant, joint.estimator, joint.starts(), record);
const found = {};
for (const [of, names] of Object.entries(record))
  for (const name of names) found[`${of} ${name}`] = new Float64Array(count);
for (let k = 0; k < count; k += 1) {
  const values = simulation.advance();
  for (const [of, names] of Object.entries(record))
    names.forEach((name, i) => { found[`${of} ${name}`][k] = values[of][i]; });
}
return found;
"""


@pytest.fixture(scope="module")
def page(site: Path) -> Iterator[WebPage]:
    with web_page(site / "web") as page:
        yield page


def simulate(page: WebPage, seconds: float) -> None:
    """Lets simulated time pass at once."""
    steps = "arguments[0] / SCENARIO.T"
    page.page.run(f"joint.start(); joint.advance({steps}, Infinity); joint.show()", seconds)


def outputs(fmu: str) -> list[str]:
    variables = fmpy.read_model_description(str(sigmahat.fmu(fmu))).modelVariables
    return [v.name for v in variables if v.causality == "output" and v.type == "Real"]


@pytest.mark.parametrize("method", ["Paper2011", "FilteredRegression"])
def test_table1_in_the_browser_is_that_of_the_fmus(method: str, page: WebPage) -> None:
    """The plant makes its torques itself, by the settings that the page opens with."""
    plant, estimator = outputs("AwasPlant"), outputs("StiffnessEstimator")
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


def test_time_passes_pauses_and_starts_again(page: WebPage) -> None:
    page.sets("speed", "10")
    button = page.page.driver.find_element("id", "run")
    simulate(page, 15)
    assert button.text == "Start" and page.time() == 15
    page.page.driver.find_element("id", "again").click()
    assert button.text == "Pause" and page.time() < 15
    time.sleep(0.5)
    button.send_keys(Keys.ENTER)
    reached = page.time()
    assert button.text == "Start" and reached > 0.5
    time.sleep(0.1)
    assert page.time() == reached
    page.sets("coulomb", 10)
    assert page.time() == 0
    page.sets("coulomb", 0)


def test_wrong_friction_misleads_paper2011_and_not_filtered_regression(page: WebPage) -> None:
    """Only the method with an interval has a band in the plot."""
    errors = {}
    for method, claims in (("Paper2011", False), ("FilteredRegression", True)):
        page.page.run("joint.form.elements.method.value = METHODS[arguments[0]]", method)
        for friction in (20, 0):
            page.sets("friction", friction)
            simulate(page, 15)
            shown = page.text("value-error").removesuffix(" %").replace("\N{MINUS SIGN}", "-")
            errors[method, friction] = abs(float(shown))
        assert ("±" in page.text("value-sigma")) == claims
        assert (page.text("value-doubt") == "confident") == claims
    assert errors["Paper2011", 20] > 20 > 5 > errors["FilteredRegression", 20]
    assert max(errors["Paper2011", 0], errors["FilteredRegression", 0]) < 5


def test_the_band_holds_without_noise(page: WebPage) -> None:
    """The estimator assumes almost no noise; it once assumed the noise of the paper."""
    page.page.run("joint.form.elements.method.value = METHODS.FilteredRegression")
    for noise in (0, 1):
        page.sets("noise", noise)
        simulate(page, 45)
        names = "['sigma', 'sigma_hat', 'half']"
        last = f"return {names}.map((name) => joint.history.get(name).at(-1))"
        sigma, estimate, half = page.page.run(last)
        assert abs(estimate - sigma) < half
        assert page.text("value-doubt") == "confident"


def test_what_plant_and_estimator_refuse_is_shown_in_their_own_words(page: WebPage) -> None:
    fields = "const { coulomb, friction } = joint.form.elements;"
    page.page.run(f"{fields} friction.min = -200; coulomb.min = -5")
    page.sets("friction", -150)
    assert "motor.D_theta: expected >= 0, got -0.0005" in page.text("joint-message")
    page.sets("friction", 0)
    assert page.text("joint-message") == ""
    page.sets("coulomb", -5)
    assert "motor.tau_coulomb = -0.005" in page.text("joint-message")
    page.sets("coulomb", 0)
    assert page.text("joint-message") == ""


REFUSED = """
const done = arguments[0];
document.addEventListener("securitypolicyviolation", (event) => done(event.effectiveDirective));
fetch("http://127.0.0.1:9/").catch(() => {});
"""
"""Message of the browser after an attempt to send something."""


@pytest.mark.parametrize("asked", ["?ws=ws://127.0.0.1:8765", ""])
def test_the_page_reaches_no_address(asked: str, site: Path) -> None:
    with opened((site / "web" / "index.html").as_uri() + asked) as page:
        assert page.driver.execute_async_script(REFUSED) == "connect-src"


@pytest.mark.parametrize(("width", "dark"), [(1400, False), (360, True)], ids=["desk", "phone"])
def test_it_fits_the_window_without_a_complaint(width: int, dark: bool, site: Path) -> None:
    with web_page(site / "web", width, dark) as web:
        simulate(web, 10)
        web.runs(True)
        time.sleep(0.2)
        shown = web.page.run("return getComputedStyle(document.body).backgroundColor")
        brightness = sum(map(int, re.findall(r"\d+", shown)[:3])) / 3
        assert brightness < 64 if dark else brightness > 192
        assert web.page.run("return document.documentElement.scrollWidth") <= width
        for drawn in (["stiffness", "true"], ["stiffness", "estimate"], ["torque", "estimate"]):
            assert web.page.run(_DRAWN, *drawn) > 100, drawn
        assert web.page.complaints() == []
        assert all(url.startswith("file:") for url in web.page.requests())
