"""Tests of the grid of a sweep, which comes from the command line."""

from itertools import product
from typing import Any

import pytest

from sigmahat.fmi.model import FmuError
from sigmahat.studies.sweep import check
from sigmahat.studies.sweep_grid import Drawn, read_grid, values


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("0.9e-3,1.1e-3", (0.9e-3, 1.1e-3)),
        ("4, 6", (4, 6)),
        ("3", (3,)),
        ("Enhanced", ("Enhanced",)),
        ("true,false", (True, False)),
        ("1:2:5", (1.0, 1.25, 1.5, 1.75, 2.0)),
        ("uniform(1, 2)", Drawn("uniform", 1.0, 2.0)),
        ("normal(-1e-3,5e-5)", Drawn("normal", -1e-3, 5e-5)),
    ],
)
def test_values(text: str, expected: object) -> None:
    assert values(text) == expected


@pytest.mark.parametrize(
    "text",
    ["", "1,,2", "1:2:1", "1:1:3", "1:2:x", "1:2:1000000000", "uniform(2,1)", "normal(1,0)",
     "normal(1)", "uniform(a,b)", "gauss(1,2)", "1,1", "nan:1:2", "uniform(1,inf)"],
)  # fmt: skip
def test_values_that_do_not_fit(text: str) -> None:
    with pytest.raises(ValueError, match=r"expected|given twice"):
        values(text)


def test_runs_in_the_order_of_the_settings() -> None:
    names = ("plant.motor.D_theta", "estimator.rls.kind", "RESIDUAL.motor.B")
    texts = ("0.9e-3,1.1e-3", "Enhanced,Standard", "normal(2.3e-5, 1e-6)")
    settings = [f"{name} = {text}" for name, text in zip(names, texts, strict=True)]
    grid = read_grid(("table1", "as-printed"), 2, ("RESIDUAL",), ["RESIDUAL.motor.B=1", *settings])
    runs = grid.runs
    assert [run.number for run in runs] == list(range(grid.count)) == list(range(16))
    listed = [(r.scenario, *(r.parameters[name] for name in names[:2]), r.seed) for r in runs]
    lists = (("table1", "as-printed"), (0.9e-3, 1.1e-3), ("Enhanced", "Standard"), (1, 2))
    assert listed == [*product(*lists)]
    # Runs with the same seed have the same random parameter, even if other parameters differ.
    drawn = {(r.seed, r.parameters["RESIDUAL.motor.B"]) for r in runs}
    (_, first), (_, second) = sorted(drawn)  # two pairs
    assert first != second


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({"scenarios": ("tabel1",)}, "did you mean 'table1'"),
        ({"scenarios": ("table1", "table1")}, "once"),
        ({"modalities": ("RESIDAUL",)}, "did you mean 'RESIDUAL'"),
        ("plant.motor.D_teta=1", "did you mean 'motor.D_theta'"),
        ("plnt.motor.D_theta=1", "did you mean 'plant'"),
        ("plant.tau=1", "unknown parameter of AwasPlant 'tau'"),
        ("estimator.rls.kind=Standrad", "did you mean 'Standard'"),
        ("estimator.rls.n=2.5", "expected Integer"),
        ("estimator.motor.B=-1", "motor.B"),
        ("plant.noise.seed=3", "--seeds"),
        ("plant.link.M=normal(1)", "plant.link.M: expected"),
        ("plant.link.M=1:2:900000 plant.link.D_q=1:2:9", "expected at most"),
    ],
)
def test_a_grid_that_does_not_fit(given: Any, words: str) -> None:
    options = given if isinstance(given, dict) else {"settings": given.split()}
    with pytest.raises((ValueError, FmuError)) as error:
        check(read_grid(**{"scenarios": ("table1",), **options}))
    assert words in str(error.value)
