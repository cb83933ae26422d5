"""What the estimator is given of a joint."""

from __future__ import annotations

from sigmahat.compare.misfits.experiment import Experiment
from sigmahat.fmi.instance import Value


def settings(experiment: Experiment, torque_gain: float) -> dict[str, Value]:
    """Start values of StiffnessEstimator, with method FilteredRegression.

    torque_gain  prior standard deviation of the gain of the measured torque [1]
    """
    joint, plant, errors = experiment.joint, experiment.plant, experiment.errors
    given: dict[str, Value] = {
        "method": "FilteredRegression",
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
        # What is known of the kind of joint, not of this one, whose friction may be another.
        "prior.tau_coulomb": joint.plant["motor.tau_coulomb"],
        "prior.torque_gain": torque_gain,
        "regression.bandwidth": 350.0,
    }
    return {**given, **experiment.estimator}
