"""Writes and reads `state.json`: the estimator state after a log, to continue with the next log.

The JSON file contains the identity of the estimator, the logs, and the bytes of Estimator.save() in
base64. These bytes contain the parameters of the estimator.
"""

import base64
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from sigmahat.estimator.estimator import Estimator
from sigmahat.files.output import write_json
from sigmahat.fmi.installed import version
from sigmahat.fmi.model import installed_model
from sigmahat.recording.log import LogError
from sigmahat.result.stored import NO_OTHER_KEYS, FmuId, Format, LearnedLog, Text, Version, Word

_AGAIN = "run `sigmahat estimate` on the first log again"
_OTHER = f"both must have the same parameters: change the configuration, or {_AGAIN}"


@dataclass(frozen=True)
class Learned:
    """The contents of `state.json` that are needed to continue an estimation."""

    path: Path  # path of the file
    fmu: FmuId  # identity of the FMU with the same estimator
    logs: Sequence[LearnedLog]  # logs that the estimator has processed, in this order
    state: bytes  # of Estimator.save()


@dataclass(frozen=True)
class _StateFile:
    """The schema of the JSON file `state.json`."""

    __pydantic_config__ = NO_OTHER_KEYS

    format: Text
    version: int
    sigmahat: Version
    fmu: FmuId
    method: Word
    logs: list[LearnedLog]
    parameters: dict[str, Any]
    state: Text


LEARNED = Format("state.json", "sigmahat learned state", 2, _StateFile)  # format of the file


def write_learned(estimator: Estimator, logs: Sequence[LearnedLog], path: Path) -> None:
    """Writes the state of an estimator of one joint after the logs."""
    (parameters,) = estimator.parameters
    contents = _StateFile(
        format=LEARNED.name,
        version=LEARNED.version,
        sigmahat=version(),
        fmu=FmuId.of(installed_model("StiffnessEstimator")),
        method=str(parameters["method"]),
        logs=list(logs),
        parameters={n: v for n, v in parameters.items() if v or not n.startswith("rls.eta_0")},
        state=base64.b64encode(estimator.save()).decode(),
    )
    write_json(asdict(contents), path)


def state_of(results: Path, joint: str) -> Path:
    """Returns where the state of a joint is: the file itself, or its place in a folder of results.

    joint  name; "" for a single joint

    Raises LogError for a folder without one for this joint.
    """
    if not results.is_dir() or not joint:
        return results
    if not (results / joint).is_dir():
        raise LogError(
            f"{results}: expected the results of several joints, with a folder {joint}, got none; "
            f"name the folder above, or a {LEARNED.file}"
        )
    return results / joint


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


def continue_from(learned: Learned, estimator: Estimator, configuration: Path) -> None:
    """Restores a saved state in an estimator. Its filters start again with the next sample.

    estimator      for one joint, with the parameters of the configuration
    configuration  the file that contains these parameters, for messages

    Raises LogError if the state is damaged, of another version, or with other parameters.
    """
    theirs, ours = learned.fmu, FmuId.of(installed_model("StiffnessEstimator"))
    if theirs != ours:
        told, wanted = (f"{f.name}.fmu {f.version} ({f.guid})" for f in (theirs, ours))
        raise LogError(f"{learned.path}: state of {told}, expected {wanted}; {_AGAIN}")
    (configured,) = estimator.parameters
    try:
        estimator.restore(learned.state)
    except ValueError as error:
        raise LogError(f"{learned.path}: damaged: {error}; {_AGAIN}") from error
    (saved,) = estimator.parameters
    if differ := [name for name, value in configured.items() if saved[name] != value]:
        first = {"method": 0, "samplePeriod": 1}
        name = min(differ, key=lambda each: first.get(each, 2))
        more = f" (and {len(differ) - 1} more)" if len(differ) > 1 else ""
        raise LogError(
            f"{configuration}: {name} = {configured[name]}, but {learned.path} was written with "
            f"{saved[name]}{more}; {_OTHER}"
        )
    estimator.restart_filters()
