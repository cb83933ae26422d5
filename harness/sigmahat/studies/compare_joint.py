"""What `sigmahat compare` runs: a joint in motion, whose motor data are given with errors.

A joint is one co-simulation, in which both methods estimate the stiffness once for each case. A
case is the difference between the motor data of the estimators and the motor data of the joint.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from sigmahat.experiments.metrics import Index
from sigmahat.experiments.scenario import Scenario, Sine
from sigmahat.fmi.model import Value
from sigmahat.paper.scenarios import SCENARIOS, lever_arm

PAPER2011, REGRESSION = METHODS = ("Paper2011", "FilteredRegression")
TRUE = {"D_theta": 1e-3, "B": 2.3e-5}  # motor data of every joint here [N.m.s/rad], [kg.m2]


@dataclass(frozen=True)
class GivenData:
    """A case: the data given to the estimators, relative to the data of the joint."""

    motor_errors: Mapping[str, float] = field(default_factory=dict)
    """Relative errors of motor data [1], by the name of the parameter; empty: no errors, and
    FilteredRegression takes the motor data as exact."""
    nominal_error: float | None = None  # of a nominal stiffness, relative [1]; None: none is given
    regression: Mapping[str, Value] = field(default_factory=dict)
    """Further start values of FilteredRegression: standard deviations of its priors, and others."""


@dataclass(frozen=True)
class MovingJoint:
    """A joint in motion, estimated by both methods in every case."""

    scenario: Scenario
    """Plant, estimators, and a single table: the indices that judge the estimators. Function
    `comparison_name` gives the names of the comparisons."""
    cases: Sequence[GivenData]

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

    case  place in MovingJoint.cases
    """
    return f"{method}-{case + 1}.sigma{part}"


Performance = Mapping[str, float]
"""Numbers of one method, in one run or as means over runs: the fields of Indices, MOTOR, and

sigma_std  RMS relative to the true stiffness, from CALIBRATED on [%]
inside     instants from CALIBRATED on with an error of at most 1.96 sigma_std [%]
"""
MOTOR = ("D_theta", "B", "tau_coulomb")
"""Motor data estimated at the end [N.m.s/rad, kg.m2, N.m]; nan for several motors."""
CALIBRATED = 2.0  # time from which on sigma_std is compared with the error [s]


@dataclass(frozen=True)
class ComparisonRow:
    """A stiffness of a joint in one case, evaluated by one index."""

    joint: MovingJoint
    case: GivenData
    part: str  # an element of MovingJoint.parts
    index: Index
    performance: Mapping[str, Performance]  # means over the seeds, by method
    half_width: Mapping[str, float]
    """Half the 95 % interval of the mean of the index, by method; nan for a single seed."""

    @property
    def judged_from(self) -> float:
        """Time from which on the index judges the stiffness [s]."""
        return self.joint.scenario.settled if self.index.settled else 0.0

    def error(self, method: str) -> float:
        """The index for a method, in its unit."""
        return self.performance[method][self.index.field]
