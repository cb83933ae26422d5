"""The torque of a spring as a linear combination of given functions, which all methods share.

It is the odd cubic polynomial in the deformation, because an owner does not know whether a spring
hardens. Where the stiffness is variable, its coefficients are quadratic in the position of the
stiffness motor.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from rivals.records import Array, JointLog


@dataclass(frozen=True)
class Spring:
    """tau_e = sum of c_ij x^(2i+1)/(2i+1) l^j with x, l over their ranges; i below n, j below m."""

    n: int
    m: int
    range_phi: float  # [rad]
    range_theta_c: float  # [rad]

    def torque(self, phi: Array, theta_c: Array) -> Array:
        """The functions [size: samples x n m]. A coefficient is a torque [N.m]."""
        x = phi / self.range_phi
        return self._products([x ** (2 * i + 1) / (2 * i + 1) for i in range(self.n)], theta_c)

    def slope(self, phi: Array, theta_c: Array) -> Array:
        """Their derivatives with respect to the deformation [size: samples x n m], [1/rad]."""
        x = phi / self.range_phi
        return self._products([x ** (2 * i) / self.range_phi for i in range(self.n)], theta_c)

    def _products(self, of_phi: list[Array], theta_c: Array) -> Array:
        r = theta_c / self.range_theta_c
        return np.column_stack([p * r**j for p in of_phi for j in range(self.m)])


def spring(log: JointLog) -> Spring:
    """The spring of a log.

    The range of the stiffness motor is its travel in this log: an owner knows it.
    """
    travel = float(np.abs(log.theta_c).max())
    m = 3 if travel > 0 else 1
    return Spring(2, m, log.known.range_phi, travel if travel > 0 else 1.0)
