"""Logs of the AwAS plant for tests, and the files they are written to."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from types import MappingProxyType

import h5py
import numpy as np
import pyarrow as pa
import pyarrow.csv
import pyarrow.parquet
import scipy.io
import tomlkit
from numpy.typing import NDArray

from command_line import working_in
from plant_runs import run_awas, sinusoids, times
from regression_joint import Joint
from sigmahat.cli import main
from sigmahat.motor.quantities import Identified
from sigmahat.motor.write import update
from sigmahat.recording.configuration import Configuration, checked_configuration, read_document

Array = NDArray[np.float64]
Columns = dict[str, Array]
T = 1e-3
LEAD = 0.0025 / (2 * np.pi)
RETRACTED = {"initial.theta_c": 0.030 / LEAD}  # r(0) = 70 mm
TRUE = {"B": 2.3e-5, "D_theta": 1e-3, "tau_coulomb": 0.02}

COLUMNS = {
    "theta": "theta_measured",
    "q": "q_measured",
    "theta_c": "theta_c_measured",
    "tau": "tau_measured",
    "tau_e_sensor": "tau_e_measured",
}

CONFIGURATION = """\
# a comment of mine
[time]
column = "t"
[ports.theta]
column = "theta"
[ports.q]
column = "q"
[ports.theta_c]
column = "theta_c"
[ports.tau]
column = "tau"   # on the axis of the motor
[parameters]
samplePeriod = 0.001
motor.B = 1.84e-5   # 20 % less than it is
motor.D_theta = 1.2e-3
motor.gamma = 50
"""
REGRESSION = CONFIGURATION + 'method = "FilteredRegression"\nrls.n = 3\n'


def configured(*parameters: str, ports: Sequence[str] = ("theta", "q", "tau")) -> str:
    """A configuration for FilteredRegression, in which each port has the column of its name."""
    columns = [f'ports.{name}.column = "{name}"' for name in ports]
    lines = ['time.column = "t"', *columns, "[parameters]", 'method = "FilteredRegression"']
    return "\n".join([*lines, *parameters, ""])


def in_memory(configuration: str) -> Configuration:
    """A configuration that is in no file."""
    return checked_configuration(tomlkit.parse(configuration), Path("log.toml"))


def write(found: Identified, path: Path) -> list[str]:
    """Writes the identified values into a configuration, and returns the keys that were set."""
    document = read_document(path)
    written = update(document, found)
    path.write_text(tomlkit.dumps(document))
    return written


def awas_log(
    f: float,
    amplitude: float,
    duration: float = 15.0,
    seed: int = 1,
    plant: Mapping[str, float] = MappingProxyType({}),
) -> Columns:
    """AwAS with friction and noise, tau = amplitude sin(2 pi f t), and other start values of the
    plant: ports, t, true stiffness."""
    t = times(T, duration)
    start = {**RETRACTED, "motor.tau_coulomb": TRUE["tau_coulomb"], "noise.seed": seed, **plant}
    torques = sinusoids(t, (amplitude, f), (8.0, 0.1), (0.0, 0.0))
    run = run_awas(T, torques, start, (*COLUMNS.values(), "sigma"))
    return {"t": t, **{port: run[name] for port, name in COLUMNS.items()}, "true": run["sigma"]}


def recorded(joint: Joint) -> Columns:
    """The log of a joint in closed form."""
    ports = zip(("theta", "q", "theta_c", "tau"), joint.measurements().T, strict=False)
    return {"t": joint.t, **dict(ports)}


def plain_log(rows: int = 2000) -> Columns:
    """A made-up motion without noise: ports and t, 1 ms apart."""
    t = T * np.arange(rows, dtype=np.float64)
    motion = np.sin(5 * t)
    return {"t": t, "theta": motion, "q": 1.01 * motion, "theta_c": 75 + t, "tau": 0.1 * motion}


def write_log(
    columns: Mapping[str, NDArray[np.generic]], path: Path, configuration: str = ""
) -> Path:
    """Writes a log in the format of the suffix, and next to it the configuration, if any."""
    if configuration:
        path.with_suffix(".toml").write_text(configuration)
    if path.suffix == ".csv":
        pa.csv.write_csv(pa.table(dict(columns)), path)
    elif path.suffix == ".parquet":
        pa.parquet.write_table(pa.table(dict(columns)), path)
    elif path.suffix == ".mat":
        scipy.io.savemat(path, dict(columns))
    else:
        with h5py.File(path, "w") as file:
            for name, values in columns.items():
                file[name] = values
    return path


def estimated(folder: Path, columns: Columns, configuration: str, options: str = "") -> Path:
    """A folder with knee.parquet, its configuration, and the output of `sigmahat estimate`."""
    with working_in(folder):
        write_log(columns, Path("knee.parquet"), configuration)
        assert main(["estimate", "knee.parquet", "--quiet", *options.split()]) == 0
    return folder


STORED = 2**-17
"""Largest relative rounding error of the estimates in Parquet [1]."""


def read_estimate(folder: Path) -> pa.Table:
    """The table that `sigmahat estimate` wrote."""
    if (folder / "estimate.csv").exists():
        return pa.csv.read_csv(folder / "estimate.csv")
    return pa.parquet.read_table(folder / "estimate.parquet")
