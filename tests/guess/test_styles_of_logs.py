"""Tests of `sigmahat init` with logs in many formats: few edits lead to the right stiffness.

The tests simulate joints independently of the package. After `init`, a test adds values of the data
sheet and answers to questions to the configuration, and edits at most two other keys.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import tomlkit

from command_line import Shell
from foreign_joint import GEAR, TORQUE_CONSTANT, Array, Motion, joint
from recorded_logs import write_log
from sigmahat.recording.configuration import read_configuration
from sigmahat.recording.readers.formats import open_log
from sigmahat.recording.several_joints import set_item
from sigmahat.result.estimate import estimate

ACCURACY = 0.04
"""Relative tolerance of the stiffness; other tests check the accuracy of the estimator."""
TURN, DEG = 2 * np.pi, 180 / np.pi
Columns = dict[str, Any]


def noisy(values: Array, std: float, seed: int = 1) -> Array:
    return values + std * np.random.default_rng(seed).standard_normal(len(values))


def counts(angle: Array, per_turn: float, offset: int = 0) -> Any:
    return np.round(angle / TURN * per_turn).astype(np.int64) + offset


def current(m: Motion) -> Array:
    return noisy(m.tau / TORQUE_CONSTANT, 0.02)


def other_joint(m: Motion, values: Array) -> Array:
    """Values of another joint of the robot, which moves differently from the tested joint."""
    return 0.7 * np.interp(0.61 * m.t + 1.7, m.t, values)


def knee(m: Motion) -> Columns:
    """A log with a wrapping counter, currents in mA, jitter, missing values and a gap."""
    rng, keep = np.random.default_rng(1), (m.t < 3.0) | (m.t > 3.3)
    link = counts(m.q, 2**17, 70_000).astype(float)
    link[rng.choice(len(link), 40, replace=False)] = np.nan
    columns = {
        "time_ms": np.round(m.t * 1e3 + rng.uniform(-0.12, 0.12, len(m.t)), 3),
        "motor_enc": counts(m.theta * GEAR, 4096, 30_000) % 2**16,
        "knee_enc": link,
        "iq_mA": np.round(1e3 * current(m)).astype(np.int64),
    }
    return {name: values[keep] for name, values in columns.items()}


def plotjuggler(m: Motion) -> Columns:
    """A log of two joints with position and effort of each motor and link."""
    columns: Columns = {"__time": 1_700_000_000.0 + m.t}
    for name, position, effort in (
        ("knee_motor", m.theta, noisy(m.tau, 2e-3)),
        ("knee_link", m.q, 0 * m.q),
        ("hip_motor", other_joint(m, m.theta), other_joint(m, m.tau)),
        ("hip_link", other_joint(m, m.q), 0 * m.q),
    ):
        columns[f"/joint_states/{name}/position"] = position
        columns[f"/joint_states/{name}/effort"] = effort
    return columns


def german(m: Motion) -> Columns:
    return {
        "Zeit [s]": m.t,
        "Sollwinkel [Grad]": m.target * DEG * GEAR,
        "Motorwinkel [Grad]": counts(m.theta * GEAR, 8192) * 360 / 8192,
        "Abtriebswinkel [Grad]": -counts(m.q, 2**18, 4000) * 360 / 2**18,
        "Motorstrom [A]": current(m),
    }


def french(m: Motion) -> Columns:
    """A log whose French names contain no units; a lever arm in mm adjusts the stiffness."""
    return {
        "temps": m.t,
        "position_moteur": counts(m.theta, 5_000 * GEAR) * TURN / (5_000 * GEAR),
        "position_articulation": counts(m.q, 2**18) * TURN / 2**18,
        "bras_de_levier_mm": np.round(1e3 * m.lever, 3),
        "couple_moteur": noisy(m.tau, 2e-3),
        "consigne_position": m.target,
        "vitesse_moteur": m.velocity,
    }


def nothing_but_numbers(m: Motion) -> Columns:
    noise = (0.0, 5e-6, 2e-3, 1e-3, 5e-6)
    values = map(noisy, (m.t, m.q, m.tau, m.velocity, m.theta), noise)
    return {f"data{number}": each for number, each in enumerate(values)}


def drive_objects(m: Motion) -> Columns:
    """A log of CiA 402 objects: positions, and torque in thousandths of the rated 2 N.m."""
    return {
        "Timestamp [ns]": 133_000_000_000_000_000 + np.round(m.t * 1e9).astype(np.int64),
        "Axis 1.Position actual value": counts(m.theta * GEAR, 2**20, -123_456),
        "Axis 1.Target position": counts(m.target * GEAR, 2**20, -123_456),
        "Axis 1.Torque actual value": np.round(1000 * noisy(m.tau, 2e-3) / 2.0).astype(int),
        "Axis 1.Additional position actual value": counts(m.q, 2**19, 5000),
        "Axis 1.Statusword": np.full(len(m.t), 4663),
    }


def firmware(m: Motion) -> Columns:
    """A log in turns, although names and values would equally fit radians."""
    return {
        "tickUs": np.round(1e6 * m.t).astype(np.int64) + 4_711,
        "axis0.encoder.posEstimate": m.theta * GEAR / TURN,
        "axis0.controller.posSetpoint": m.target * GEAR / TURN,
        "axis0.motor.IqMeasured": current(m),
        "axis0.loadEncoder.posAbs": -m.q / TURN + 0.25,
    }


def simulink(m: Motion) -> Columns:
    """A log of Simulink, in which each signal has its own time vector."""
    signals = {"PhiMot": noisy(m.theta * GEAR, 2e-4), "PhiLast": noisy(m.q, 5e-6)}
    signals |= {"MMot": noisy(m.tau, 2e-3), "PhiMotSoll": m.target * GEAR}
    data = {f"logsout/{name}/Data": values for name, values in signals.items()}
    return data | {f"logsout/{name}/Time": m.t for name in signals}


@dataclass(frozen=True)
class Style:
    """A format of a log, and the configuration that `init` should find."""

    file: str  # the suffix selects the file format
    log: Callable[[Motion], Columns]
    ports: Mapping[str, tuple[str, str | None]]  # expected column and unit of each port
    sheet: Mapping[str, Any]  # keys to set to data sheet values, and to answers
    edits: Mapping[str, Any] = field(default_factory=dict)  # other keys to edit
    joint: str | None = None  # for --joint


CURRENT = {"ports.tau.torque_constant": TORQUE_CONSTANT}
RADIANS = {"ports.theta.unit": "rad"}  # one answer for both positions
STYLES = [
    Style(
        *("knee.csv", knee),
        {"theta": ("motor_enc", "counts"), "q": ("knee_enc", "counts"), "tau": ("iq_mA", "mA")},
        {**CURRENT, "ports.theta.counts_per_turn": 4096, "ports.theta.gear_ratio": GEAR}
        | {"ports.q.counts_per_turn": 2**17},
    ),
    Style(
        *("export.csv", plotjuggler),
        {"theta": ("/joint_states/knee_motor/position", "rad")}
        | {"q": ("/joint_states/knee_link/position", "rad")}
        | {"tau": ("/joint_states/knee_motor/effort", "N.m")},
        {"motor.gamma": GEAR, "ports.tau.gear_ratio": 1},
        joint="knee",
    ),
    Style(
        *("messung.csv", german),
        {"theta": ("Motorwinkel [Grad]", "deg"), "q": ("Abtriebswinkel [Grad]", "deg")}
        | {"tau": ("Motorstrom [A]", "A")},
        {**CURRENT, "ports.theta.gear_ratio": GEAR},
    ),
    Style(
        *("essai.csv", french),
        {"theta": ("position_moteur", "rad"), "q": ("position_articulation", "rad")}
        | {"theta_c": ("bras_de_levier_mm", "mm"), "tau": ("couple_moteur", "FILL IN")},
        {"motor.gamma": GEAR, "ports.tau.unit": "N.m"},
    ),
    Style(
        *("log.parquet", nothing_but_numbers),
        {"theta": ("data4", "FILL IN"), "q": ("data1", "as theta"), "tau": ("data2", "FILL IN")},
        {"motor.gamma": GEAR, "ports.tau.gear_ratio": 1, **RADIANS, "ports.tau.unit": "N.m"},
    ),
    Style(
        *("scope.csv", drive_objects),
        {"theta": ("Axis 1.Position actual value", "counts")}
        | {"q": ("Axis 1.Additional position actual value", "counts")}
        | {"tau": ("Axis 1.Torque actual value", None)},
        {"ports.theta.counts_per_turn": 2**20, "ports.theta.gear_ratio": GEAR}
        | {"ports.q.counts_per_turn": 2**19, "ports.tau.scale": 2.0 / 1000}
        | {"ports.tau.gear_ratio": 1},
    ),
    Style(
        *("capture.mat", lambda m: {n.rpartition(".")[2]: x for n, x in firmware(m).items()}),
        {"theta": ("posEstimate", "FILL IN"), "q": ("posAbs", "as theta")}
        | {"tau": ("IqMeasured", "A")},
        {**CURRENT, "ports.theta.gear_ratio": GEAR},
        {"ports.theta.unit": "turn"},
    ),
    Style(
        *("run.h5", simulink),
        {"theta": ("logsout.PhiMot.Data", "FILL IN"), "q": ("logsout.PhiLast.Data", "as theta")}
        | {"tau": ("logsout.MMot.Data", "FILL IN")},
        {"ports.theta.gear_ratio": GEAR, **RADIANS, "ports.tau.unit": "N.m"},
    ),
]


def edited(text: str, values: Mapping[str, Any]) -> str:
    """Sets keys of a configuration to new values. Keys in [parameters] have no prefix."""
    document = tomlkit.parse(text)
    for key, value in values.items():
        place = key.split(".") if key.startswith("ports.") else ("parameters", key)
        set_item(document, tuple(place), tomlkit.item(value))
    return tomlkit.dumps(document)


@pytest.mark.parametrize("style", STYLES, ids=lambda style: style.file)
def test_from_log_to_stiffness(style: Style, shell: Shell) -> None:
    motion = joint("theta_c" in style.ports)
    log = write_log(style.log(motion), Path(style.file))
    shell.run(f"init {log}" + (f" --joint {style.joint}" if style.joint else ""))
    path = log.with_suffix(".toml")
    found = tomlkit.parse(path.read_text()).unwrap()["ports"]
    assert {name: (each["column"], each.get("unit")) for name, each in found.items()} == style.ports
    path.write_text(edited(path.read_text(), {**style.sheet, **style.edits}))
    shell.run(f"identify {log}")
    result = estimate(open_log(log), read_configuration(path))
    assert result.sigma == pytest.approx(motion.stiffness[result.ticks - 1], rel=ACCURACY)
