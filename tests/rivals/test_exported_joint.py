"""A joint from a log in a simulator: what `export` writes, in MuJoCo and in Drake's parsers."""

import itertools
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import tomlkit

from recorded_logs import write_log
from rivals.draw import SAMPLE_PERIOD
from rivals.joint import DrawnJoint, DrawnSpring, DriveCommand, Friction, Instruments, Link, Motor
from rivals.records import Array
from rivals.simulation import run
from sigmahat.cli import main

GEAR = 100.0
COUNTS = (4096, 262144)  # a turn of the motor on its axis, of the link
NOISE = 0.003  # of the torque [N.m]


def drawn(seed: int) -> DrawnJoint:
    """A joint with Coulomb and viscous friction, whose spring is linear or hardens."""
    rng = np.random.default_rng(seed)
    k_1 = float(np.exp(rng.uniform(np.log(100), np.log(3000))))
    largest = 40 / k_1  # [rad] about
    k_3 = k_1 * rng.uniform(0, 1) / largest**2 if seed % 2 else 0.0
    damping = 1e-3 * k_1 * rng.uniform(0.2, 2)
    inertia, viscous, coulomb = (rng.uniform(*each) for each in ((0.3, 2), (1, 10), (0.2, 2)))
    dry, length = Friction(coulomb / GEAR), rng.uniform(0.4, 0.6)
    counts = round(GEAR * COUNTS[0])
    return DrawnJoint(
        motors=(Motor(GEAR, inertia / GEAR**2, viscous / GEAR**2, np.inf, dry, 0.02),),
        springs=(DrawnSpring(k_1, k_3, damping),),
        links=(Link(4.0, length, 0.75 * length, 0.1),),
        gravity=9.81,
        drives=(),
        instruments=(Instruments(True, 0.0, 1e-6, 1.0, NOISE, counts, COUNTS[1]),),
        sheet={},
    )


def motion(
    joint: DrawnJoint, frequencies: tuple[float, ...], seconds: float, seed: int
) -> dict[str, Array]:
    """The motion of the joint under a position controller."""
    t = SAMPLE_PERIOD * np.arange(round(seconds / SAMPLE_PERIOD), dtype=np.float64)
    waves = zip((0.6, 0.25, 0.1), frequencies, strict=True)
    target = np.sum([a * np.sin(2 * np.pi * f * t) for a, f in waves], axis=0)
    drive = DriveCommand(np.zeros_like(t), target, 300 / GEAR, 20 / GEAR, np.inf)
    x = run(replace(joint, drives=(drive,)))
    return {
        "time_s": t,
        "motor_counts": np.round(x["theta"] * GEAR * COUNTS[0] / (2 * np.pi)),
        "link_counts": np.round((x["theta"] + x["phi"]) * COUNTS[1] / (2 * np.pi)),
        "torque_Nm": x["torque"] + np.random.default_rng(seed).normal(0, NOISE, len(t)),
        "tau_e": x["tau_e"] + x["damper"],
        "phi": x["phi"],
        "phi_dot": np.gradient(x["phi"], SAMPLE_PERIOD),
    }


def estimated(joint: DrawnJoint, folder: Path) -> Path:
    """The folder of results of a log of 20 s, by the documented path."""
    log = motion(joint, (0.35, 1.1, 2.3), 20.0, 1)
    write_log({n: log[n] for n in list(log)[:4]}, folder / "knee.csv")
    configuration = folder / "knee.toml"
    csv = str(folder / "knee.csv")
    assert main(["init", csv, "--config", str(configuration), "--quiet"]) == 0
    document = tomlkit.parse(configuration.read_text())
    ports: Any = document["ports"]
    ports["theta"]["gear_ratio"], ports["theta"]["counts_per_turn"] = GEAR, COUNTS[0]
    ports["q"]["counts_per_turn"] = COUNTS[1]
    configuration.write_text(tomlkit.dumps(document))
    of_log = [csv, "--config", str(configuration), "--quiet"]
    assert main(["identify", *of_log]) == 0
    assert main(["estimate", *of_log, "--out", str(folder / "knee")]) == 0
    return folder / "knee"


