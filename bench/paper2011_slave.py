"""The estimator of the paper in numpy, exported by PythonFMU: (8)-(11), (21)-(27) as printed.

A direct implementation, as one would write it in an afternoon. PythonFMU copies only this file
into the FMU, so it imports nothing of the project. Start values are those of
StiffnessEstimator.fmu.
"""

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray
from pythonfmu import Fmi2Causality, Fmi2Slave, Real

T, B, D_theta, gamma, K_I = 1e-3, 2.3e-5, 1e-3, 50.0, 300.0
V_a, V_max, V_min, alpha, P_0 = 3e9, 10.0, 0.1, 6.0, 1.0
w_s = 2 * math.pi / 40000 / T
n, m, rls_P_0, c = 6, 3, 1e20, 1e-20
offset, scale = 100.0, -0.0025 / (2 * math.pi) * 1000

A = np.array([[1.0, T], [0.0, 1.0]])
Gamma = np.array([T**2 / 2, T])
Q = V_a * np.outer(Gamma, Gamma)
exponents = np.tile(2 * np.arange(n) + 1, m)
powers = np.repeat(np.arange(m), n)


class Paper2011(Fmi2Slave):  # type: ignore[misc]  # PythonFMU has no types
    """Inputs and outputs have the names of those of StiffnessEstimator.fmu."""

    def __init__(self, **kwargs: Any) -> None:
        super().__init__(**kwargs)
        for name in ("theta", "q", "theta_c", "tau", "tau_e_sensor"):
            setattr(self, name, 0.0)
            self.register_variable(Real(name, causality=Fmi2Causality.input))
        for name in ("sigma", "tau_e", "theta_dot"):
            setattr(self, name, 0.0)
            self.register_variable(Real(name, causality=Fmi2Causality.output))
        self.xi: NDArray[np.float64] | None = None
        self.P_xi = P_0 * np.eye(2)
        self.r = self.r_e = self.I_tau = self.tau_before = 0.0
        self.eta = np.zeros(n * m)
        self.P = rls_P_0 * np.eye(n * m)

    def do_step(self, current_time: float, step_size: float) -> bool:
        first = self.xi is None
        self.xi = np.array([self.theta, 0.0]) if self.xi is None else self.kalman(self.xi)
        self.residual(first, self.xi)
        self.regression()
        return True

    def kalman(self, before: NDArray[np.float64]) -> NDArray[np.float64]:
        xi = A @ before
        P = A @ self.P_xi @ A.T + Q
        R = (V_max - V_min) / (1 + math.exp((abs(xi[1]) / w_s - 1) * alpha)) + V_min
        K = P[:, 0] / (P[0, 0] + R)
        self.P_xi = P - np.outer(K, P[0])
        after: NDArray[np.float64] = xi + K * (self.theta - xi[0])
        self.theta_dot = float(after[1])
        return after

    def residual(self, first: bool, xi: NDArray[np.float64]) -> None:
        if not first:
            self.I_tau += (self.tau + self.tau_before) / 2 * T
        self.tau_before = self.tau
        r = K_I * (B * gamma * xi[1] + D_theta * gamma * xi[0] - self.I_tau)
        if not first:
            self.r_e = ((2 - T * K_I) * self.r_e + 2 * (r - self.r)) / (2 + T * K_I)
        self.r = r

    def regression(self) -> None:
        phi, set_point = self.q - self.theta, offset + scale * self.theta_c
        F = set_point**powers * phi**exponents
        PF = self.P @ F
        rho = F @ PF
        a = (c + c * rho) / (1 + c * rho)
        K = PF / (1 + rho)
        self.eta = self.eta + a * K * (gamma * self.r_e - F @ self.eta)
        self.P = self.P - a * np.outer(K, PF)
        self.tau_e = float(F @ self.eta)
        slope = exponents * set_point**powers * phi ** (exponents - 1)
        self.sigma = float(slope @ self.eta)
