"""The plan of `sigmahat compare --misfits`: joints that differ from the model of the method.

A condition is a misfit that is added to an experiment without misfits. To study other misfits, copy
this file and change CONDITIONS. A *claim* is the standard deviation sigma_std of an estimate.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from functools import cached_property, partial
from pathlib import Path

import numpy as np

from sigmahat.estimator.estimator import Estimator
from sigmahat.experiments import benchmark
from sigmahat.experiments.benchmark import LogWithTruth
from sigmahat.experiments.job import Job, Outcome
from sigmahat.experiments.pool import Progress
from sigmahat.experiments.scenario import Sine, Sines
from sigmahat.experiments.scores import SETTLED, Score
from sigmahat.fmi.model import Value
from sigmahat.show.panel import FigureRows
from sigmahat.studies import misfit_results
from sigmahat.studies.misfit_experiment import (
    AWAS,
    JOINTS,
    SEA_1K,
    SEA_5K,
    Change,
    Condition,
    Control,
    Experiment,
    Group,
    JointKind,
    TorqueHold,
    draw,
)
from sigmahat.studies.misfit_results import MisfitRow
from sigmahat.studies.misfit_run import PLANT, peak_deformation, run


def other_joint(experiment: Experiment) -> Experiment:
    """Another joint of the kind, without misfits: other inertias, friction and stiffness."""
    rng = np.random.default_rng([experiment.seed, 1])
    drawn = np.exp(rng.standard_normal(4) * (0.25, 0.4, 0.3, 0.3))
    inertia, friction, link, stiffness = drawn.tolist()
    factors = {
        "motor.B": inertia,
        "motor.D_theta": friction,
        "link.M": link,
        "spring.k_s" if experiment.joint is AWAS else "spring.k_1": stiffness,
        "motor.tau_coulomb": 2 * rng.uniform(),
    }
    plant = experiment.plant
    return experiment.with_plant({name: f * plant[name] for name, f in factors.items()})


def all_misfits(experiment: Experiment) -> Experiment:
    """Another joint of the kind, with every misfit at once, each of a random size."""
    clean = other_joint(experiment)
    rng = np.random.default_rng([experiment.seed, 2])
    joint, peak = clean.joint, peak_deformation(clean)

    def normal(deviation: float) -> float:
        return deviation * float(rng.standard_normal())

    def uniform(most: float) -> float:
        return float(rng.uniform(0.0, most))

    # The order determines which random numbers are drawn.
    plant = {
        "sensor.tau_gain": 1 + normal(0.02),
        "sensor.tau_bias": normal(0.01) * joint.torque,
        "motor.uneven": normal(0.1),
        "motor.load_friction": uniform(0.1),
        "motor.cogging": uniform(0.01) * joint.torque,
        "motor.cogging_order": float(rng.choice((6, 12))),
        "motor.stribeck": uniform(0.3),
        "encoder.q_eccentricity": uniform(0.2e-3),
        "encoder.theta_eccentricity": uniform(0.02e-3),
        "encoder.q_offset": normal(0.2e-3),
        "spring.dahl": uniform(0.03) * clean.stiffness * peak,
        "spring.dahl_phi": 0.03 * peak,
        "spring.damping": uniform(1 / 500),
        "spring.gap": uniform(0.02e-3 if joint is SEA_5K else 0.1e-3),
        "gear.kinematic_error": uniform(0.05e-3),
    }
    return replace(
        clean.with_plant(plant),
        late=normal(1e-3),
        jitter=uniform(0.01),
        drift={"D_theta_change": normal(0.1)},
    )


def _plant(**start: float) -> Change:
    """Start values of the plant; "__" stands for the dot in their names."""
    values = {name.replace("__", "."): value for name, value in start.items()}
    return lambda experiment: experiment.with_plant(values)


def _estimator(**start: int) -> Change:
    """Start values of the estimator, with names as in _plant()."""
    values = {name.replace("__", "."): value for name, value in start.items()}
    return lambda experiment: experiment.with_estimator(values)


def _share_of_torque(
    name: str, share: float, experiment: Experiment, **others: float
) -> Experiment:
    """A start value that is a fraction of the peak of the torque command; others as in _plant()."""
    return _plant(**others)(experiment.with_plant({name: share * experiment.joint.torque}))


def _run(**changed: float | TorqueHold | Mapping[str, float]) -> Change:
    return lambda experiment: replace(experiment, **changed)  # type: ignore[arg-type]


def _dahl(share: float, experiment: Experiment) -> Experiment:
    """Hysteresis of a fraction of the peak torque, with 3 % of the peak deformation."""
    peak = peak_deformation(experiment)
    torque = share * experiment.stiffness * peak
    return experiment.with_plant({"spring.dahl": torque, "spring.dahl_phi": 0.03 * peak})


def _hardening(n: int, experiment: Experiment) -> Experiment:
    """A spring that is 30 % stiffer at the usual peak of the deformation."""
    k_3 = 0.3 * experiment.stiffness / (3 * experiment.joint.deformation**2)
    return experiment.with_plant({"spring.k_3": k_3}).with_estimator({"rls.n": n})


def _control(
    experiment: Experiment, link_velocity: bool = False, gravity: bool = False
) -> Experiment:
    """Sets PD control of the motor position, with smaller amplitudes at higher frequencies."""
    joint, share = experiment.joint, 0.6 if gravity else 1.0
    terms = [
        replace(s, amplitude=3 * share * s.amplitude / joint.torque / (1 + omega))
        for s in experiment.torque.terms
        for omega in [2 * math.pi * s.frequency]
    ]
    # The reference begins at the mean position.
    begin = sum(s.amplitude * math.sin(s.phase) for s in terms)
    reference = Sines((math.pi / 2 if gravity else 0.0) - begin, terms)
    kq = joint.kd / 2 if link_velocity else 0.0
    heavy = experiment.with_plant({"link.mgl": 12.0}) if gravity else experiment
    control = Control(reference, joint.kp, joint.kd, kq)
    return replace(heavy, control=control, hold=TorqueHold.HELD_MEAN)


def _load(experiment: Experiment) -> Experiment:
    """A constant load, and the mean torque of the motor that carries it."""
    load = experiment.joint.load
    terms = [Sine(0.9 * s.amplitude, s.frequency, s.phase) for s in experiment.torque.terms]
    torque = Sines(-load / experiment.plant["motor.gamma"], terms)
    return replace(experiment, load=load, torque=torque)


def _exact_inertia(change: Change, experiment: Experiment, error: float = 0.0) -> Experiment:
    """B is given as exact, right or with a relative error."""
    changed = change(experiment).with_estimator({"prior.B": 0.0})
    return replace(changed, errors={**changed.errors, "B": error})


_SEA = (SEA_1K, SEA_5K)
_COARSE = (AWAS, SEA_1K)
_clean, _class_1, _class_2, _class_3, _gain, _random, _none = (
    partial(Condition, group) for group in Group
)

_MISFITS: Sequence[Condition] = (
    _clean("none", _run()),
    _clean("500 Hz", _run(T=2e-3)),
    _clean("5 kHz", _run(T=2e-4)),
    _clean("contact", lambda experiment: experiment.with_plant(experiment.joint.contact)),
    _clean("PD on motor, mean of held torque", _control),
    _clean("PD on motor, feedback of q", partial(_control, link_velocity=True)),
    _clean("PD and gravity, one sign of phi", partial(_control, gravity=True), _SEA),
    _clean("constant load, one sign of phi", _load),
    _class_1("torque bias 2 %", partial(_share_of_torque, "sensor.tau_bias", 0.02)),
    _class_1("uneven Coulomb friction 20 %", _plant(motor__uneven=0.2)),
    _class_1("load friction 0.1", _plant(motor__load_friction=0.1)),
    _class_1("load friction 0.2", _plant(motor__load_friction=0.2)),
    _class_1("eccentric encoder of q, 0.31 mrad", _plant(encoder__q_eccentricity=0.31e-3)),
    _class_1("eccentric encoder of q, 0.87 mrad", _plant(encoder__q_eccentricity=0.87e-3)),
    _class_1("zero of q 0.2 mrad off", _plant(encoder__q_offset=0.2e-3)),
    _class_1("torque 1 ms late", _run(late=1e-3)),
    _class_1("torque 2 ms late", _run(late=2e-3)),
    _class_1("damping k/300 s", _plant(spring__damping=1 / 300)),
    _class_1("damping k/1000 s", _plant(spring__damping=1 / 1000)),
    _class_1("jitter 5 %", _run(jitter=0.05)),
    _class_2("zero of q 2 mrad off", _plant(encoder__q_offset=2e-3)),
    _class_2("hysteresis 2 %", partial(_dahl, 0.02)),
    _class_2("hysteresis 5 %", partial(_dahl, 0.05)),
    _class_2("backlash 1 mrad", _plant(spring__gap=0.5e-3)),
    _class_2("n = 1, too small", _estimator(rls__n=1), (AWAS,)),
    _class_2("m = 2, too small", _estimator(rls__m=2), (AWAS,)),
    _class_2("hardening spring, n = 1", partial(_hardening, 1), _SEA),
    *(
        _class_2(
            f"eccentric encoder of theta, {1e3 * size:g} mrad",
            _plant(encoder__theta_eccentricity=size),
            _COARSE,
        )
        for size in (0.031e-3, 0.087e-3)
    ),
    *(
        _class_3(
            f"cogging {order} per turn, {100 * share:g} %",
            partial(_share_of_torque, "motor.cogging", share, motor__cogging_order=order),
        )
        for order in (6, 12)
        for share in (0.02, 0.05)
    ),
    _class_3("Stribeck 1.5 times", _plant(motor__stribeck=0.5)),
    *(
        _class_3(f"{words} friction -30 % in 60 s", _run(drift={name: -0.3}, duration=60.0))
        for words, name in (("viscous", "D_theta_change"), ("Coulomb", "tau_coulomb_change"))
    ),
    *(
        _gain(f"gain {gain:g}, prior {prior:g}", _plant(sensor__tau_gain=gain), torque_gain=prior)
        for prior, gains in ((0.02, (0.98, 1.025)), (0.05, (0.95, 1.05)), (0.1, (0.9, 1.1)))
        for gain in gains
    ),
    _gain(
        "gain 0.9, prior 0.1, B exact",
        partial(_exact_inertia, _plant(sensor__tau_gain=0.9)),
        torque_gain=0.1,
    ),
    _none("viscous friction bends at 4 rad/s", _plant(motor__v_bend=4.0), _COARSE),
    _none("torque 5 ms late", _run(late=5e-3)),
    _none("held torque, u(k)", _run(hold=TorqueHold.HELD)),
    _none("held torque, mean of u", _run(hold=TorqueHold.HELD_MEAN)),
    _none("kinematic error 0.3 mrad", _plant(gear__kinematic_error=0.3e-3)),
    _none("kinematic error 0.1 mrad", _plant(gear__kinematic_error=0.1e-3), _SEA),
    _none("hysteresis 10 %", partial(_dahl, 0.1)),
    _none("damping k/100 s", _plant(spring__damping=1 / 100)),
    *(
        _none(f"encoders of {counts:.0f} counts", _plant(encoder__theta=counts, encoder__q=counts))
        for counts in (4096.0, 65536.0, 1048576.0)
    ),
    _none("q read 2 ms after theta", _plant(encoder__q_delay=2e-3)),
    _none("hardening spring, n = 3", partial(_hardening, 3), _SEA),
    _none("rest for 30 s, then motion for 10 s", _run(rest=30.0, duration=40.0)),
)
_CHANGES = {condition.name: condition.change for condition in _MISFITS}
_WITH_EXACT_INERTIA = (
    "none", "load friction 0.1", "hysteresis 5 %", "damping k/300 s",
    "eccentric encoder of q, 0.31 mrad", "zero of q 0.2 mrad off", "jitter 5 %", "torque 2 ms late",
)  # fmt: skip

CONDITIONS: Sequence[Condition] = (
    *_MISFITS,
    *(_none(f"B exact: {n}", partial(_exact_inertia, _CHANGES[n])) for n in _WITH_EXACT_INERTIA),
    _none("B 5 % wrong, given as exact", partial(_exact_inertia, _run(), error=0.05)),
    _random("random, all misfits at once", all_misfits, torque_gain=0.02),
    _none("random, without misfits", other_joint),
)

METHOD, ESTIMATOR = "FilteredRegression", "StiffnessEstimator"


def pairs(
    conditions: Sequence[Condition], joints: Sequence[JointKind]
) -> list[tuple[Condition, JointKind]]:
    """Returns the rows of a table: each condition with the joints where its misfit can occur."""
    return [
        (condition, joint)
        for condition in conditions
        for joint in joints
        if joint in condition.joints
    ]


def settings(experiment: Experiment, torque_gain: float) -> dict[str, Value]:
    """Start values of StiffnessEstimator, with method FilteredRegression.

    torque_gain  prior standard deviation of the gain of the measured torque [1]
    """
    joint, plant, errors = experiment.joint, experiment.plant, experiment.errors
    given: dict[str, Value] = {
        "method": METHOD,
        "modality": "Residual",
        "samplePeriod": experiment.T,
        "rls.n": joint.order,
        "rls.m": joint.order,
        "range.phi": joint.range_phi,
        "noise.tau": 3.2e-3,
        "encoder.theta": plant["encoder.theta"],
        "encoder.q": plant["encoder.q"],
        "motor.gamma": plant["motor.gamma"],
        "motor.D_theta": (1 + errors["D_theta"]) * plant["motor.D_theta"],
        "motor.B": (1 + errors["B"]) * plant["motor.B"],
        "prior.tau_e": 45.0,
        "prior.D_theta": 0.2,
        "prior.B": 0.1,
        # The nominal friction of this kind of joint; the joint itself may have other friction.
        "prior.tau_coulomb": joint.plant["motor.tau_coulomb"],
        "prior.torque_gain": torque_gain,
        "regression.bandwidth": 350.0,
    }
    return {**given, **experiment.estimator}


def simulated_log(condition: str, joint: str, seed: int) -> LogWithTruth:
    """Simulates a joint under a condition, both given by their names, and returns its log.

    Raises FileNotFoundError without the FMU of the plant, FmuError if it refuses a value.
    """
    chosen = next(each for each in CONDITIONS if each.name == condition)
    kind = next(each for each in JOINTS if each.name == joint)
    experiment = chosen.change(draw(kind, seed))
    motion = run(experiment)
    return LogWithTruth(
        name=f"{CONDITIONS.index(chosen):02}-{joint}-{seed}",
        kind=f"{condition}, {joint}",
        seed=seed,
        sample_period=experiment.T,
        measured=motion.measured,
        stiffness=motion.sigma,
        parameters=settings(experiment, chosen.torque_gain),
        judged_from=experiment.rest + SETTLED,
    )


def estimate_score(log: LogWithTruth) -> Score:
    """Computes the score of FilteredRegression on a log."""
    record = ("sigma", "sigma_std", "confident")
    estimator = Estimator(log.parameters, record, warn_of_range=False)
    found = estimator.run(**log.measured)
    return log.score(found["sigma"], found["confident"], std=found["sigma_std"])


def scored(condition: str, joint: str, seed: int) -> Outcome:
    """Does one run of the plan; arguments as for simulated_log().

    Conditions have functions, which other processes cannot receive, so their names are sent.
    """
    return Outcome({METHOD: asdict(estimate_score(simulated_log(condition, joint, seed)))})


def write_logs(
    folder: Path,
    seeds: Sequence[int],
    conditions: Sequence[Condition] = CONDITIONS,
    joints: Sequence[JointKind] = JOINTS,
    processes: int | None = None,
    progress: Progress = lambda done: None,
) -> None:
    """Writes the logs of the study with their truth as a benchmark, about 2 MB a log.

    Arguments and errors are those of sigmahat.experiments.benchmark.write().
    """
    makers = [
        partial(simulated_log, condition.name, joint.name, seed)
        for condition, joint in pairs(conditions, joints)
        for seed in seeds
    ]
    benchmark.write(makers, folder, processes, progress)


@dataclass(frozen=True)
class Misfits:
    """The plan: each condition, on the joints where its misfit can occur, with each seed."""

    conditions: Sequence[Condition]
    joints: Sequence[JointKind]
    seeds: Sequence[int]

    name = "compare"

    @cached_property
    def jobs(self) -> list[Job]:
        return [
            Job(
                partial(scored, condition.name, joint.name, seed),
                fmus=(PLANT, ESTIMATOR),
                about=("misfits", condition.name, joint.name, seed),
            )
            for condition, joint in pairs(self.conditions, self.joints)
            for seed in self.seeds
        ]

    def table(self, outcomes: Sequence[Outcome]) -> list[MisfitRow]:
        scores = iter(Score(**outcome.rows[METHOD]) for outcome in outcomes)
        return [
            MisfitRow(condition, joint, sum((next(scores) for _ in self.seeds), Score()))
            for condition, joint in pairs(self.conditions, self.joints)
        ]

    def write(self, table: Sequence[MisfitRow], folder: Path) -> None:
        misfit_results.write(table, len(self.seeds), folder / "misfits.csv")

    def figures(self, table: Sequence[MisfitRow]) -> dict[str, FigureRows]:
        return {"misfits": misfit_results.panels(table)}

    def text(self, table: Sequence[MisfitRow]) -> str:
        return misfit_results.text(table, len(self.seeds))

    def values(self, table: Sequence[MisfitRow]) -> object:
        return misfit_results.values(table)