def within_band(model_file: Path, log: dict[str, Array]) -> tuple[float, float]:
    """Share of a run in which the torque is in the band from both ends of the ranges; and half of
    this band over the RMS of the torque.
    """
    import mujoco

    torques = []
    for stiffer, damped in itertools.product((0, 1), (0, 1)):
        model = mujoco.MjModel.from_xml_path(str(model_file))
        factor, damping = (
            model.numeric_data[model.numeric(f"joint_flexibility.{name}").adr[0] + end]
            for name, end in (("stiffness.factor", stiffer), ("damping", damped))
        )
        model.jnt_stiffness[1] *= factor
        model.jnt_stiffnesspoly[1] *= factor
        model.dof_damping[1] = damping
        data, torque = mujoco.MjData(model), np.empty_like(log["phi"])
        for i, (phi, phi_dot) in enumerate(zip(log["phi"], log["phi_dot"], strict=True)):
            data.qpos[1], data.qvel[1] = phi, phi_dot
            mujoco.mj_forward(model, data)
            torque[i] = -data.qfrc_spring[1] - data.qfrc_damper[1]
        torques.append(torque)
    low, high = np.min(torques, axis=0), np.max(torques, axis=0)
    inside = (log["tau_e"] >= low) & (log["tau_e"] <= high)
    size = float(np.sqrt(np.mean(log["tau_e"] ** 2)))
    return float(np.mean(inside)), float(np.sqrt(np.mean((high - low) ** 2))) / 2 / size


@pytest.mark.slow("joints are simulated, identified and estimated")
@pytest.mark.parametrize("seed", [0, 1])
def test_the_torque_of_another_run_is_within_the_ranges(seed: int, tmp_path: Path) -> None:
    pytest.importorskip("mujoco", reason="to install MuJoCo: cmake --workflow --preset rivals")
    joint = drawn(seed)
    results = estimated(joint, tmp_path)
    assert main(["export", str(results), "--to", "mjcf", "--quiet"]) == 0
    share, half = within_band(results / "joint.xml", motion(joint, (0.27, 0.9, 2.9), 8.0, 2))
    assert share > 0.9
    assert half < 0.25


@pytest.mark.slow("a joint is simulated, identified and estimated")
def test_drake_and_mujoco_read_the_other_formats(tmp_path: Path) -> None:
    mujoco = pytest.importorskip("mujoco", reason="to install it: cmake --workflow --preset rivals")
    plants = pytest.importorskip("pydrake.multibody.plant", reason="preset rivals installs Drake")
    parsing, tree = (
        pytest.importorskip(f"pydrake.multibody.{name}") for name in ("parsing", "tree")
    )
    joint = drawn(2)
    (motor,), (flexible,) = joint.motors, joint.springs
    viscous, coulomb = motor.D * GEAR**2, motor.friction.K_c * GEAR
    results = estimated(joint, tmp_path)
    for kind in ("sdf", "drake", "urdf"):
        assert main(["export", str(results), "--to", kind, "--quiet"]) == 0
    for file in ("joint.sdf", "joint.drake.sdf"):
        plant = plants.MultibodyPlant(1e-3)
        parsing.Parser(plant).AddModels(str(results / file))
        plant.Finalize()
        spring = plant.get_force_element(tree.ForceElementIndex(1))
        assert spring.default_stiffness() == pytest.approx(flexible.stiffness, rel=0.05)
        damping = plant.GetJointByName("joint_motor").default_damping()
        assert damping == pytest.approx(viscous, rel=0.1)
    (drive,) = map(plant.get_joint_actuator, plant.GetJointActuatorIndices())
    reflected = drive.default_rotor_inertia() * drive.default_gear_ratio() ** 2
    assert reflected == pytest.approx(motor.inertia, rel=0.05)
    model = mujoco.MjModel.from_xml_path(str(results / "joint.urdf"))
    assert model.dof_damping[0] == pytest.approx(viscous, rel=0.1)
    assert model.dof_frictionloss[0] == pytest.approx(coulomb, rel=0.1)
