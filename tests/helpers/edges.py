"""Common parts of the tests of the numerical promises in docs/proof/promises.md.

Parameters and measurements are at the edges of what is allowed. SIGMAHAT_PROMISES=100 runs a
hundred times as many examples.
"""

import math
import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any
from xml.etree.ElementTree import Element

import numpy as np
import pytest
from hypothesis import HealthCheck, settings
from hypothesis import strategies as st

from c_library import MEASUREMENTS, REALS, Array, Library, compile_library
from c_sources import REPOSITORY
from sigmahat.plant_fmu.model_description import items, variables
from sigmahat_build.description_template import render

EPSILON = {"double": 2.0**-53, "float": 2.0**-24}
"""Unit roundoff."""
SMALLEST = {"double": 5e-324, "float": 1.4e-45}
"""Smallest subnormal number."""
LARGEST = 1e12
"""Largest magnitude of a measurement, and of most parameters of docs/proof/promises.md."""
SUBNORMAL = (4.9e-324, 1e-310, 1e-45, 1e-40)  # the last two in single precision

_DESCRIPTION = render(REPOSITORY / "modelDescription" / "StiffnessEstimator.xml", "")
_PARAMETERS: Mapping[str, Element] = {
    v.attrib["name"]: v[0]
    for v in variables(_DESCRIPTION)
    if v.attrib["causality"] == "parameter" and "[" not in v.attrib["name"]
}

RANGES: Mapping[str, tuple[float, float]] = {
    **{
        name: (float(kind.get("min", 0)), min(float(kind.get("max", LARGEST)), LARGEST))
        for name, kind in _PARAMETERS.items()
        if kind.tag == "Real" and name not in ("samplePeriod", "regression.bandwidth")
    },
    "motor.gamma": (1e-6, 1e6),
    "rls.P_0": (1e-30, 1e20),
}
"""The domain of the promises. gamma, offset, scale and rls.eta_0 may be negative."""


def magnitudes(low: float, high: float) -> st.SearchStrategy[float]:
    """Numbers from the lower to the upper limit, including both, on a logarithmic scale."""
    exponents = st.floats(math.log10(max(low, 1e-15)), math.log10(high))
    between = exponents.map(lambda e: min(max(10.0**e, low), high))
    return st.one_of(st.sampled_from([float(low), float(high)]), between)


def _choices(kind: Element) -> Sequence[int]:
    if kind.tag == "Enumeration":
        return range(1, len(items(_DESCRIPTION, kind)) + 1)
    return range(int(kind.get("min", 0)), int(kind.get("max", 1)) + 1)


_CHOICES: Mapping[str, Sequence[int]] = {
    name: _choices(kind)
    for name, kind in _PARAMETERS.items()
    if kind.tag != "Real" and name != "method"
}
_SIGNED = ("motor.gamma", "setPoint.offset", "setPoint.scale")


@st.composite
def parameters(draw: st.DrawFn, method: int, real: str) -> dict[str, Any]:
    """Parameters by dotted name, in the domain of the promises for a type of numbers; some of them
    are the defaults."""
    names = draw(st.lists(st.sampled_from(sorted(RANGES)), unique=True, max_size=12))
    values: dict[str, Any] = {name: draw(magnitudes(*RANGES[name])) for name in names}
    for name in _SIGNED:
        if name in values and draw(st.booleans()):
            values[name] = -values[name]
    values |= {name: draw(st.sampled_from(choice)) for name, choice in _CHOICES.items()}
    period = draw(st.one_of(st.just(1e-3), magnitudes(1e-9, 1e3)))
    wT = draw(st.sampled_from([0.35, 1.001e-4, 1.99]))
    values |= {"method": method, "samplePeriod": period, "regression.bandwidth": wT / period}
    if method == 1:
        values["residual.K_I"] = min(values.get("residual.K_I", 300.0), 1.99 / period)
    elif not values.get("prior.tau_e", 45.0) > 0:
        values["prior.tau_e"] = LARGEST
    if "filter.V_min" in values or "filter.V_max" in values:
        pair = values.get("filter.V_min", 0.1), values.get("filter.V_max", 10.0)
        values["filter.V_min"], values["filter.V_max"] = min(pair), max(pair)
    if real == "float":
        weight = values.get("rls.c", 1e-20) if values["rls.kind"] == 1 else 1.0
        values["rls.P_0"] = min(values.get("rls.P_0", 1e20), 1e3 / weight)
    if draw(st.integers(0, 3)) == 0:
        eta_0 = np.zeros((8, 5))
        place = draw(st.integers(0, 7)), draw(st.integers(0, 4))
        eta_0[place] = draw(st.sampled_from([-1, 1])) * draw(magnitudes(1e-12, LARGEST))
        values["rls.eta_0"] = eta_0.tolist()
    return values


_KINDS = ("motion", "motion", "rest", "counts", "ramp", "glitches", "edges")


def _signal(kind: str, rng: np.random.Generator, k: Array, amplitude: float) -> Array:
    if kind == "rest":
        return np.full(len(k), amplitude if rng.random() < 0.5 else 0.0)
    if kind == "ramp":
        return amplitude * k
    if kind == "edges":
        edges = np.array([0.0, LARGEST, -LARGEST, amplitude, 1.0, *SUBNORMAL])
        return np.asarray(rng.choice(edges, len(k)), dtype=np.float64)
    noise = 10.0 ** rng.uniform(-6, 0) * rng.uniform(-1, 1, len(k))
    wave = np.sin(k * 10.0 ** rng.uniform(-2, 0.5)) + noise
    if kind == "glitches":
        return np.where(rng.random(len(k)) < 0.02, amplitude, wave)
    count = 2 * np.pi / 40000 if kind == "counts" else 0.0
    return np.round(amplitude * wave / count) * count if count else np.asarray(amplitude * wave)


@st.composite
def measurements(draw: st.DrawFn) -> Array:
    """Samples [size: ticks x 5] up to the largest allowed magnitude, with gaps of NaN."""
    rng = np.random.default_rng(draw(st.integers(0, 2**32)))
    k = np.arange(draw(st.sampled_from([30, 150, 400])), dtype=np.float64)
    z = np.empty((len(k), len(MEASUREMENTS)))
    for i in range(len(MEASUREMENTS)):
        amplitude = draw(st.one_of(magnitudes(1e-3, 1e3), magnitudes(1e-12, LARGEST)))
        z[:, i] = _signal(draw(st.sampled_from(_KINDS)), rng, k, amplitude)
    if draw(st.booleans()):  # the link follows the motor
        z[:, 1] = z[:, 0] * (1 + 10.0 ** rng.uniform(-6, 0))
    z = np.clip(z, -LARGEST, LARGEST)
    z[rng.random(len(k)) < 0.01, rng.integers(0, 2)] = math.nan
    return z


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
    """The library of the build in double precision, and a library in single precision."""
    if request.param == "double":
        return Library(build)
    return compile_library(tmp_path_factory.getbasetemp(), request.param)


def reals(c: Library, values: Any) -> Array:
    """An array of the library's type."""
    with np.errstate(over="ignore"):  # to infinity, as C does
        return np.ascontiguousarray(values, dtype="f8" if c.real == "double" else "f4")
