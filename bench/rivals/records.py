"""What the joints hand to the methods, and what the methods return."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

# Relative standard deviations of the data sheets, as drawn, and as the methods are given them.
STD_B = 0.05
STD_D = 0.2
STD_GAIN = 0.015  # of the measured torque, which no log shows


@dataclass(frozen=True)
class Known:
    """What the owner of a joint knows about it. Values are data sheet values, so they are wrong."""

    gamma: float  # gear ratio
    B: float  # motor inertia on the motor's axis [kg.m2]
    D_theta: float  # viscous friction on the motor's axis [N.m.s/rad]
    tau_coulomb: float  # largest plausible Coulomb friction on the motor's axis [N.m]
    noise_tau: float  # standard deviation of the measured motor torque [N.m]
    counts_theta: int  # counts of the motor encoder per turn behind the gear
    counts_q: int  # counts of the link encoder per turn
    range_phi: float  # largest expected deformation [rad]
    range_tau_e: float  # largest expected torque of the spring [N.m]


@dataclass(frozen=True)
class JointLog:
    """One run of one joint. All arrays have one entry a sample."""

    kind: str  # series_elastic, variable_stiffness or arm
    seed: int
    sample_period: float  # [s]
    theta: Array  # measured motor position behind the gear [rad]
    q: Array  # measured link position [rad]
    tau: Array  # measured motor torque on the motor's axis [N.m]
    theta_c: Array  # measured position of the stiffness motor; 0 where there is none [rad]
    tau_e: Array  # true torque of the spring, which acts on the motor [N.m]
    stiffness: Array  # true slope d tau_e / d phi, phi = q - theta [N.m/rad]
    known: Known


@dataclass(frozen=True)
class Estimate:
    """The estimate of a method for a log. NaN where it has none."""

    stiffness: Array  # at every sample [N.m/rad]
    std: Array  # standard deviation [N.m/rad]; NaN: the method gives none
    confident: NDArray[np.bool_]
    seconds: float  # wall time of the estimation
