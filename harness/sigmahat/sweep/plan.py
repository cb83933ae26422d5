"""The plan of a sweep: which runs it has, in which order, from a TOML file and the command line.

    scenario = ["table1"]           # see `sigmahat scenarios`
    seeds = 100                     # 1 to 100; of the noise, and of what is drawn
    modality = ["RESIDUAL"]         # estimators of the scenarios; left out: all
    [parameters]                    # as in sweep_values.py
    plant.motor.D_theta = [0.9e-3, 1.1e-3]
    estimator.residual.K_I = "100:500:5"
    RESIDUAL.motor.B = "normal(2.3e-5, 1e-6)"

A parameter belongs to the plant, to one estimator, or to all of them: "estimator".
"""

from __future__ import annotations

import hashlib
import itertools
import json
import math
from collections import defaultdict
from collections.abc import Iterator, Mapping, Sequence
from contextlib import ExitStack
from dataclasses import asdict, dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Any

import tomlkit
from tomlkit.exceptions import ParseError

from sigmahat.fmi.installed import fmu as installed_fmu
from sigmahat.fmi.instance import Fmu, Slave, Value
from sigmahat.fmi.master import Estimator, Plant
from sigmahat.paper.scenarios import Comparison, Scenario, scenario
from sigmahat.sweep.values import Drawn, Values, values
from sigmahat.toml_names import flat
from sigmahat.unknown_name import unknown

_KEYS = ("scenario", "seeds", "modality", "parameters")
_MOST = 1_000_000


@dataclass(frozen=True)
class Run:
    """One co-simulation; all that another process or machine needs to do it."""

    number: int
    scenario: str
    modalities: tuple[str, ...]
    """Empty: all that the scenario compares."""
    seed: int
    parameters: Mapping[str, Value]
    """By name with owner, "plant.motor.B"."""


@dataclass(frozen=True)
class Plan:
    """All runs of a sweep: for each scenario, each combination of listed values, each seed."""

    scenarios: tuple[str, ...]
    seeds: int
    modalities: tuple[str, ...]
    parameters: Mapping[str, Values]

    def __len__(self) -> int:
        listed = [len(v) for v in self.parameters.values() if not isinstance(v, Drawn)]
        return len(self.scenarios) * self.seeds * math.prod(listed)

    @property
    def listed(self) -> list[str]:
        """Names of the parameters that are not drawn."""
        return [name for name, v in self.parameters.items() if not isinstance(v, Drawn)]

    def runs(self) -> Iterator[Run]:
        """The runs in their order."""
        lists = [(v,) if isinstance(v, Drawn) else v for v in self.parameters.values()]
        order = itertools.product(self.scenarios, itertools.product(*lists))
        numbers = itertools.count()
        for name, point in order:
            for seed in range(1, self.seeds + 1):
                chosen: dict[str, Value] = {
                    key: value.value(key, seed) if isinstance(value, Drawn) else value
                    for key, value in zip(self.parameters, point, strict=True)
                }
                yield Run(next(numbers), name, self.modalities, seed, chosen)

    @cached_property
    def digest(self) -> str:
        """Tells sweeps apart that would not give the same numbers."""
        text = hashlib.sha256(fmu_digest(self.scenarios).encode())
        for run in self.runs():
            text.update(json.dumps(asdict(run)).encode())
        return text.hexdigest()[:32]


def read_plan(
    path: Path | None,
    scenarios: Sequence[str] = (),
    seeds: int | None = None,
    modalities: Sequence[str] = (),
    settings: Sequence[str] = (),
) -> Plan:
    """Reads a plan; what else is given replaces what it says, or adds a parameter NAME=VALUES.

    Raises ValueError, which says where, for what does not fit, FmuError if an FMU refuses a value.
    """
    content = {} if path is None else _content(path)
    parameters = {}
    try:
        for name, given in flat(content.get("parameters", {})):
            parameters[name] = _values(name, given)
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
    if len(plan) > _MOST:
        raise ValueError(f"{len(plan)} runs; expected at most {_MOST}")
    _check(plan)
    return plan


def _content(path: Path) -> dict[str, Any]:
    try:
        content: dict[str, Any] = tomlkit.parse(path.read_text(encoding="utf-8")).unwrap()
    except (ParseError, UnicodeDecodeError) as error:
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


