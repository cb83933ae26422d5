"""The conditions of `sigmahat compare`: joints in motion, and motor data that are wrong.

A joint is one co-simulation, in which both methods estimate the stiffness once for each case. A
case is the difference between the motor data of the estimators and the motor data of the joint.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace

from sigmahat.experiments.scenario import Comparison, Scenario, Sine
from sigmahat.fmi.master import EstimatorFmu
from sigmahat.fmi.model import Value
from sigmahat.paper.scenarios import SCENARIOS, awas, lever_arm

PAPER2011, REGRESSION = METHODS = ("Paper2011", "FilteredRegression")
TRUE = {"D_theta": 1e-3, "B": 2.3e-5}  # motor data of every joint here [N.m.s/rad], [kg.m2]


@dataclass(frozen=True)
class Case:
    """The data given to the estimators, relative to the data of the joint."""

    motor_errors: Mapping[str, float] = field(default_factory=dict)
    """Relative errors of motor data [1], by the name of the parameter; empty: no errors, and
    FilteredRegression takes the motor data as exact."""
    nominal_error: float | None = None  # of a nominal stiffness, relative [1]; None: none is given
    regression: Mapping[str, Value] = field(default_factory=dict)
    """Further start values of FilteredRegression: standard deviations of its priors, and others."""


@dataclass(frozen=True)
class Joint:
    """A joint in motion, estimated by both methods in every case."""

    scenario: Scenario
    """Plant, estimators, and a single table: the indices that judge the estimators. Function
    `comparison_name` gives the names of the comparisons."""
    cases: Sequence[Case]

    @property
    def parts(self) -> Sequence[str]:
        """Suffixes of the FMU variables of all stiffnesses that are judged: "", "_1", "_2"."""
        return ("", "_1", "_2") if self.scenario.plant.fmu == "AntagonisticVsaPlant" else ("",)

    @property
    def lever_arm(self) -> float | None:
        """Lever arm r(0) [m]; None for a joint without a lever arm."""
        plant = self.scenario.plant
        return lever_arm(plant) if plant.fmu == "AwasPlant" else None

    @property
    def frequency(self) -> float | None:
        """Frequency of the motor torque [Hz]; None in a scenario of the paper, which has a name."""
        tau = self.scenario.plant.inputs.get("tau")
        is_of_paper = self.scenario.name in SCENARIOS
        return tau.frequency if isinstance(tau, Sine) and not is_of_paper else None

    @property
    def coulomb(self) -> float:
        """Coulomb friction of the motor [N.m]."""
        return float(self.scenario.plant.start.get("motor.tau_coulomb", 0.0))


def comparison_name(case: int, method: str, part: str) -> str:
    """Name of a comparison in the scenario of a joint, and the signal of its estimate.

    case  place in Joint.cases
    """
    return f"{method}-{case + 1}.sigma{part}"


_STIFFNESS = ("sigma", "sigma_std")
_MOTOR_DATA = ("D_theta_hat", "B_hat", "tau_coulomb_hat")
_K_S = 14220.0  # of (28) [N/m]
_COULOMB = 0.02  # [N.m]
_WHOLE, _SETTLED = "msrep", "msrep_settled"


def _methods(base: EstimatorFmu, case: Case, parts: Sequence[str]) -> dict[str, EstimatorFmu]:
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


def _joint(scenario: Scenario, cases: Sequence[Case], *judged: str) -> Joint:
    """The plant of a scenario, with an estimator for each case and method."""
    parts, base = Joint(scenario, cases).parts, scenario.estimators["RESIDUAL"]
    compared = replace(
        scenario,
        estimators={
            f"{method}-{i}": each
            for i, case in enumerate(cases, 1)
            for method, each in _methods(base, case, parts).items()
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
    return Joint(compared, cases)


def _awas_joints() -> Iterator[Joint]:
    """The AwAS in three versions, each at six frequencies and with wrong motor data."""
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
    for retraction, coulomb, cases, judged in kinds:
        for frequency in (0.1, 0.3, 1, 3, 8, 20):
            plant = awas(retraction, Sine(0.3 if frequency < 5 else 0.5, frequency))
            if coulomb:
                plant = replace(plant, start={**plant.start, "motor.tau_coulomb": coulomb})
            scenario = replace(SCENARIOS["table1"], name=f"awas-{frequency:g}hz", plant=plant)
            yield _joint(scenario, cases, judged)


def _paper_joints() -> Iterator[Joint]:
    """Scenarios of the paper; in Table I the motor data are right, and taken as exact."""
    exact: Mapping[str, Value] = {"prior.D_theta": 0.0}
    nominal = {**exact, "prior.nominal": 0.3, "prior.tau_e": 0.0}
    cases = [Case(regression=exact), Case(nominal_error=0.3, regression=nominal)]
    yield _joint(SCENARIOS["table1"], cases, _WHOLE)
    single: Mapping[str, Value] = {"range.phi": 0.1}
    pair: Mapping[str, Value] = {"range.phi": 1.0, "rls.n": 6}
    for name, scenario in SCENARIOS.items():
        if name.startswith("single-") or name == "antagonistic":
            case = Case({"D_theta": 0.1}, regression=pair if name == "antagonistic" else single)
            yield _joint(scenario, [case], _WHOLE, _SETTLED)


JOINTS: Sequence[Joint] = (*_awas_joints(), *_paper_joints())
