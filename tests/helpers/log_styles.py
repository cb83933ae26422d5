"""One joint, logged in the ways of many people: names, units, counts, signs, formats.

Each style says which column is which, what the data sheet of its joint says (gear ratio, counts,
constants), and which keys have to be edited beyond that.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from foreign_joint import GEAR, TORQUE_CONSTANT, Array, Motion, joint
from recorded_logs import write_log

DEG = 180 / np.pi
Columns = dict[str, NDArray[np.generic]]


@dataclass(frozen=True)
class Style:
    """A way to log a joint."""

    name: str
    file: str
    """Its suffix is the format."""
    log: Callable[[Motion], Columns]
    ports: Mapping[str, tuple[str, str | None]]
    """Column and unit of each port."""
    sheet: Mapping[str, Any]
    """Keys that are filled in with values of the data sheet."""
    edits: Mapping[str, Any] = field(default_factory=dict)
    """Keys that are edited beyond that."""
    has_lever: bool = False
    joint: str | None = None
    """For --joint."""
    write: Callable[[Columns, Path], Path] = write_log

    @property
    def motion(self) -> Motion:
        return joint(self.has_lever)


def noisy(values: Array, std: float, seed: int) -> Array:
    return values + std * np.random.default_rng(seed).standard_normal(len(values))


def counts(angle: Array, per_turn: float, offset: int = 0, wrap: int | None = None) -> Any:
    n = np.round(angle / (2 * np.pi) * per_turn).astype(np.int64) + offset
    return n if wrap is None else n % wrap


def current(m: Motion, seed: int) -> Array:
    return noisy(m.tau / TORQUE_CONSTANT, 0.02, seed)


def other_joint(m: Motion, values: Array) -> Array:
    """Another joint of the robot, which moves differently."""
    return 0.7 * np.interp(0.61 * m.t + 1.7, m.t, values)


CURRENT = {"ports.tau.torque_constant": TORQUE_CONSTANT}
AFTER_GEAR = {"motor.gamma": GEAR}
STYLES: list[Style] = []


def _style(
    name: str,
    file: str,
    ports: Mapping[str, tuple[str, str | None]],
    sheet: Mapping[str, Any],
    **more: Any,
) -> Callable[[Callable[[Motion], Columns]], Callable[[Motion], Columns]]:
    """Adds a way to log a joint to STYLES; the arguments are those of Style."""

    def add(log: Callable[[Motion], Columns]) -> Callable[[Motion], Columns]:
        STYLES.append(Style(name, file, log, ports, sheet, **more))
        return log

    return add


# --- the series elastic knee of a prosthesis: counts, milliamperes, jitter, missing values, a gap


@_style(
    "knee in counts",
    "knee.csv",
    {"theta": ("motor_enc", "counts"), "q": ("knee_enc", "counts"), "tau": ("iq_mA", "mA")},
    {
        **CURRENT,
        "ports.theta.counts_per_turn": 4096,
        "ports.theta.gear_ratio": GEAR,
        "ports.q.counts_per_turn": 2**17,
    },
)
def _knee_counts(m: Motion) -> Columns:
    rng = np.random.default_rng(1)
    t = m.t * 1e3 + rng.uniform(-0.12, 0.12, len(m.t))
    link = counts(m.q, 2**17, 70_000).astype(float)
    link[rng.choice(len(link), 40, replace=False)] = np.nan
    keep = (m.t < 3.0) | (m.t > 3.3)
    columns = {
        "time_ms": np.round(t, 3),
        "motor_enc": counts(m.theta * GEAR, 4096, 30_000, 2**16),
        "knee_enc": link,
        "iq_mA": np.round(1e3 * current(m, 2)).astype(np.int64),
        "temp": np.round(30 + m.t / 3, 1),
    }
    return {name: values[keep] for name, values in columns.items()}


# --- PlotJuggler: two joints, position and effort of motor and link


@_style(
    "PlotJuggler",
    "export.csv",
    {
        "theta": ("/joint_states/knee_motor/position", "rad"),
        "q": ("/joint_states/knee_link/position", "rad"),
        "tau": ("/joint_states/knee_motor/effort", "N.m"),
    },
    AFTER_GEAR,
    joint="knee",
)
def _plotjuggler(m: Motion) -> Columns:
    out: Columns = {"__time": 1_700_000_000.0 + m.t}
    for name, values in {
        "knee_motor": (m.theta, m.velocity, m.tau),
        "knee_link": (m.q, np.gradient(m.q, m.t), np.zeros_like(m.q)),
        "hip_motor": tuple(other_joint(m, x) for x in (m.theta, m.velocity, m.tau)),
        "hip_link": tuple(other_joint(m, x) for x in (m.q, m.velocity, 0 * m.q)),
    }.items():
        position, velocity, effort = values
        out[f"/joint_states/{name}/position"] = position
        out[f"/joint_states/{name}/velocity"] = velocity
        out[f"/joint_states/{name}/effort"] = noisy(effort, 2e-3, 3) if effort.any() else effort
    return out


# --- a ROS 2 bag: JointState of two joints, current of their drives on topics of their own


def _write_bag(columns: Columns, path: Path) -> Path:
    from rosbags.rosbag2 import StoragePlugin, Writer
    from rosbags.typesys import Stores, get_typestore

    store = get_typestore(Stores.ROS2_HUMBLE)
    kinds, start = store.types, 1_700_000_000_000_000_000
    state, number = "sensor_msgs/msg/JointState", "std_msgs/msg/Float64"
    names = [name for name in columns if name not in ("t", "left", "right")]
    with Writer(path, version=9, storage_plugin=StoragePlugin.MCAP) as writer:
        states = writer.add_connection("/joint_states", state, typestore=store)
        drives = {
            side: writer.add_connection(f"/{side}_knee_drive/current", number, typestore=store)
            for side in ("left", "right")
        }
        for k, t in enumerate(np.asarray(columns["t"], dtype=float)):
            now = start + round(t * 1e9)
            message = kinds[state](
                kinds["std_msgs/msg/Header"](
                    kinds["builtin_interfaces/msg/Time"](now // 10**9, now % 10**9), ""
                ),
                names,
                np.array([columns[name][k] for name in names], dtype=float),
                np.array([]),
                np.array([]),
            )
            writer.write(states, now + 9000, store.serialize_cdr(message, state))
            for side, drive in drives.items():
                data = store.serialize_cdr(kinds[number](float(columns[side][k])), number)
                writer.write(drive, now, data)
    return path


@_style(
    "ROS 2 bag",
    "bag",
    {
        "theta": ("/joint_states.position[right_knee_motor]", "rad"),
        "q": ("/joint_states.position[right_knee_link]", "rad"),
        "tau": ("/right_knee_drive/current.data", "A"),
    },
    {**CURRENT, **AFTER_GEAR},
    joint="right_knee",
    write=_write_bag,
)
def _bag(m: Motion) -> Columns:
    n = len(m.t)
    columns: Columns = {
        "t": m.t,
        "left_knee_motor": noisy(other_joint(m, m.theta), 1e-5, 4),
        "left_knee_link": noisy(other_joint(m, m.q), 1e-5, 5),
        "right_knee_motor": m.theta,
        "right_knee_link": m.q,
        "left": other_joint(m, current(m, 6)),
        "right": current(m, 7),
    }
    return {name: values[:n] for name, values in columns.items()}


# --- German: semicolons, decimal commas, degrees before the gear


def _write_german(columns: Columns, path: Path) -> Path:
    rows = np.column_stack([np.asarray(each, dtype=float) for each in columns.values()])
    lines = [";".join(f"{value:.7g}".replace(".", ",") for value in row) for row in rows]
    path.write_text("\n".join([";".join(columns), *lines]), encoding="utf-8")
    return path


@_style(
    "German",
    "messung.csv",
    {
        "theta": ("Motorwinkel [Grad]", "deg"),
        "q": ("Abtriebswinkel [Grad]", "deg"),
        "tau": ("Motorstrom [A]", "A"),
    },
    {**CURRENT, "ports.theta.gear_ratio": GEAR},
    write=_write_german,
)
def _german(m: Motion) -> Columns:
    return {
        "Zeit [s]": m.t,
        "Sollwinkel [Grad]": m.target * DEG * GEAR,
        "Motorwinkel [Grad]": counts(m.theta * GEAR, 8192) * 360 / 8192,
        "Abtriebswinkel [Grad]": -counts(m.q, 2**18, 4000) * 360 / 2**18,
        "Motorstrom [A]": current(m, 9),
        "Motortemperatur [°C]": 30 + m.t / 3,
    }


# --- French: no units in the names, a lever in mm sets the stiffness


@_style(
    "French",
    "essai.csv",
    {
        "theta": ("position_moteur", "rad"),
        "q": ("position_articulation", "rad"),
        "theta_c": ("bras_de_levier_mm", "mm"),
        "tau": ("couple_moteur", "N.m"),
    },
    AFTER_GEAR,
    has_lever=True,
)
def _french(m: Motion) -> Columns:
    return {
        "temps": m.t,
        "position_moteur": counts(m.theta, 40_000 * GEAR / 8) * 2 * np.pi / (5_000 * GEAR),
        "position_articulation": counts(m.q, 2**18) * 2 * np.pi / 2**18,
        "bras_de_levier_mm": np.round(1e3 * m.lever, 3),
        "couple_moteur": noisy(m.tau, 2e-3, 10),
        "consigne_position": m.target,
        "vitesse_moteur": m.velocity,
    }


# --- MATLAB: letters of the equations, the motor on its own axis


@_style(
    "letters",
    "joint.mat",
    {"theta": ("th", "rad"), "q": ("q", "rad"), "tau": ("i", "A")},
    {**CURRENT, "ports.theta.gear_ratio": GEAR},
)
def _letters(m: Motion) -> Columns:
    return {
        "t": m.t,
        "th": noisy(m.theta * GEAR, 2e-4, 11),
        "q": noisy(m.q, 5e-6, 12),
        "i": -current(m, 13),
        "w": m.velocity * GEAR,
    }


# --- nothing but numbers: the values have to say it all


@_style(
    "no names",
    "log.parquet",
    {"theta": ("data4", "rad"), "q": ("data1", "rad"), "tau": ("data2", "N.m")},
    AFTER_GEAR,
)
def _silent(m: Motion) -> Columns:
    return {
        "data0": m.t,
        "data1": noisy(m.q, 5e-6, 17),
        "data2": noisy(m.tau, 2e-3, 18),
        "data3": noisy(m.velocity, 1e-3, 19),
        "data4": noisy(m.theta, 5e-6, 20),
        "data5": np.round(30 + m.t / 3, 1),
    }


# --- CiA 402 objects in a PLC: torque and position as integers, torque in thousandths of the rated


@_style(
    "CiA 402",
    "scope.csv",
    {
        "theta": ("Axis 1.Position actual value", "counts"),
        "q": ("Axis 1.Additional position actual value", "counts"),
        "tau": ("Axis 1.Torque actual value", None),
    },
    {
        "ports.theta.counts_per_turn": 2**20,
        "ports.theta.gear_ratio": GEAR,
        "ports.q.counts_per_turn": 2**19,
        "ports.tau.scale": 2.0 / 1000,
    },
)
def _drive_objects(m: Motion) -> Columns:
    return {
        "Timestamp [ns]": 133_000_000_000_000_000 + np.round(m.t * 1e9).astype(np.int64),
        "Axis 1.Position actual value": counts(m.theta * GEAR, 2**20, -123_456),
        "Axis 1.Target position": counts(m.target * GEAR, 2**20, -123_456),
        "Axis 1.Velocity actual value": np.round(m.velocity * GEAR * 1000).astype(np.int64),
        "Axis 1.Torque actual value": np.round(1000 * noisy(m.tau, 2e-3, 21) / 2.0).astype(int),
        "Axis 1.Additional position actual value": counts(m.q, 2**19, 5000),
        "Axis 1.Statusword": np.full(len(m.t), 4663),
    }


# --- names of variables in the firmware of a drive: turns, camel case. Neither names nor values say
#     that these are turns: as radians they were as likely.


@_style(
    "firmware",
    "capture.csv",
    {
        "theta": ("axis0.encoder.posEstimate", "rad"),
        "q": ("axis0.loadEncoder.posAbs", "rad"),
        "tau": ("axis0.motor.IqMeasured", "A"),
    },
    {**CURRENT, "ports.theta.gear_ratio": GEAR},
    edits={"ports.theta.unit": "turn", "ports.q.unit": "turn"},
)
def _firmware(m: Motion) -> Columns:
    return {
        "tickUs": np.round(1e6 * m.t).astype(np.int64) + 4_711,
        "axis0.encoder.posEstimate": m.theta * GEAR / (2 * np.pi),
        "axis0.encoder.velEstimate": m.velocity * GEAR / (2 * np.pi),
        "axis0.controller.posSetpoint": m.target * GEAR / (2 * np.pi),
        "axis0.motor.IqMeasured": current(m, 23),
        "axis0.motor.IdMeasured": noisy(0 * m.t, 0.02, 24),
        "axis0.loadEncoder.posAbs": -m.q / (2 * np.pi) + 0.25,
        "vbusVoltage": noisy(24 + 0 * m.t, 0.05, 25),
    }


# --- signals that Simulink logged, each with its times, in HDF5


@_style(
    "Simulink",
    "run.h5",
    {
        "theta": ("logsout.PhiMot.Data", "rad"),
        "q": ("logsout.PhiLast.Data", "rad"),
        "tau": ("logsout.MMot.Data", "N.m"),
    },
    {"ports.theta.gear_ratio": GEAR},
)
def _simulink(m: Motion) -> Columns:
    out: Columns = {}
    for name, values in {
        "PhiMot": noisy(m.theta * GEAR, 2e-4, 27),
        "PhiLast": noisy(m.q, 5e-6, 28),
        "MMot": noisy(m.tau, 2e-3, 29),
        "PhiMotSoll": m.target * GEAR,
    }.items():
        out[f"logsout/{name}/Data"] = values
        out[f"logsout/{name}/Time"] = m.t
    return out