def _check(plan: Plan) -> None:
    """Lets the FMUs of each scenario see each listed value once, beside the first of the others."""
    for names in (plan.scenarios, plan.modalities):
        if len(set(names)) < len(names):
            raise ValueError(f"{', '.join(names)}: expected each name once")
    with ExitStack() as stack:
        fmus: dict[str, Fmu] = {}
        for run in _samples(plan):
            # What is drawn may leave its range now and then: that run fails, not the sweep.
            sure = replace(run, parameters={name: run.parameters[name] for name in plan.listed})
            for label, model in _models(sure).items():
                if model.fmu not in fmus:
                    fmus[model.fmu] = stack.enter_context(Fmu(installed_fmu(model.fmu)))
                fmu = fmus[model.fmu]
                for name, value in _models(run)[label].start.items():
                    fmu.variable(name, "parameter")
                    fmu.number(name, value)
                with Slave(fmu, label) as slave:
                    slave.initialize(model.start)


def _samples(plan: Plan) -> Iterator[Run]:
    """The first run of each scenario, and that run with each other listed value."""
    for scenario_name in plan.scenarios:
        first = next(replace(plan, scenarios=(scenario_name,)).runs())
        yield first
        for name in plan.listed:
            listed = plan.parameters[name]
            assert not isinstance(listed, Drawn)
            for value in listed[1:]:
                yield replace(first, parameters={**first.parameters, name: value})


def _models(run: Run) -> dict[str, Plant | Estimator]:
    trimmed = prepare(run)
    return {"plant": trimmed.plant, **trimmed.estimators}


def prepare(run: Run) -> Scenario:
    """The scenario of a run: its parameters, and only what its comparisons need.

    Raises ValueError for a name that does not fit the scenario.
    """
    base = scenario(run.scenario)
    compared = [name for name in base.estimators if name in _sources(base.comparisons)]
    for name in run.modalities:
        if name not in compared:
            raise ValueError(unknown(f"modality of {base.name}", name, compared))
    chosen = run.modalities or tuple(compared)
    # The nominal AwAS is what the parameters of MODEL say, see nominal.py.
    known = {"plant", *chosen, *(["nominal"] if "MODEL" in chosen else [])}
    comparisons = [c for c in base.comparisons if _sources([c]) <= known]
    if not comparisons:
        raise ValueError(f"{base.name} compares nothing with {', '.join(chosen)} alone")
    own: dict[str, dict[str, Value]] = {name: {} for name in ("plant", *chosen)}
    # What is set for all estimators gives way to what is set for one.
    for full in sorted(run.parameters, key=lambda name: not name.startswith("estimator.")):
        owner, _, name = full.partition(".")
        if owner != "estimator" and owner not in own:
            raise ValueError(unknown("owner of a parameter", owner, ["estimator", *own]))
        if full == "plant.noise.seed":
            raise ValueError("plant.noise.seed: the seeds are those of --seeds")
        for each in chosen if owner == "estimator" else (owner,):
            own[each][name] = run.parameters[full]
    signals = _signals(comparisons)
    return replace(
        base,
        comparisons=comparisons,
        plant=replace(
            base.plant,
            start={**base.plant.start, **own["plant"], "noise.seed": run.seed},
            record=sorted(signals["plant"]),
        ),
        estimators={
            name: replace(
                base.estimators[name],
                start={**base.estimators[name].start, **own[name]},
                record=sorted(signals[name]),
            )
            for name in base.estimators
            if name in chosen
        },
    )


def _sources(comparisons: Sequence[Comparison]) -> set[str]:
    return set(_signals(comparisons))


def _signals(comparisons: Sequence[Comparison]) -> dict[str, set[str]]:
    """Variables that the comparisons read, by source."""
    found: dict[str, set[str]] = defaultdict(set)
    for each in comparisons:
        for signal in (each.estimate, each.reference, each.relative_to):
            if signal is not None:
                source, _, variable = signal.rpartition(".")
                found[source].add(variable)
                if source == "nominal":
                    found["plant"] |= {"phi", "theta_c"}
    return found


def fmu_names(scenarios: Sequence[str]) -> list[str]:
    """Names of the FMUs of some scenarios, sorted, each once."""
    chosen = [scenario(name) for name in scenarios]
    estimators = {e.fmu for each in chosen for e in each.estimators.values()}
    return sorted(estimators | {each.plant.fmu for each in chosen})


def fmu_digest(scenarios: Sequence[str]) -> str:
    """Of the FMUs of some scenarios, as they are installed here: 32 hexadecimal digits."""
    text = hashlib.sha256()
    for name in fmu_names(scenarios):
        text.update(installed_fmu(name).read_bytes())
    return text.hexdigest()[:32]
