"""Joints drawn at random, with all misfits at once.

They are for the last look: settings of a method are chosen without them. `LAST_LOOK` are the seeds
by which a finished method is judged, once; whoever works on a method uses other seeds.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from sigmahat.compare.misfits.experiment import Experiment
from sigmahat.compare.misfits.joints import AWAS, SEA_5K
from sigmahat.compare.misfits.motion import peak_deformation

LAST_LOOK = range(1001, 1101)
"""Seeds for the last look only: 100 joints of each kind."""


def other_joint(experiment: Experiment) -> Experiment:
    """Another joint of the kind, without misfits: other inertias, friction and stiffness."""
    rng = np.random.default_rng([experiment.seed, 1])
    inertia, friction, link, stiffness = np.exp(
        rng.standard_normal(4) * (0.25, 0.4, 0.3, 0.3)
    ).tolist()
    return experiment.scaled(
        {
            "motor.B": inertia,
            "motor.D_theta": friction,
            "link.M": link,
            "spring.k_s" if experiment.joint is AWAS else "spring.k_1": stiffness,
            "motor.tau_coulomb": 2 * rng.uniform(),
        }
    )


def all_misfits(experiment: Experiment) -> Experiment:
    """Another joint of the kind, with every misfit at once, each of a random size."""
    clean = other_joint(experiment)
    rng = np.random.default_rng([experiment.seed, 2])
    joint, peak = clean.joint, peak_deformation(clean)

    def normal(deviation: float) -> float:
        return deviation * float(rng.standard_normal())

    def uniform(most: float) -> float:
        return float(rng.uniform(0.0, most))

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
