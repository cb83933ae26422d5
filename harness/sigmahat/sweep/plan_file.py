"""A plan of a sweep, read from a TOML file and the command line.

    scenario = ["table1"]           # see `sigmahat scenarios`
    seeds = 100                     # 1 to 100; of the noise, and of what is drawn
    modality = ["RESIDUAL"]         # estimators of the scenarios; left out: all
    [parameters]                    # as in plan.py
    plant.motor.D_theta = [0.9e-3, 1.1e-3]
    estimator.residual.K_I = "100:500:5"
    RESIDUAL.motor.B = "normal(2.3e-5, 1e-6)"

A parameter belongs to the plant, to one estimator, or to all of them: "estimator".
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from sigmahat.files import toml_file
from sigmahat.fmi.unknown_name import unknown
from sigmahat.sweep.plan import Plan, Values, values

_KEYS = ("scenario", "seeds", "modality", "parameters")
_MOST = 1_000_000
_UNREADABLE = 10**15  # as a number of runs


def read_plan(
    path: Path | None,
    scenarios: Sequence[str] = (),
    seeds: int | None = None,
    modalities: Sequence[str] = (),
    settings: Sequence[str] = (),
) -> Plan:
    """Reads a plan from a file, from the command line, or from both.

    path        TOML file; None: there is none
    scenarios, seeds, modalities   replace those of the file
    settings    parameters, each "NAME=VALUES"; they replace those of the file, or are added

    Raises ValueError, which names the place, for text that does not fit. Whether the names and
    values fit the scenarios is checked by sigmahat.sweep.check.
    """
    content = {} if path is None else _content(path)
    try:
        parameters = {
            name: _values(name, given)
            for name, given in toml_file.dotted(content.get("parameters", {}))
        }
        plan = Plan(
            tuple(scenarios) or _names(content, "scenario") or ("table1",),
            _seeds(content) if seeds is None else seeds,
            tuple(modalities) or _names(content, "modality"),
            parameters,
        )
    except ValueError as error:
        raise ValueError(f"{path}: {error}") from error
    for setting in settings:
        name, equals, text = setting.partition("=")
        if not equals:
            raise ValueError(f"--set {setting}: expected NAME=VALUES")
        parameters[name.strip()] = _values(name.strip(), text)
    if plan.count > _MOST:
        runs = plan.count if plan.count < _UNREADABLE else f"over {_UNREADABLE}"
        raise ValueError(f"{runs} runs; expected at most {_MOST}")
    for names in (plan.scenarios, plan.modalities):
        if len(set(names)) < len(names):
            raise ValueError(f"{', '.join(names)}: expected each name once")
    return plan


def _content(path: Path) -> dict[str, Any]:
    try:
        content: dict[str, Any] = toml_file.read(path).unwrap()
    except ValueError as error:
        raise ValueError(f"{path}: not readable as TOML: {error}") from error
    except OSError as error:
        raise ValueError(f"cannot read {path}: {error.strerror}") from error
    for key in content:
        if key not in _KEYS:
            raise ValueError(f"{path}: {unknown('key', key, _KEYS)}")
    if not isinstance(content.get("parameters", {}), dict):
        raise ValueError(f"{path}: parameters: expected a table [parameters]")
    return content


def _values(name: str, given: Any) -> Values:
    try:
        return values(given)
    except ValueError as error:
        raise ValueError(f"{name}: {error}") from error


def _names(content: Mapping[str, Any], key: str) -> tuple[str, ...]:
    given = content.get(key, [])
    names = [given] if isinstance(given, str) else given
    if not isinstance(names, list) or not all(isinstance(name, str) for name in names):
        raise ValueError(f"{key}: expected a list of names, got {given!r}")
    return tuple(names)


def _seeds(content: Mapping[str, Any]) -> int:
    seeds = content.get("seeds", 1)
    if not isinstance(seeds, int) or isinstance(seeds, bool) or seeds < 1:
        raise ValueError(f"seeds: expected a number of runs, 1 or more, got {seeds!r}")
    return seeds
