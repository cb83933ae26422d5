"""The plan of a sweep, from a file and the command line."""

import re
from itertools import product
from pathlib import Path

import numpy as np
import pytest

from sigmahat.fmi.instance import FmuError
from sigmahat.sweep.plan import Drawn, read_plan, values
from sigmahat.sweep.preparation import check

PLAN = """\
scenario = ["table1", "as-printed"]
seeds = 2
modality = "RESIDUAL"
[parameters]
plant.motor.D_theta = [0.9e-3, 1.1e-3]
estimator.rls.kind = "Enhanced,Standard"
RESIDUAL.motor.B = "normal(2.3e-5, 1e-6)"
"""


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("0.9e-3,1.1e-3", (0.9e-3, 1.1e-3)),
        ("4, 6", (4, 6)),
        (3, (3,)),
        ([1.5, 2], (1.5, 2)),
        ("Enhanced", ("Enhanced",)),
        ("true,false", (True, False)),
        ("1:2:5", (1.0, 1.25, 1.5, 1.75, 2.0)),
        ("uniform(1, 2)", Drawn("uniform", 1.0, 2.0)),
        ("normal(-1e-3,5e-5)", Drawn("normal", -1e-3, 5e-5)),
    ],
)
def test_values(text: object, expected: object) -> None:
    assert values(text) == expected


@pytest.mark.parametrize(
    "text",
    ["", "1,,2", "1:2:1", "1:1:3", "1:2:x", "1:2:1000000000", "uniform(2,1)", "normal(1,0)",
     "normal(1)", "uniform(a,b)", "gauss(1,2)", "1,1", [], [[1]], "nan:1:2", "uniform(1,inf)"],
)  # fmt: skip
def test_values_that_do_not_fit(text: object) -> None:
    with pytest.raises(ValueError, match=r"expected|given twice"):
        values(text)


def test_runs_in_the_order_of_the_file(tmp_path: Path) -> None:
    path = tmp_path / "plan.toml"
    path.write_text(PLAN)
    runs = read_plan(path).runs
    assert [run.number for run in runs] == list(range(16))
    names = ("plant.motor.D_theta", "estimator.rls.kind")
    settings = [(r.scenario, *(r.parameters[name] for name in names), r.seed) for r in runs]
    lists = (("table1", "as-printed"), (0.9e-3, 1.1e-3), ("Enhanced", "Standard"), (1, 2))
    assert settings == [*product(*lists)]
    # What is drawn is the same for the same seed, whatever else differs.
    drawn = {(r.seed, r.parameters["RESIDUAL.motor.B"]) for r in runs}
    (_, first), (_, second) = sorted(drawn)  # two pairs
    assert first != second


def test_the_plan_of_the_documentation(tmp_path: Path) -> None:
    page = Path(__file__).parents[2] / "docs" / "sweeps.md"
    (text,) = re.findall(r"```toml\n(.*?)```", page.read_text(encoding="utf-8"), re.DOTALL)
    (tmp_path / "plan.toml").write_text(text)
    plan = read_plan(tmp_path / "plan.toml")
    assert (plan.count, plan.modalities) == (100, ("RESIDUAL",))
    assert plan.parameters == {
        "estimator.motor.D_theta": tuple(np.linspace(0.9e-3, 1.1e-3, 5).tolist()),
        "plant.link.M": Drawn("normal", 0.1, 0.005),
    }


def test_options_replace_the_file(tmp_path: Path) -> None:
    path = tmp_path / "plan.toml"
    path.write_text(PLAN)
    settings = ["plant.motor.D_theta=1e-3", "plant.link.M=0.1,0.2"]
    plan = read_plan(path, ("table1",), 3, ("RESIDUAL", "SENSOR"), settings)
    assert plan.scenarios == ("table1",)
    assert plan.modalities == ("RESIDUAL", "SENSOR")
    assert plan.count == len(plan.runs) == 1 * 3 * 1 * 2 * 2


@pytest.mark.parametrize(
    ("content", "words"),
    [
        ("sceanrio = 'table1'", "did you mean 'scenario'"),
        ("scenario = 'tabel1'", "did you mean 'table1'"),
        ("scenario = 3", "scenario: expected a list of names"),
        ("seeds = 0", "seeds: expected"),
        ("seeds = [1, 2]", "seeds: expected"),
        ("modality = ['RESIDAUL']", "did you mean 'RESIDUAL'"),
        ("scenario = ['table1', 'table1']", "once"),
        ("[parameters]\nplant.motor.D_teta = 1", "did you mean 'motor.D_theta'"),
        ("[parameters]\nplnt.motor.D_theta = 1", "did you mean 'plant'"),
        ("[parameters]\nplant.tau = 1", "unknown parameter of AwasPlant 'tau'"),
        ("[parameters]\nestimator.rls.kind = 'Standrad'", "did you mean 'Standard'"),
        ("[parameters]\nestimator.rls.n = 2.5", "expected Integer"),
        ("[parameters]\nestimator.motor.B = -1", "motor.B"),
        ("[parameters]\nplant.noise.seed = 3", "--seeds"),
        ("[parameters]\nplant.link.M = 'normal(1)'", "plant.link.M: expected"),
        ("[parameters]\nplant.link.M = '1:2:900000'\nplant.link.D_q = '1:2:9'", "at most"),
        ("parameters = 3", "expected a table"),
        ("= 3", "not readable as TOML"),
    ],
)
def test_a_plan_that_does_not_fit(content: str, words: str, tmp_path: Path) -> None:
    path = tmp_path / "plan.toml"
    path.write_text(content)
    with pytest.raises((ValueError, FmuError)) as error:
        check(read_plan(path))
    assert words in str(error.value)
