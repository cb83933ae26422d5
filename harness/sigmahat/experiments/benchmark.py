"""A benchmark of joint stiffness: logs with their truth in a folder, and the score of any method.

    logs.csv          a line for each log: name, kind, seed, time from which it is judged
    NAME.csv          what a robot records: t [s], theta [rad], q [rad], tau [N.m], theta_c [rad]
    NAME.toml         what its owner knows: the configuration of the log for `sigmahat estimate`
    NAME.truth.csv    t [s], stiffness [N.m/rad]

theta is the position of the motor behind the gear, q that of the link, tau the torque on the axis
of the motor. theta_c is the position of a motor that adjusts the stiffness; most joints have none.
A method gets the second and third of these files. It answers with a table of its estimates, which
has a row for each row of the log, as NAME.csv or NAME.parquet:

    t            [s], as in the log
    stiffness    [N.m/rad]
    std          standard deviation [N.m/rad]; or low and high, ends of the 95 % interval [N.m/rad]
    confident    1 where the method trusts its estimate, else 0

A method without intervals leaves out std, a method without confidence leaves out confident.
"""

import json
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sigmahat.experiments.pool import Progress, run_all
from sigmahat.experiments.scores import SETTLED, Score, score
from sigmahat.files import toml_file
from sigmahat.files.output import output_folder, write_whole
from sigmahat.files.tables import (
    aligned,
    name_and_unit,
    numeric_columns,
    read_csv,
    title,
    write_csv,
)
from sigmahat.fmi.model import Value

Array = NDArray[np.float64]

LIST = "logs.csv"
TRUTH = "truth.csv"  # end of the names of files with a true stiffness
COLUMNS = ("error", "width", "coverage", "interval_score", "confident", "wrong")
"""Numbers of a score in the table of a benchmark."""
_UNITS = {"theta": "rad", "q": "rad", "tau": "N.m", "theta_c": "rad"}
_HEAD = ("log", "kind", "seed", "judged from [s]")


@dataclass(frozen=True)
class LogWithTruth:
    """The log of a joint whose stiffness is known. All arrays have one entry per sample."""

    name: str  # of its files
    kind: str  # joint, and what is special about it
    seed: int
    sample_period: float  # [s]
    measured: Mapping[str, Array]
    """theta [rad], q [rad], tau [N.m] and theta_c [rad], as at the top of this file."""
    stiffness: Array  # the truth [N.m/rad]; 0 where the spring is in a dead zone
    parameters: Mapping[str, Value]
    """Start values of StiffnessEstimator: what the owner of the joint knows, with its errors."""
    judged_from: float = SETTLED  # time from which an estimate is judged [s]

    @property
    def t(self) -> Array:
        """Times of the samples [s]."""
        return self.sample_period * np.arange(len(self.stiffness), dtype=np.float64)

    def score(
        self,
        stiffness: Array,
        confident: NDArray[np.bool_],
        std: Array | None = None,
        interval: tuple[Array, Array] | None = None,
    ) -> Score:
        """The score of an estimate for every sample, from judged_from on.

        The arguments are those of sigmahat.experiments.scores.score(), of shape (samples,). Raises
        ValueError if nothing can be judged, or the estimate is not finite where it is judged.
        """
        judged = self.t >= self.judged_from
        if not (self.stiffness[judged] > 0).any():
            raise ValueError(f"the log has no stiffness after {self.judged_from:g} s")
        return score(
            self.stiffness[judged],
            stiffness[judged],
            confident[judged],
            None if std is None else std[judged],
            None if interval is None else (interval[0][judged], interval[1][judged]),
        )


def write(
    makers: Sequence[Callable[[], LogWithTruth]],
    folder: Path,
    processes: int | None = None,
    progress: Progress = lambda done: None,
) -> None:
    """Writes a benchmark into a folder, all of its files or none.

    makers               functions or partial objects that make one log each, in other processes
    processes, progress  as for sigmahat.experiments.pool.run_all()

    Raises what the makers raise, and OSError if a file cannot be written.
    """
    with output_folder(folder) as unfinished:
        jobs = [partial(_make_and_write, make, unfinished) for make in makers]
        write_csv(unfinished / LIST, _HEAD, run_all(jobs, processes, progress))


def _make_and_write(make: Callable[[], LogWithTruth], folder: Path) -> Sequence[Any]:
    """Writes the files of one log, and returns its line in the list of logs."""
    log = make()
    measured = {name: x for name, x in log.measured.items() if name != "theta_c" or x.any()}
    columns = {"t": log.t, **measured}
    head = [title(name, _UNITS.get(name, "s")) for name in columns]
    write_csv(folder / f"{log.name}.csv", head, _rows(columns))
    truth = {"t [s]": log.t, "stiffness [N.m/rad]": log.stiffness}
    write_csv(folder / f"{log.name}.{TRUTH}", list(truth), _rows(truth))
    text = _configuration(measured, log.parameters)
    write_whole(text, folder / f"{log.name}.toml")
    return log.name, log.kind, log.seed, log.judged_from


