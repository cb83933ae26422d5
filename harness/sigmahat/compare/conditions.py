"""The conditions of `sigmahat compare`: joints in motion, and motor data that are wrong.

A joint is one co-simulation. In it both methods estimate the stiffness once for each case. A case
is how the motor data that the estimators are given differ from those of the joint.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from enum import Enum

from sigmahat.fmi.instance import Value
from sigmahat.fmi.master import EstimatorFmu
from sigmahat.paper.awas import R_0, awas, estimator
from sigmahat.paper.scenarios import SCENARIOS
from sigmahat.runs.scenario import Comparison, Scenario, Sine

PAPER2011, REGRESSION = METHODS = ("Paper2011", "FilteredRegression")
TRUE = {"D_theta": 1e-3, "B": 2.3e-5}
"""Motor data of every joint here [N.m.s/rad], [kg.m2]."""


class Device(Enum):
    """What kind of joint it is."""

    AWAS = 1
    SINGLE = 2
    """One flexible transmission."""
    ANTAGONISTIC = 3
    """A pair of transmissions."""


@dataclass(frozen=True)
class Case:
    """The data that the estimators are given, compared with those of the joint."""

    motor_errors: Mapping[str, float] = field(default_factory=dict)
    """Relative errors of motor data [1], by the name of the parameter; empty: none, and
    FilteredRegression takes them as exact."""
    nominal_error: float | None = None
    """Relative error of a nominal stiffness [1]; None: the estimators are given none."""
    regression: Mapping[str, Value] = field(default_factory=dict)
    """Further start values of FilteredRegression: what it is given of uncertainties."""


@dataclass(frozen=True)
class Joint:
    """A joint in motion, estimated by both methods in every case."""

    device: Device
    scenario: Scenario
    """Plant, estimators, and as its only table the indices by which they are judged. The
    comparisons have the names that `comparison_name` gives."""
    cases: Sequence[Case]
    paper: bool
    """Whether the motion is that of a scenario of the paper, which has its name."""
    frequency: float
    """Of the motor torque [Hz]; nan for an antagonistic pair, whose torques have two."""
    lever_arm: float
    """r(0) [m]; nan where there is none."""
    coulomb: float
    """Coulomb friction of the motor [N.m]."""
    parts: Sequence[str] = ("",)
    """Stiffnesses that are judged, by what their FMU variables end with: "", "_1", "_2"."""


def comparison_name(case: int, method: str, part: str) -> str:
    """Name of a comparison in the scenario of a joint: the signal of its estimate.

    case  place in Joint.cases
    """
    return f"{_estimator_name(case, method)}.sigma{part}"


def _estimator_name(case: int, method: str) -> str:
    return f"{method}-{case + 1}"


_STIFFNESS = ("sigma", "sigma_std")
_MOTOR_DATA = ("D_theta_hat", "B_hat", "tau_coulomb_hat")
_K_S = 14220.0  # of (28) [N/m]
_COULOMB = 0.02  # [N.m]
_WHOLE, _SETTLED = "msrep", "msrep_settled"


def _methods(
    base: EstimatorFmu, case: Case, parts: Sequence[str], motors: Sequence[str]
) -> dict[str, EstimatorFmu]:
    """The estimator with each method, from one with the settings that they share."""
    given: dict[str, Value] = {
        f"{motor}.{name}": (1 + error) * TRUE[name]
        for motor in motors
        for name, error in case.motor_errors.items()
    }
    if case.nominal_error is not None:
        # k_s r^2 sin 2 phi up to phi^3, for a lever arm in mm
        k_s = (1 + case.nominal_error) * _K_S * 1e-6
        given |= {"rls.eta_0[0,2]": 2 * k_s, "rls.eta_0[1,2]": -8 / 6 * k_s}
    record = [
        f"{output}{part}"
        for part in parts
        # Motors belong to the sides of a pair, not to the whole.
        for output in (*_STIFFNESS, *(_MOTOR_DATA if part or len(parts) == 1 else ()))
    ]
    paper = replace(base, start={**base.start, **given}, record=record)
    regression = {
        "method": REGRESSION,
        "rls.n": 3,
        "prior.tau_coulomb": 0.0,
        "prior.torque_gain": 0.0,  # that of the joints is exact
        **case.regression,
    }
    return {PAPER2011: paper, REGRESSION: replace(paper, start={**paper.start, **regression})}


def _compared(
    scenario: Scenario,
    base: EstimatorFmu,
    cases: Sequence[Case],
    judged: Sequence[str],
    parts: Sequence[str] = ("",),
    motors: Sequence[str] = ("motor",),
) -> Scenario:
    """The plant of a scenario, with an estimator for each case and method."""
    return replace(
        scenario,
        estimators={
            _estimator_name(i, method): each
            for i, case in enumerate(cases)
            for method, each in _methods(base, case, parts, motors).items()
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


def _awas_joints() -> list[Joint]:
    """The AwAS at six frequencies: three joints, and which motor data are wrong."""
    high, low = Case({"D_theta": 0.1}), Case({"D_theta": -0.1})
    friction: Mapping[str, Value] = {"prior.tau_coulomb": _COULOMB}
    with_friction = [
        replace(high, regression=friction),
        Case({"D_theta": 0.1, "B": 0.1}, regression={**friction, "prior.B": 0.1}),
    ]
    kinds: Sequence[tuple[float, float, Sequence[Case], str]] = (
        (0.030, 0.0, [high, low], _WHOLE),
        (-0.030, 0.0, [high], _WHOLE),
        (0.030, _COULOMB, with_friction, _SETTLED),
    )
    return [
        _awas_joint(retraction, frequency, coulomb, cases, judged)
        for retraction, coulomb, cases, judged in kinds
        for frequency in (0.1, 0.3, 1, 3, 8, 20)
    ]


def _awas_joint(
    retraction: float, frequency: float, coulomb: float, cases: Sequence[Case], judged: str
) -> Joint:
    plant = awas(retraction, Sine(0.3 if frequency < 5 else 0.5, frequency))
    if coulomb:
        plant = replace(plant, start={**plant.start, "motor.tau_coulomb": coulomb})
    scenario = replace(SCENARIOS["table1"], name=f"awas-{frequency:g}hz", plant=plant)
    return Joint(
        Device.AWAS,
        _compared(scenario, estimator({"modality": "Residual"}), cases, [judged]),
        cases,
        paper=False,
        frequency=frequency,
        lever_arm=R_0 - retraction,
        coulomb=coulomb,
    )


def _table1() -> Joint:
    """Table I: the motor data are right, and FilteredRegression takes them as exact."""
    exact: Mapping[str, Value] = {"prior.D_theta": 0.0}
    cases = [
        Case(regression=exact),
        Case(nominal_error=0.3, regression={**exact, "prior.nominal": 0.3, "prior.tau_e": 0.0}),
    ]
    table1 = SCENARIOS["table1"]
    return Joint(
        Device.AWAS,
        _compared(table1, table1.estimators["RESIDUAL"], cases, [_WHOLE]),
        cases,
        paper=True,
        frequency=_frequency(table1),
        lever_arm=0.070,
        coulomb=0.0,
    )


def _single_joint(scenario: Scenario) -> Joint:
    cases = [Case({"D_theta": 0.1}, regression={"range.phi": 0.1})]
    base = scenario.estimators["RESIDUAL"]
    return Joint(
        Device.SINGLE,
        _compared(scenario, base, cases, [_WHOLE, _SETTLED]),
        cases,
        paper=True,
        frequency=_frequency(scenario),
        lever_arm=math.nan,
        coulomb=0.0,
    )


def _frequency(scenario: Scenario) -> float:
    tau = scenario.plant.inputs["tau"]
    assert isinstance(tau, Sine)
    return tau.frequency


def _antagonistic_joint() -> Joint:
    scenario = SCENARIOS["antagonistic"]
    cases = [Case({"D_theta": 0.1}, regression={"range.phi": 1.0, "rls.n": 6})]
    parts, motors = ("", "_1", "_2"), ("motor_1", "motor_2")
    base = scenario.estimators["RESIDUAL"]
    return Joint(
        Device.ANTAGONISTIC,
        _compared(scenario, base, cases, [_WHOLE, _SETTLED], parts, motors),
        cases,
        paper=True,
        frequency=math.nan,
        lever_arm=math.nan,
        coulomb=0.0,
        parts=parts,
    )


JOINTS: Sequence[Joint] = (
    *_awas_joints(),
    _table1(),
    *(_single_joint(each) for name, each in SCENARIOS.items() if name.startswith("single-")),
    _antagonistic_joint(),
)
