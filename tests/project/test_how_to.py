"""The code on the how-to pages works."""

import os
import re
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import fmpy
import numpy as np
import pytest

import sigmahat
from command_line import Shell
from controllers import run
from plant_runs import run_plant
from recorded_logs import REGRESSION, awas_log, write_log
from sigmahat.cli import cli
from sigmahat.experiments.scenario import T

REPOSITORY = Path(__file__).parents[2]
PAGES = REPOSITORY / "docs" / "how-to"
SIGNALS = {  # section VI.B of the paper
    **{"signal.tau.amplitude": 0.3, "signal.tau.frequency": 0.1},
    **{"signal.tau_c.amplitude": 8.0, "signal.tau_c.frequency": 0.1},
}


def blocks(page: str, language: str) -> Iterator[str]:
    text = (PAGES / page).read_text(encoding="utf-8")
    return (m[1] for m in re.finditer(rf"^```{language}\n(.*?)^```$", text, re.M | re.S))


def executed(page: str) -> dict[str, Any]:
    """Runs all Python blocks of a page in their order, and returns the resulting variables."""
    names: dict[str, Any] = {}
    for code in blocks(page, "python"):
        exec(compile(code, page, "exec"), names)
    return names


@pytest.mark.skipif(fmpy.platform != "linux64", reason="the page names the Linux binary")
def test_the_commands_of_the_page_on_c_masters_work(tmp_path: Path) -> None:
    (commands,) = blocks("c-master.md", "sh")
    (tmp_path / "examples").symlink_to(REPOSITORY / "examples")
    # The page's command python3 must be the Python of the test, which has FMPy.
    environment = {
        "PATH": f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}",
        "FMU": str(sigmahat.fmu("StiffnessEstimator")),
    }
    text = run("sh", "-e", "-c", commands, cwd=tmp_path, environment=environment)
    printed = re.fullmatch(r"sigma = (\S+) \+- (\S+) N\.m/rad, confident\n", text)
    assert printed and float(printed[1]) == pytest.approx(150.0, abs=0.1 * float(printed[2]))
    assert f"    {text}" in (PAGES / "c-master.md").read_text(encoding="utf-8")


def test_the_c_to_copy_estimates_a_stiffness(tmp_path: Path, build: Path) -> None:
    """GIVEN the C code of the page, compiled with the amalgamation, and a spring of 400 N.m/rad."""
    (code,) = blocks("../controller.md", "c")
    main = """
    #include <math.h>
    #include <stdio.h>
    int main(void) {
        double sigma = 0, std = 0;
        int k, sure = 0;
        if (start() != 0) return 1;
        for (k = 0; k < 8000; ++k) {
            const double t = k * 1e-3, w = 6.3, u = 20;
            const double theta = 0.05 * sin(w * t) + 0.02 * sin(u * t);
            const double v = 0.05 * w * cos(w * t) + 0.02 * u * cos(u * t);
            const double a = -0.05 * w * w * sin(w * t) - 0.02 * u * u * sin(u * t);
            const double phi = -0.01 * sin(3 * t) - 0.004 * sin(14 * t);
            sure = tick(theta, theta + phi, 1e-2 * a + 5e-2 * v - 400 * phi / 100, &sigma, &std);
        }
        printf("%d %g %g", sure, sigma, std);
        return 0;
    }
    """
    (tmp_path / "main.c").write_text(code + main)
    amalgamation, program = build / "amalgamation", tmp_path / "program"
    strict = ["-std=c99", "-Wall", "-Wextra", "-Wpedantic", "-Werror", f"-I{amalgamation}"]
    sources = [tmp_path / "main.c", amalgamation / "sigmahat.c"]
    run("cc", *strict, *sources, "-o", program, "-lm")
    sure, sigma, std = run(program).split()
    assert sure == "1"
    assert abs(float(sigma) - 400) < 2 * float(std) < 40


@pytest.fixture(scope="module")
def page() -> dict[str, Any]:
    return executed("fmpy.md")