def _rows(columns: Mapping[str, Array]) -> Iterator[tuple[float, ...]]:
    return zip(*(values.tolist() for values in columns.values()), strict=True)


def _configuration(measured: Mapping[str, Array], parameters: Mapping[str, Value]) -> str:
    """Formats the configuration of a log as TOML."""
    lines = ["[time]", f'column = "{title("t", "s")}"']
    for name in measured:
        unit = _UNITS[name]
        lines += ["", f"[ports.{name}]", f'column = "{title(name, unit)}"', f'unit = "{unit}"']
    lines += ["", "[parameters]"]
    lines += [f"{name} = {json.dumps(value)}" for name, value in parameters.items()]
    return "\n".join(lines) + "\n"


def read(folder: Path) -> Iterator[LogWithTruth]:
    """Reads the logs of a benchmark, in the order of the list.

    Raises OSError for a missing file, ValueError for a file that is not that of a benchmark.
    """
    for line in read_csv(folder / LIST).to_pylist():
        name = str(line["log"])
        columns = numeric_columns(read_csv(folder / f"{name}.csv"))
        t = columns.pop("t")
        configuration = toml_file.read(folder / f"{name}.toml").unwrap()
        parameters = _flat(configuration["parameters"])
        yield LogWithTruth(
            name=name,
            kind=str(line["kind"]),
            seed=int(line["seed"]),
            sample_period=float(parameters["samplePeriod"]),
            measured={"theta_c": np.zeros(len(t)), **columns},
            stiffness=numeric_columns(read_csv(folder / f"{name}.{TRUTH}"))["stiffness"],
            parameters=parameters,
            judged_from=float(line["judged from [s]"]),
        )


def _flat(table: Mapping[str, Any], prefix: str = "") -> dict[str, Value]:
    """Joins the keys of nested tables by dots."""
    values: dict[str, Value] = {}
    for key, value in table.items():
        if isinstance(value, Mapping):
            values |= _flat(value, f"{prefix}{key}.")
        else:
            values[f"{prefix}{key}"] = value
    return values


def score_tables(benchmark: Path, estimates: Path) -> dict[str, Score]:
    """Scores a folder with the tables of a method: the score of each log that has a table.

    The tables are described at the top of this file; titles may have a unit, "stiffness [N.m/rad]".

    Raises OSError for a missing file, ValueError for a table that does not fit its log, or if no
    log has a table.
    """
    scores: dict[str, Score] = {}
    for log in read(benchmark):
        files = [estimates / f"{log.name}.{kind}" for kind in ("csv", "parquet")]
        for path in filter(Path.is_file, files):
            scores[log.name] = score_table(log, path)
    if not scores:
        raise ValueError(f"{estimates}: expected a table named as a log of {benchmark}, got none")
    return scores


def score_table(log: LogWithTruth, path: Path) -> Score:
    """Scores the table of a method for one log; raises ValueError as score_tables() does."""
    columns = _estimates(path)
    t = columns.get("t")
    if t is None or "stiffness" not in columns:
        raise ValueError(f"{path}: expected columns t and stiffness, got {', '.join(columns)}")
    if len(t) != len(log.t) or np.abs(t - log.t).max() > log.sample_period / 2:
        raise ValueError(f"{path}: expected the {len(log.t)} times t of the log, got {len(t)} rows")
    confident = columns.get("confident", np.zeros(len(t))) > 0
    interval = (columns["low"], columns["high"]) if {"low", "high"} <= columns.keys() else None
    try:
        return log.score(columns["stiffness"], confident, columns.get("std"), interval)
    except ValueError as error:
        raise ValueError(f"{path}: {error}") from error


def _estimates(path: Path) -> dict[str, Array]:
    """Reads the columns of a table; a column without any value is nan."""
    from pyarrow import ArrowInvalid, parquet, types

    try:
        table = read_csv(path) if path.suffix == ".csv" else parquet.read_table(path)
    except ArrowInvalid as error:
        raise ValueError(f"{path}: not readable as Parquet") from error
    empty = [name_and_unit(field.name)[0] for field in table.schema if types.is_null(field.type)]
    return {**{name: np.full(len(table), np.nan) for name in empty}, **numeric_columns(table)}


def table(scores: Mapping[str, Score]) -> str:
    """Formats scores by log as text, with the score over the instants of all logs at the end."""
    rows = [["", *(title(name, "%") for name in COLUMNS)]]
    for name, of_log in {**scores, "all logs": sum(scores.values(), Score())}.items():
        rows.append([name, *(f"{of_log.figures[column]:.3g}" for column in COLUMNS)])
    return "\n".join(aligned(rows))
