"""Joints and their logs, drawn at random: motion, payload, temperature and noise anew for each log.

A joint has all misfits of the study of misfits, which stay as they are from log to log. A warm
motor has a smaller torque constant and less friction.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from sigmahat.estimator.estimator import Estimator
from sigmahat.fmi.model import Value
from sigmahat.result.curve_of_log import Reach
from sigmahat.result.excitation import Excitation, ExcitationSums
from sigmahat.result.sheet import Together
from sigmahat.result.together import together
from sigmahat.studies.misfit_experiment import SEA_1K, SEA_5K, Experiment, draw
from sigmahat.studies.misfit_run import run
from sigmahat.studies.misfits import all_misfits, settings

KINDS = (SEA_1K, SEA_5K)
DURATION = 60.0  # of a log [s]
TORQUE_CONSTANT = 0.03  # largest change of the torque constant by temperature [1]
FRICTION = 0.1  # largest change of friction by temperature [1]
_PAYLOAD = (0.7, 1.4)  # least and largest inertia of the link over its nominal one [1]
_RECORDED = ("theta_dot", "tau_e", "valid")  # outputs
_OUTLIERS = (0.1, 99.9)  # percentiles of the deformation between which it counts as reached
TORQUE_GAIN = 0.02  # prior.torque_gain of all configurations
UNKNOWN: Mapping[str, Value] = {
    "prior.B": 1.0,
    "prior.D_theta": 1.0,
    "prior.tau_coulomb": 1.0,
}
"""Priors of a motor that is not known: the log determines its inertia."""
EXACT: Mapping[str, Value] = {**UNKNOWN, "prior.B": 0.0}
"""Priors of a motor whose inertia is taken from a data sheet: no log determines it."""


@dataclass(frozen=True)
class Wear:
    """What is different in a log, relative to the healthy joint."""

    spring: float = 0.0  # change of the stiffness [1]
    friction: float = 0.0  # change of Coulomb and viscous friction [1]
    gain: float = 0.0  # change of the torque constant [1]
    gap: float = 0.0  # further half width of the dead zone [rad]
    payload: float = 1.0  # factor of the inertia of the link [1]


HEALTHY = Wear()


@dataclass(frozen=True)
class DrawnJoint:
    """A joint of the study, healthy."""

    number: int
    experiment: Experiment

    def log(
        self, number: int, wear: Wear = HEALTHY, motion: int | None = None
    ) -> list[tuple[Together, Excitation]]:
        """Simulates one minute of the joint. Returns its estimates with UNKNOWN, and with EXACT.

        number  of the log, from which payload, temperature and noise follow
        motion  number of the motion; None: the motion follows from the number of the log, too
        """
        experiment = self._experiment(number, wear, motion)
        measured = run(experiment).measured
        phi = measured["q"] - measured["theta"]
        low, high = np.percentile(phi, _OUTLIERS).tolist()
        found = []
        for priors in (UNKNOWN, EXACT):
            # The configuration is the one of the healthy joint: nobody changes it.
            parameters = {**settings(self.experiment, TORQUE_GAIN), **priors}
            estimator = Estimator(parameters, _RECORDED, warn_of_range=False)
            sums = ExcitationSums(experiment.T)
            sums.add(estimator.run(**measured).values)
            estimates = together(estimator, [Reach(0.0, (low, high))])
            assert estimates is not None
            found.append((estimates, sums.excitation))
        return found

    def _experiment(self, number: int, wear: Wear, motion: int | None) -> Experiment:
        rng = np.random.default_rng([self.number, number, 7])
        warm = rng.uniform(-1.0, 1.0)
        payload = float(np.exp(rng.uniform(*np.log(_PAYLOAD))))
        seed, of_log = rng.integers(1, 2**31, 2).tolist()
        kind = self.experiment.joint
        of_motion = of_log if motion is None else 1000 * self.number + motion
        plant = dict(self.experiment.plant)
        friction = (1 + wear.friction) * (1 - FRICTION * warm)
        factors = {
            "link.M": payload * wear.payload,
            "spring.k_1": 1 + wear.spring,
            "motor.tau_coulomb": friction,
            "motor.D_theta": friction,
            "sensor.tau_gain": (1 + wear.gain) * (1 - TORQUE_CONSTANT * warm),
        }
        plant |= {name: factor * plant[name] for name, factor in factors.items()}
        plant["spring.gap"] += wear.gap
        return replace(
            self.experiment,
            plant=plant,
            drift={},
            duration=DURATION,
            seed=seed,
            torque=draw(kind, of_motion).torque,
        )


def drawn_joint(number: int) -> DrawnJoint:
    """Draws a joint; the kinds of joints take turns."""
    kind = KINDS[number % len(KINDS)]
    return DrawnJoint(number, all_misfits(draw(kind, 9000 + number)))