def test_the_program_of_the_page_on_fmus_works_with_both_versions_of_fmi(
    build: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """GIVEN the code of the page, unchanged and with the line from the page about FMI 3.0."""
    (tmp_path / "build").symlink_to(build.resolve())
    monkeypatch.chdir(tmp_path)
    (line,) = re.findall(r"`(fmu = .*?)`", (PAGES / "fmi3.md").read_text(encoding="utf-8"))
    (program,) = blocks("../fmu.md", "python")
    of_fmi_3 = program.replace('fmu = sigmahat.fmu("StiffnessEstimator")', line)
    assert "_FMI3.fmu" in of_fmi_3
    text = (PAGES.parent / "fmu.md").read_text(encoding="utf-8")
    for code in (program, of_fmi_3):
        names: dict[str, Any] = {}
        exec(code, names)
        stiffness = names["result"]["sigma"][-1]
        # The log comes from a simulated joint with a stiffness of 1000 N.m/rad.
        assert stiffness == pytest.approx(1000.0, abs=1.0)
        assert f"The program prints {stiffness:.1f}," in text
        assert f"± {1.96 * names['result']['sigma_std'][-1]:.0f}," in text
        first = names["result"]["time"][np.flatnonzero(names["result"]["confident"])[0]]
        assert f"`confident` is true from {first:.1f} s on" in text


def test_the_code_on_the_page_of_python_works() -> None:
    names = executed("python.md")
    # The joint of the first code block has a stiffness of 1000 N.m/rad.
    assert names["found"]["sigma"][-1] == pytest.approx(1000, rel=1e-3)
    assert names["now"]["sigma"] == names["found"]["sigma"][-1]
    assert names["found"]["confident"][-1] and "FilteredRegression" in names["settings"].values()
    np.testing.assert_allclose(names["both"]["sigma"][:, -1], 1000, rtol=1e-3)
    run = names["run"]
    assert run.estimators["one"]["sigma"][-1] == pytest.approx(run.plant["sigma"][-1], rel=0.05)


@pytest.mark.slow("replays logs five times, with --start-from and validate")
def test_the_commands_and_the_program_of_the_page_on_joints_work(shell: Shell) -> None:
    write_log(awas_log(1.0, 0.3, 3.0), Path("knee.csv"), REGRESSION)
    write_log(awas_log(1.3, 0.3, 3.0, seed=2), Path("second.csv"))
    (commands,) = blocks("joint.md", "sh")
    for line in commands.splitlines():
        program, name, *_ = line.split()
        assert program == "sigmahat" and name in cli.commands
        shell.run(line.partition("#")[0].removeprefix("sigmahat "))
    assert Path("both/joint.ssv").is_file()
    executed("joint.md")


def test_a_copy_without_enumerations_is_the_same_fmu(page: dict[str, Any], tmp_path: Path) -> None:
    """Tests the function on the page about importers."""
    source, copy = sigmahat.fmu("StiffnessEstimator"), tmp_path / "copy.fmu"
    executed("importers.md")["without_enumerations"](source, copy)
    found = {
        v.name: v for v in fmpy.read_model_description(str(copy), validate=True).modelVariables
    }
    assert "Enumeration" not in {v.type for v in found.values()}
    assert (found["method"].type, found["method"].start) == ("Integer", "1")
    log, start = page["log"][:500], {"method": 2, "modality": 2}
    results = [
        fmpy.simulate_fmu(str(fmu), input=log, start_values=start, output_interval=T, stop_time=0.4)
        for fmu in (source, copy)
    ]
    assert results[0].dtype.names == results[1].dtype.names
    for name in results[0].dtype.names:
        np.testing.assert_array_equal(results[0][name], results[1][name])


def test_fmpy_page_gives_the_results_of_other_loops(page: dict[str, Any]) -> None:
    """The page gives the results of a plant simulated by sigmahat and an estimator without FMU."""
    inputs = ("tau", "tau_c")
    torques = np.column_stack([page["torques"][name] for name in inputs])
    plant = run_plant("AwasPlant", inputs, T, torques, record=["sigma"], held=True)
    np.testing.assert_allclose(page["plant"]["sigma"], plant["sigma"], rtol=1e-9)
    measured = {name: page["log"][name] for name in page["measured"]}
    # An FMU provides the outputs of the tick at t_k only after the step from t_k.
    settings = {**page["settings"], "method": "FilteredRegression"}
    ticks = sigmahat.Estimator(settings).run(**measured)["sigma"][:-1]
    np.testing.assert_array_equal(page["estimate"]["sigma"][1:], ticks)
    assert ticks[-1] == pytest.approx(page["plant"]["sigma"][-1], rel=0.1)
    assert page["estimate"]["confident"][-1]


def test_fmpy_page_tunable_takes_effect_at_the_next_tick(page: dict[str, Any]) -> None:
    before = page["tuned"]["time"] < 1.5 + T / 2
    tuned, other = page["tuned"]["sigma_std"], page["estimate"]["sigma_std"]
    assert (tuned == other)[before].all()
    # The next row of samples changes the estimate, which continues from its value.
    first = np.flatnonzero(~before)[0]
    changed = np.flatnonzero(tuned != other)[0]
    assert first <= changed < first + 16
    assert tuned[changed] == pytest.approx(tuned[changed - 1], rel=1e-2)


def test_fmpy_passes_zeros_to_the_first_tick_of_the_system_and_is_else_exact(
    page: dict[str, Any],
) -> None:
    """The simulation on the page equals a plant in sigmahat and an estimator without an FMU."""
    system = page["system"]
    still, record = np.zeros((len(system), 1)), ("sigma", *page["measured"].values())
    plant = run_plant("AwasPlant", ["tau"], T, still, SIGNALS, record, t=system["time"])
    # FMPy records the outputs of the plant after a step with the start time of this step.
    np.testing.assert_array_equal(system["plant.sigma"][:-1], plant["sigma"][1:])
    measured = {to: np.append(0.0, plant[of][1:]) for to, of in page["measured"].items()}
    ticks = sigmahat.Estimator({}).run(**measured)["sigma"]
    np.testing.assert_array_equal(system["estimator.sigma"], ticks)
    assert ticks.any()


def test_the_torque_constants_follow_from_the_power_of_the_motor() -> None:
    """A sinusoidal motor at 1 rad/s: voltage and current of the conventions of each row."""
    page = (PAGES / "symptoms.md").read_text(encoding="utf-8")
    rows = re.findall(r"^\| (V .*?) \| (.*?) \| ([\d.]+)/Kv", page, re.M)
    assert len(rows) == 6
    per_rpm = 60 / (2 * np.pi)
    t = np.linspace(0, 2 * np.pi, 3000, endpoint=False)
    waves = np.sin(t[:, None] - 2 * np.pi / 3 * np.arange(3))  # of the phases
    for voltage, current, factor in rows:
        if "bus" in voltage:
            expected = per_rpm
        else:
            line = np.max(np.abs(waves[:, 0] - waves[:, 1]))
            measured = (
                1.0 if "neutral" in voltage else line / (np.sqrt(2) if "rms" in voltage else 1)
            )
            amperes = 1 / np.sqrt(2) if "rms" in current else 1.0
            expected = per_rpm * np.mean(np.sum(waves * waves, axis=1)) / measured / amperes
        assert float(factor) == pytest.approx(expected, rel=1e-3), (voltage, current)


def test_the_inertia_of_the_rotor_gives_the_torque_constant(shell: Shell) -> None:
    """GIVEN the tutorial with a torque constant of 1, as on the page on symptoms."""
    tutorial = REPOSITORY / "examples" / "tutorial"
    text = (tutorial / "knee.toml").read_text(encoding="utf-8")
    Path("knee.toml").write_text(text.replace("torque_constant = 0.1", "torque_constant = 1"))
    Path("knee.csv").write_bytes((tutorial / "knee.csv").read_bytes())
    B = shell.json("identify knee.csv")["B"]["value"]
    page = (PAGES / "symptoms.md").read_text(encoding="utf-8")
    assert f"finds B = {B:.4g}" in page and f"k_t = {5e-5 / B:.3g} N.m/A" in page
