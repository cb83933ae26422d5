"""All commands from a log of several joints to one report. The joints are simulated by scipy."""

import json
from pathlib import Path

import numpy as np
import pytest
import tomlkit

from command_line import Shell
from foreign_joint import GEAR, STIFFNESS, TORQUE_CONSTANT, joint
from recorded_logs import write_log
from sigmahat.recording.several_joints import of_joint

COUNTS = 16384


def each_joint_has_its_own_files(shell: Shell, page: str) -> None:
    """Reports have the names of the joints, and `export` takes the folder of both."""
    assert "leg.csv with leg.toml; sigmahat " in page
    assert '<a href="knee/report.html">knee: ' in page
    of_knee = Path("sigmahat-results/leg/knee/report.html").read_text(encoding="utf-8")
    assert "<title>Joint knee</title>" in of_knee
    shell.run("export sigmahat-results/leg --to mjcf")
    for name in ("hip", "knee"):
        assert Path("sigmahat-results/leg", name, "joint.xml").is_file()
    said = shell.refused("export sigmahat-results/leg --to ssv --out one.ssv")
    assert "is for one joint" in said
    assert "hip, knee" in said


@pytest.mark.slow("a user's way from init to validate, for two joints")
def test_from_the_log_to_one_report(shell: Shell) -> None:
    """GIVEN two joints of equal stiffness, and a knee drive that measures half of its current."""
    motion = joint(False)
    log = {"t": motion.t}
    for name, share in (("hip", 1.0), ("knee", 0.5)):
        log[f"{name}_motor_counts"] = np.round(motion.theta * GEAR * COUNTS / (2 * np.pi))
        log[f"{name}_link_rad"] = motion.q
        log[f"{name}_current_A"] = share * motion.tau / TORQUE_CONSTANT
    write_log(log, Path("leg.csv"))
    shell.run("init leg.csv")
    document = tomlkit.parse(Path("leg.toml").read_text())
    for own in document["joints"].values():
        theta, tau = own["ports"]["theta"], own["ports"]["tau"]
        theta["counts_per_turn"], theta["gear_ratio"] = COUNTS, GEAR
        tau["torque_constant"] = TORQUE_CONSTANT
    of_knee = document["joints"]["knee"]["ports"]["tau"]
    of_knee["torque_constant"] = 2 * TORQUE_CONSTANT
    of_knee["torque_constant"].comment("its drive shows half of the current")
    Path("leg.toml").write_text(tomlkit.dumps(document))

    shell.run("identify leg.csv")
    text = Path("leg.toml").read_text()
    assert "# its drive shows half of the current" in text
    assert "motor.B" not in tomlkit.dumps(tomlkit.parse(text)["parameters"])  # joints differ
    said = shell.run("check leg.csv")
    assert said.count("nothing in 7 s of the log contradicts") == 2

    found = shell.json("estimate leg.csv")["joints"]
    for name in ("hip", "knee"):
        low, high = found[name]["curve"][1]["interval"]
        assert low < STIFFNESS < high
        assert high - low < 0.12 * STIFFNESS
        assert found[name]["answer"].endswith("confident")
        sheet = json.loads(Path("sigmahat-results/leg", name, "joint.json").read_text())
        assert sheet["parameters"]["D_theta"]["interval_from"] == "identify"
    shell.run("report sigmahat-results/leg")
    page = Path("sigmahat-results/leg/report.html").read_text(encoding="utf-8")
    assert "hip: Stiffness against deformation" in page
    assert "knee: Stiffness against deformation" in page
    each_joint_has_its_own_files(shell, page)
    # THEN `validate` reports for both joints that their results come from the same log
    said = shell.run("validate leg.csv --with leg.toml", 1)
    assert said.count("learned before from leg.csv") == 2
    # THEN a joint selected by name gives the same estimate as with its own configuration.
    Path("knee.toml").write_text(tomlkit.dumps(of_joint(tomlkit.parse(text), "knee")))
    by_name, alone = (
        shell.json(f"estimate leg.csv --out out {option}")
        for option in ("--joint knee", "--config knee.toml")
    )
    assert by_name == alone


def test_a_change_of_a_joint_stands_in_its_line_and_in_the_table(shell: Shell) -> None:
    """GIVEN two joints with a step of the stiffness, in closed form."""
    t = 2e-3 * np.arange(10_000.0)
    phi = 0.02 * np.sin(2 * np.pi * 0.9 * t) + 0.01 * np.sin(2 * np.pi * 2.3 * t)
    noise = 0.05 * np.random.default_rng(1).standard_normal(len(t))
    log, sections = {"t": t, "theta": 0 * t, "q": phi}, []
    for name, change in (("a", 0.0), ("b", 0.5)):
        log[name] = 200.0 * np.where(t < 10.0, 1.0, 1.0 + change) * phi + noise
        sections.append(f'joints.{name}.ports.tau_e_sensor.column = "{name}"')
    write_log(log, Path("arm.csv"))
    common = (
        'time.column = "t"\nports.theta.value = 0\nports.q.column = "q"\n'
        'parameters = {method = "FilteredRegression", modality = "Sensor", samplePeriod = 0.002, '
        "range.phi = 0.04, prior.tau_e = 10, noise.tau_e = 0.05, rls.n = 1, rls.m = 1, "
        "encoder.q = 0}"
    )
    Path("arm.toml").write_text("\n".join([common, *sections]))
    said = shell.run("estimate arm.csv")
    changed = [line for line in said.splitlines() if "the stiffness changed by +50 %" in line]
    assert [line[0] for line in changed] == ["b"]
    rows = Path("sigmahat-results/arm/joints.csv").read_text().splitlines()
    assert rows[0].endswith("last change at [s],last change [%]")
    assert rows[1].endswith(",,")
    at, size = map(float, rows[2].split(",")[-2:])
    assert at == pytest.approx(10.0, abs=1.0)
    assert size == pytest.approx(50.0, abs=3.0)


@pytest.mark.parametrize(
    ("text", "options", "words"),
    [
        ("joints = {knee = {}}", "--joint knees", "unknown joint 'knees'; did you mean 'knee'"),
        ('ports.q.column = "q"', "--joint hip", "of one joint, expected no"),
        ('[joints."../x".ports.q]\ncolumn = "t"', "", "[joints] has the name '../x'"),
        ("joints = {a1 = 3}", "", "expected a table [joints.a1], got 3"),
        ('joints.a.port.q.column = "t"', "", "unknown section 'port'; did you mean 'ports'"),
        (
            'joints.a.ports.q.column = "t"\njoints.b.ports.q.column = "t"',
            "",
            "joint a: two.toml: identify needs [ports.theta]",
        ),
    ],
)
def test_a_configuration_that_is_wrong(text: str, options: str, words: str, shell: Shell) -> None:
    write_log({"t": 1e-3 * np.arange(1000.0), "x": np.zeros(1000)}, Path("leg.csv"))
    Path("two.toml").write_text(text)
    line = shell.refused(f"identify leg.csv --config two.toml {options}")
    assert words in line.replace("joint b", "joint a")
