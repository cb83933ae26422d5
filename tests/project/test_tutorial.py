"""The tutorial: its log can be made again, its commands work, and its results are right."""

import re
import runpy
import shutil
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from command_line import Shell, working_in
from recorded_logs import read_estimate

REPOSITORY = Path(__file__).parents[2]
FILES = REPOSITORY / "examples" / "tutorial"
PAGE = (REPOSITORY / "docs" / "tutorial.md").read_text(encoding="utf-8")
pytestmark = pytest.mark.slow("the commands of the page run on a log of 20 s")


@pytest.fixture(scope="module")
def printed(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Any]:
    """Results of the commands of the page, by name, in a new folder."""
    folder = tmp_path_factory.mktemp("tutorial")
    shutil.copy(FILES / "knee.csv", folder)
    init, identify, estimate, report = re.findall(r"^sigmahat (.*)$", PAGE, re.MULTILINE)
    results: dict[str, Any] = {"folder": folder / "sigmahat-results" / "knee"}
    with working_in(folder):
        shell = Shell()
        shell.run(init)
        results["guess"] = Path("knee.toml").read_text(encoding="utf-8")
        shutil.copy(FILES / "knee.toml", folder)
        results["identify"], results["estimate"] = shell.json(identify), shell.json(estimate)
        shell.run(report)
    assert (results["folder"] / "report.html").is_file()
    return results


@pytest.fixture(scope="module")
def recording(tmp_path_factory: pytest.TempPathFactory) -> Any:
    """The program that made the log, the log that it makes, and the recording of the joint."""
    program = runpy.run_path(str(FILES / "record.py"))
    log = tmp_path_factory.mktemp("again") / "knee.csv"
    return program["JOINT"], log, program["record"](log)


def test_the_log_can_be_made_again_to_the_byte(recording: Any) -> None:
    assert recording[1].read_bytes() == (FILES / "knee.csv").read_bytes()


def test_the_configuration_of_the_page_is_the_one_that_comes_with_the_log() -> None:
    (shown,) = re.findall(r"```toml\n(.*?)```", PAGE, re.DOTALL)
    assert shown == (FILES / "knee.toml").read_text(encoding="utf-8")


def test_init_finds_the_columns(printed: dict[str, Any]) -> None:
    for column in ("time_s", "motor_counts", "link_deg", "current_A"):
        assert f'column = "{column}"' in printed["guess"]
    assert "wrap = 65536" in printed["guess"]


@pytest.mark.parametrize("name", ["B", "D_theta", "tau_coulomb"])
def test_the_motor_is_identified_as_the_page_says(name: str, printed: dict[str, Any]) -> None:
    row = re.search(rf"^\| `{name}` \[.*?\] \| (\S+) ± (\S+) \| (\S+) \|$", PAGE, re.MULTILINE)
    assert row
    shown, half_width, true = map(float, row.groups())
    found = printed["identify"][name]
    low, high = found["interval"]
    assert low < true < high
    assert shown == float(f"{found['value']:.4g}")
    assert half_width == float(f"{(high - low) / 2:.2g}")


def test_the_true_values_are_those_of_the_joint(printed: dict[str, Any], recording: Any) -> None:
    joint, _, made = recording
    for name in ("B", "D_theta", "tau_coulomb"):
        assert f"| {joint[f'motor.{name}']:g} |" in PAGE
    sigma = made.plant["sigma"][len(made.t) // 2 :]
    assert f"true stiffness is from {sigma.min():.0f} to {sigma.max():.0f} N.m/rad" in PAGE
    table = read_estimate(printed["folder"])
    found, std = (table[f"estimate.{name} [N.m/rad]"].to_numpy() for name in ("sigma", "sigma_std"))
    error = found[-len(sigma) :] / sigma - 1
    assert f"is {100 * np.sqrt(np.mean(error**2)):.1g} % (root mean square)" in PAGE
    assert f"is up to {100 * np.max(np.abs(error)):.1g} %" in PAGE
    claimed = std[-len(sigma) :] / sigma
    assert np.all(np.abs(error) <= 1.96 * claimed)
    assert f"{claimed[-1]:.0%}" == "2%"
