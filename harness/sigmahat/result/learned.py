"""Writes and reads `state.json`: the estimator state after a log, to continue with the next log.

The JSON file contains the identity of the FMU, the logs, and the state from fmi2SerializeFMUstate
in base64. The FMU state contains the parameters of the estimator.
"""

import base64
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from sigmahat.files.output import write_json
from sigmahat.fmi.installed import version
from sigmahat.fmi.instance import FmuError, Slave, Value
from sigmahat.fmi.sample_loop import present_values
from sigmahat.recording.log import LogError
from sigmahat.recording.replay import gap
from sigmahat.result.stored import NO_OTHER_KEYS, FmuId, Format, LearnedLog, Text

_AGAIN = "run `sigmahat estimate` on the first log again"
_OTHER = f"both must have the same parameters: change the configuration, or {_AGAIN}"


@dataclass(frozen=True)
class Learned:
    """The contents of `state.json` that are needed to continue an estimation."""

    path: Path  # path of the file
    fmu: FmuId  # identity of the FMU of the state
    logs: Sequence[LearnedLog]  # logs that the FMU has processed, in this order
    state: bytes  # state of the FMU


@dataclass(frozen=True)
class _File:
    """The schema of the JSON file `state.json`."""

    __pydantic_config__ = NO_OTHER_KEYS

    format: Text
    version: int
    sigmahat: Text
    fmu: FmuId
    method: Text
    logs: list[LearnedLog]
    parameters: dict[str, Any]
    state: Text


LEARNED = Format("state.json", "sigmahat learned state", 1, _File)  # format of the file


def write_learned(
    slave: Slave, every: Mapping[str, Value], logs: Sequence[LearnedLog], path: Path
) -> None:
    """Writes the state of a slave after the logs; `every` contains the parameters of the slave."""
    contents = _File(
        format=LEARNED.name,
        version=LEARNED.version,
        sigmahat=version(),
        fmu=FmuId.of(slave.fmu),
        method=str(every["method"]),
        logs=list(logs),
        parameters={n: v for n, v in every.items() if v or not n.startswith("rls.eta_0")},
        state=base64.b64encode(slave.saved()).decode(),
    )
    write_json(asdict(contents), path)


def read_learned(path: Path) -> Learned:
    """Reads `state.json`, given as the file or as a folder of results.

    Raises LogError, which names the expected contents, if the file is missing or damaged.
    """
    try:
        file = LEARNED.read(path)
    except ValueError as error:
        raise LogError(str(error)) from error
    path = LEARNED.path(path)
    try:
        state = base64.b64decode(file.state, validate=True)
    except ValueError as error:
        raise LogError(f"{path}: damaged: its state is not base64; {_AGAIN}") from error
    return Learned(path, file.fmu, file.logs, state)


def go_on(slave: Slave, learned: Learned, every: Mapping[str, Value], configuration: Path) -> float:
    """Restores a saved state in an initialised slave. Filters start again with the next sample.

    every          parameters of the slave
    configuration  the file that contains these parameters, for messages

    Returns the present time of the slave [s]. Raises LogError if the state is damaged, or is the
    state of another FMU or with other parameters.
    """
    theirs, ours = learned.fmu, FmuId.of(slave.fmu)
    if theirs != ours:
        told, wanted = (f"{f.name}.fmu {f.version} ({f.guid})" for f in (theirs, ours))
        raise LogError(f"{learned.path}: state of {told}, expected {wanted}; {_AGAIN}")
    try:
        t_0 = slave.restore(learned.state)
    except FmuError as error:
        raise LogError(f"{learned.path}: damaged: {error}; {_AGAIN}") from error
    names = [name for name, v in slave.fmu.variables.items() if v.causality == "parameter"]
    own = present_values(slave, names)
    if differ := [name for name in every if own[name] != every[name]]:
        first = {"method": 0, "samplePeriod": 1}
        name = min(differ, key=lambda each: first.get(each, 2))
        more = f" (and {len(differ) - 1} more)" if len(differ) > 1 else ""
        raise LogError(
            f"{configuration}: {name} = {every[name]}, but {learned.path} was written with "
            f"{own[name]}{more}; {_OTHER}"
        )
    return gap(slave, t_0, every)
