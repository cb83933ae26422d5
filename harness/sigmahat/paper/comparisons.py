"""Both methods of the estimator, side by side, where motor data are wrong.

The joints and what is known of them are plain data; compare() runs them all.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from sigmahat.fmi.instance import Value
from sigmahat.fmi.master import Estimator, Plant, Recording, simulate
from sigmahat.paper.metrics import msrep
from sigmahat.paper.processes import spread
from sigmahat.paper.scenarios import SCENARIOS, Sine, T, awas, estimator

METHODS = ("Paper2011", "MatchedFilter")
CALIBRATED = 2.0
"""Time from which on sigma_std is compared with the error [s]."""


@dataclass(frozen=True)
class Case:
    """What the estimators of one joint are told, and how they are judged."""

    name: str
    estimators: Mapping[str, Estimator]
    """By method."""
    after: Sequence[float]
    """Times from which on the stiffness is judged [s]."""
    parts: Mapping[str, str]
    """Ends of the names of the stiffnesses that are judged; by what they are, "" if alone."""


@dataclass(frozen=True)
class Joint:
    """A plant in motion."""

    group: str
    """Heading in the table."""
    name: str
    """Row in the table."""
    plant: Plant
    duration: float
    """[s]"""
    cases: Sequence[Case]


@dataclass(frozen=True)
class Found:
    """What one method found; means over seeds."""

    msrep: float
    """(36) [%]"""
    sigma_std: float
    """Root mean square of sigma_std over the true stiffness, from CALIBRATED on [%]"""
    inside: float
    """Share of instants from CALIBRATED on with an error of at most 1.96 sigma_std [%]"""
    D_theta: float
    """D_theta_hat at the end [N.m.s/rad]; nan for a device of several motors"""
    B: float
    """B_hat at the end [kg.m2]; nan for a device of several motors"""
    tau_coulomb: float
    """tau_coulomb_hat at the end [N.m]; nan for a device of several motors"""


@dataclass(frozen=True)
class Line:
    """A line of the table."""

    group: str
    joint: str
    case: str
    after: float
    """MSREP is from this time on [s]."""
    found: Mapping[str, Found]
    """By method."""


_OUTPUTS = ("sigma", "sigma_std", "D_theta_hat", "B_hat", "tau_coulomb_hat")
_MATCHED: Mapping[str, Value] = {"method": "MatchedFilter", "rls.n": 3, "prior.tau_coulomb": 0.0}
_TRUE_D_THETA, _TRUE_B = 1e-3, 2.3e-5
_COULOMB = 0.02  # [N.m]
_UNKNOWN = np.array([np.nan])


_ALONE: Mapping[str, str] = {"": ""}


def _case(
    name: str,
    told: Mapping[str, Value],
    known: Mapping[str, Value],
    after: Sequence[float] = (0.0,),
    base: Estimator | None = None,
    parts: Mapping[str, str] = _ALONE,
) -> Case:
    """told: what both methods are told; known: what MatchedFilter is told besides.

    base: the estimator with Paper2011, by default that of the AwAS as it is
    """
    base = base or estimator({"modality": "Residual"})
    record = [
        f"{output}{end}"
        for end in parts.values()
        for output in (_OUTPUTS if end or len(parts) == 1 else _OUTPUTS[:2])
    ]
    paper = replace(base, start={**base.start, **told}, record=record)
    matched = replace(paper, start={**paper.start, **_MATCHED, **known})
    return Case(name, dict(zip(METHODS, (paper, matched), strict=True)), after, parts)


def _with_friction(plant: Plant) -> Plant:
    return replace(plant, start={**plant.start, "motor.tau_coulomb": _COULOMB})


_D_WRONG = {"motor.D_theta": 1.1 * _TRUE_D_THETA}


def _awas_joints() -> list[Joint]:
    """The AwAS at six frequencies: three joints, and which motor data are wrong."""
    friction = {"prior.tau_coulomb": _COULOMB}
    after = (1.0,)
    cases = [
        _case("D_theta +10 %", _D_WRONG, {}),
        _case("D_theta -10 %", {"motor.D_theta": 0.9 * _TRUE_D_THETA}, {}),
    ]
    with_friction = [
        _case("D_theta +10 %", _D_WRONG, friction, after),
        _case(
            "D_theta +10 %, B +10 %",
            {**_D_WRONG, "motor.B": 1.1 * _TRUE_B},
            {**friction, "prior.B": 0.1},
            after,
        ),
    ]
    torques = [Sine(0.3 if f < 5 else 0.5, f) for f in (0.1, 0.3, 1, 3, 8, 20)]
    kinds: list[tuple[str, Callable[[Sine], Plant], list[Case]]] = [
        ("r(0) = 70 mm", partial(awas, 0.030), cases),
        ("r(0) = 130 mm", partial(awas, -0.030), cases[:1]),
        (
            "r(0) = 70 mm, Coulomb friction 0.02 N.m",
            lambda tau: _with_friction(awas(0.030, tau)),
            with_friction,
        ),
    ]
    return [
        Joint(group, f"{tau.frequency:g} Hz", plant(tau), 15.0, told)
        for group, plant, told in kinds
        for tau in torques
    ]


def _table1() -> Joint:
    """Table I: the motor data are right, and the estimator knows."""
    exact: Mapping[str, Value] = {"prior.D_theta": 0.0}
    nominal = 1.3 * 14220e-6  # k_s, 30 % too high, for a lever arm in mm
    # k_s r^2 sin 2 phi up to phi^3
    curve = {"rls.eta_0[0,2]": 2 * nominal, "rls.eta_0[1,2]": -8 / 6 * nominal}
    return Joint(
        "motor data exact, and known to be",
        "table1",
        awas(0.030),
        15.0,
        [
            _case("stiffness unknown", {}, exact),
            _case(
                "nominal curve +30 %",
                curve,
                {**exact, "prior.nominal": 0.3, "prior.tau_e": 0.0},
            ),
        ],
    )


def _single_joints() -> list[Joint]:
    return [
        Joint(
            "single transmission",
            name,
            scenario.plant,
            scenario.duration,
            [
                _case(
                    "D_theta +10 %",
                    _D_WRONG,
                    {"range.phi": 0.1},
                    (0.0, 1.0),
                    scenario.estimators["RESIDUAL"],
                )
            ],
        )
        for name, scenario in SCENARIOS.items()
        if name.startswith("single-")
    ]


def _antagonistic_joint() -> Joint:
    scenario = SCENARIOS["antagonistic"]
    wrong = {f"motor_{i}.D_theta": 1.1 * _TRUE_D_THETA for i in (1, 2)}
    case = _case(
        "D_theta +10 %",
        wrong,
        {"range.phi": 1.0, "rls.n": 6},
        (0.0, scenario.settled),
        scenario.estimators["RESIDUAL"],
        {"device": "", "side 1": "_1", "side 2": "_2"},
    )
    return Joint("antagonistic pair", scenario.name, scenario.plant, scenario.duration, [case])


JOINTS: Sequence[Joint] = (*_awas_joints(), _table1(), *_single_joints(), _antagonistic_joint())


def compare(
    joints: Sequence[Joint],
    seeds: Sequence[int],
    processes: int | None = None,
    progress: Callable[[int], object] = lambda done: None,
) -> list[Line]:
    """Runs every joint with every seed of the plant's noise; the lines of the table.

    processes, progress   as for sigmahat.processes.spread(); one run at a time is one job

    Raises what simulate() raises.
    """
    # The longest first, so that no process waits for another at the end.
    order = sorted(range(len(joints)), key=lambda i: -_effort(joints[i]))
    jobs = [partial(run, joints[i], seed) for i in order for seed in seeds]
    results = spread(jobs, processes, progress)
    by_joint = {i: results[k * len(seeds) : (k + 1) * len(seeds)] for k, i in enumerate(order)}
    return [
        replace(runs[0][k], found=_mean([each[k].found for each in runs]))
        for _, runs in sorted(by_joint.items())
        for k in range(len(runs[0]))
    ]


def _effort(joint: Joint) -> float:
    return joint.duration * sum(len(case.estimators) for case in joint.cases)


def _mean(runs: Sequence[Mapping[str, Found]]) -> dict[str, Found]:
    return {
        method: Found(
            *np.mean([list(vars(each[method]).values()) for each in runs], axis=0).tolist()
        )
        for method in runs[0]
    }


def run(joint: Joint, seed: int) -> list[Line]:
    """Runs a joint once; its lines of the table. Raises what simulate() raises."""
    plant = replace(joint.plant, start={**joint.plant.start, "noise.seed": seed})
    estimators = {
        f"{case.name}, {method}": each
        for case in joint.cases
        for method, each in case.estimators.items()
    }
    recording = simulate(plant, estimators, T, round(joint.duration / T))
    return [
        Line(
            joint.group,
            joint.name,
            f"{case.name}, {part}" if part else case.name,
            after,
            {m: _found(recording, f"{case.name}, {m}", end, after) for m in case.estimators},
        )
        for case in joint.cases
        for part, end in case.parts.items()
        for after in case.after
    ]


def _found(recording: Recording, name: str, end: str, after: float) -> Found:
    estimate = recording.estimators[name]
    late = recording.t >= after
    true, sigma = recording.plant[f"sigma{end}"], estimate[f"sigma{end}"]
    calibrated = recording.t >= CALIBRATED
    relative_std = (estimate[f"sigma_std{end}"] / true)[calibrated]
    error = np.abs(sigma / true - 1)[calibrated]
    D_theta, B, tau_coulomb = (
        float(estimate.values.get(f"{output}{end}", _UNKNOWN)[-1]) for output in _OUTPUTS[2:]
    )
    return Found(
        msrep=msrep(true[late], sigma[late]),
        sigma_std=100 * float(np.sqrt(np.mean(relative_std**2))),
        inside=100 * float(np.mean(error <= 1.96 * relative_std)),
        D_theta=D_theta,
        B=B,
        tau_coulomb=tau_coulomb,
    )
