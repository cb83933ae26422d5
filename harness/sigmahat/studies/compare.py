"""The plan of `sigmahat compare`: both methods on joints in motion, with motor data that are wrong.

To compare the methods on other joints, copy this file and change JOINTS.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from functools import cached_property, partial
from pathlib import Path

import numpy as np

from sigmahat.experiments.job import Job, Outcome
from sigmahat.experiments.metrics import INDICES, mean_interval
from sigmahat.experiments.scenario import (
    Comparison,
    Scenario,
    Sine,
    signal_of,
    source_and_variable,
)
from sigmahat.experiments.simulation import indices_by_comparison, run
from sigmahat.fmi.master import EstimatorFmu, Recording
from sigmahat.fmi.model import Value
from sigmahat.paper.scenarios import SCENARIOS, awas
from sigmahat.show.panel import FigureRows
from sigmahat.studies import compare_results
from sigmahat.studies.compare_joint import (
    CALIBRATED,
    METHODS,
    MOTOR,
    PAPER2011,
    REGRESSION,
    TRUE,
    ComparisonRow,
    GivenData,
    MovingJoint,
    Performance,
    comparison_name,
)

_STIFFNESS = ("sigma", "sigma_std")
_MOTOR_DATA = ("D_theta_hat", "B_hat", "tau_coulomb_hat")
_K_S = 14220.0  # of (28) [N/m]
_COULOMB = 0.02  # [N.m]
_WHOLE, _SETTLED = "msrep", "msrep_settled"


def _methods(base: EstimatorFmu, case: GivenData, parts: Sequence[str]) -> dict[str, EstimatorFmu]:
    """Estimators with both methods, from an estimator with the common settings."""
    # Motors belong to the sides of a pair, not to the whole.
    sides = parts if len(parts) == 1 else parts[1:]
    given: dict[str, Value] = {
        f"motor{side}.{name}": (1 + error) * TRUE[name]
        for side in sides
        for name, error in case.motor_errors.items()
    }
    if case.nominal_error is not None:
        # k_s r^2 sin 2 phi up to phi^3, for a lever arm in mm
        k_s = (1 + case.nominal_error) * _K_S * 1e-6
        given |= {"rls.eta_0[0,2]": 2 * k_s, "rls.eta_0[1,2]": -8 / 6 * k_s}
    record = [f"{output}{part}" for part in parts for output in _STIFFNESS]
    record += [f"{output}{side}" for side in sides for output in _MOTOR_DATA]
    paper = replace(base, start={**base.start, **given}, record=record)
    regression = {
        "method": REGRESSION,
        "rls.n": 3,
        "prior.tau_coulomb": 0.0,
        "prior.torque_gain": 0.0,  # the torque gain of the joints is exact
        **case.regression,
    }
    return {PAPER2011: paper, REGRESSION: replace(paper, start={**paper.start, **regression})}


def _joint(scenario: Scenario, cases: Sequence[GivenData], *judged: str) -> MovingJoint:
    """The plant of a scenario, with an estimator for each case and method."""
    parts, base = MovingJoint(scenario, cases).parts, scenario.estimators["RESIDUAL"]
    compared = replace(
        scenario,
        estimators={
            f"{method}-{i}": estimator
            for i, case in enumerate(cases, 1)
            for method, estimator in _methods(base, case, parts).items()
        },
        comparisons=[
            Comparison(name := comparison_name(i, method, part), name, f"plant.sigma{part}")
            for i in range(len(cases))
            for method in METHODS
            for part in parts
        ],
        variants={},
        tables=(judged,),
    )
    return MovingJoint(compared, cases)


def _awas_joints() -> Iterator[MovingJoint]:
    """The AwAS in three versions, each at six frequencies and with wrong motor data."""
    high, low = GivenData({"D_theta": 0.1}), GivenData({"D_theta": -0.1})
    friction: Mapping[str, Value] = {"prior.tau_coulomb": _COULOMB}
    with_friction = [
        replace(high, regression=friction),
        GivenData({"D_theta": 0.1, "B": 0.1}, regression={**friction, "prior.B": 0.1}),
    ]
    kinds: Sequence[tuple[float, float, Sequence[GivenData], str]] = (
        (0.030, 0.0, [high, low], _WHOLE),
        (-0.030, 0.0, [high], _WHOLE),
        (0.030, _COULOMB, with_friction, _SETTLED),
    )
    for retraction, coulomb, cases, judged in kinds:
        for frequency in (0.1, 0.3, 1, 3, 8, 20):
            plant = awas(retraction, Sine(0.3 if frequency < 5 else 0.5, frequency))
            if coulomb:
                plant = replace(plant, start={**plant.start, "motor.tau_coulomb": coulomb})
            scenario = replace(SCENARIOS["table1"], name=f"awas-{frequency:g}hz", plant=plant)
            yield _joint(scenario, cases, judged)


def _paper_joints() -> Iterator[MovingJoint]:
    """Scenarios of the paper; in Table I the motor data are right, and taken as exact."""
    exact: Mapping[str, Value] = {"prior.D_theta": 0.0}
    nominal = {**exact, "prior.nominal": 0.3, "prior.tau_e": 0.0}
    cases = [GivenData(regression=exact), GivenData(nominal_error=0.3, regression=nominal)]
    yield _joint(SCENARIOS["table1"], cases, _WHOLE)
    single: Mapping[str, Value] = {"range.phi": 0.1}
    pair: Mapping[str, Value] = {"range.phi": 1.0, "rls.n": 6}
    for name, scenario in SCENARIOS.items():
        if name.startswith("single-") or name == "antagonistic":
            regression = pair if name == "antagonistic" else single
            case = GivenData({"D_theta": 0.1}, regression=regression)
            yield _joint(scenario, [case], _WHOLE, _SETTLED)


JOINTS: Sequence[MovingJoint] = (*_awas_joints(), *_paper_joints())

_UNKNOWN = np.array([np.nan])


def performances(scenario: Scenario, recording: Recording) -> dict[str, Performance]:
    """The performance of each comparison of the scenario, by its name.

    Every estimate is a stiffness sigma, sigma_1 or sigma_2, with its standard deviation recorded.
    """
    indices = indices_by_comparison(scenario, recording)
    late = recording.t >= CALIBRATED
    rows: dict[str, Performance] = {}
    for comparison in scenario.comparisons:
        estimator, variable = source_and_variable(comparison.estimate)
        part = variable.removeprefix("sigma")
        estimate = recording.estimators[estimator]
        true = signal_of(recording, comparison.reference)
        relative_std = (estimate[f"sigma_std{part}"] / true)[late]
        error = np.abs(estimate[variable] / true - 1)[late]
        rows[comparison.name] = {
            **asdict(indices[comparison.name]),
            "sigma_std": 100 * float(np.sqrt(np.mean(relative_std**2))),
            "inside": 100 * float(np.mean(error <= 1.96 * relative_std)),
            **{n: float(estimate.values.get(f"{n}_hat{part}", _UNKNOWN)[-1]) for n in MOTOR},
        }
    return rows


def judged_run(scenario: Scenario, seed: int) -> Outcome:
    """Does one run of the plan. Raises what simulate() raises."""
    return Outcome(performances(scenario, run(scenario, seed)))


@dataclass(frozen=True)
class MethodComparison:
    """The plan: each joint with each seed of the plant's noise."""

    joints: Sequence[MovingJoint]
    seeds: Sequence[int]

    name = "compare"

    @cached_property
    def jobs(self) -> list[Job]:
        return [
            Job(
                partial(judged_run, joint.scenario, seed),
                fmus=tuple(joint.scenario.fmus),
                about=("compare", repr(joint.scenario), seed),
                effort=joint.scenario.duration * len(joint.scenario.estimators),
            )
            for joint in self.joints
            for seed in self.seeds
        ]

    def table(self, outcomes: Sequence[Outcome]) -> list[ComparisonRow]:
        rows: list[ComparisonRow] = []
        runs = iter(outcomes)
        for joint in self.joints:
            rows += _rows(joint, [next(runs).rows for _ in self.seeds])
        return rows

    def write(self, table: Sequence[ComparisonRow], folder: Path) -> None:
        compare_results.write(table, len(self.seeds), folder / "compare.csv")

    def figures(self, table: Sequence[ComparisonRow]) -> dict[str, FigureRows]:
        return {"compare": compare_results.panels(table)}

    def text(self, table: Sequence[ComparisonRow]) -> str:
        return compare_results.text(table, len(self.seeds))

    def values(self, table: Sequence[ComparisonRow]) -> object:
        return compare_results.values(table)


def _rows(joint: MovingJoint, runs: Sequence[Mapping[str, Performance]]) -> Iterator[ComparisonRow]:
    """The rows of a joint: means over its runs."""
    for number, case in enumerate(joint.cases):
        for part in joint.parts:
            of_methods = {
                method: [run[comparison_name(number, method, part)] for run in runs]
                for method in METHODS
            }
            means = {method: _mean(performed) for method, performed in of_methods.items()}
            for field in joint.scenario.tables[0]:
                half_width = {
                    method: mean_interval([each[field] for each in performed])[1]
                    for method, performed in of_methods.items()
                }
                yield ComparisonRow(joint, case, part, INDICES[field], means, half_width)


def _mean(runs: Sequence[Performance]) -> Performance:
    """The mean of each number over the runs."""
    means = np.mean([list(run.values()) for run in runs], axis=0)
    return dict(zip(runs[0], means.tolist(), strict=True))
