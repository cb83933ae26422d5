"""Defines the compared methods by name: methods of this package, and least squares.

All methods model the spring as an odd cubic polynomial in the deformation, because an owner does
not know whether a spring hardens. If the stiffness is variable, the coefficients are quadratic in
the position of the stiffness motor.
"""

import time
from collections.abc import Callable, Mapping

import numpy as np
from scipy import signal

import sigmahat
from rivals.records import STD_B, STD_D, STD_GAIN, Array, JointLog, RivalEstimate
from sigmahat.fmi.model import Value

CONFIDENT = 0.1
"""Least squares is confident while its standard deviation is below this share of a positive
stiffness, as FilteredRegression is at most."""
P_0 = 1e20  # initial covariance of Paper2011, as in the paper
SAMPLE = 1e7  # weight of a sample at the range of the deformation, relative to the start
ORDER = 4  # order of the Butterworth filter
DYNAMICS = 0.99  # share of the power of the motor velocity below the frequency of the dynamics
EDGE = 5  # rows that are dropped at both ends, where filters without lag have no past or no future
KNOWN = 2  # first columns of least squares, inertia and viscous friction, which a data sheet has
SPRING = 4  # its first column of the spring, after Coulomb friction and offset
N = 2  # number of the powers of the deformation


def _m(log: JointLog) -> int:
    """Returns the number of the powers of the position of the stiffness motor."""
    return 3 if log.theta_c.any() else 1


def _travel(log: JointLog) -> float:
    """Returns the travel of the stiffness motor in this log [rad], which an owner knows."""
    return float(np.abs(log.theta_c).max()) or 1.0


def _spring(log: JointLog, phi: Array) -> tuple[Array, Array]:
    """The functions x^(2i+1)/(2i+1) l^j, with x and l over their ranges, i below N, j below m; and
    their slopes by the deformation [1/rad]. Both [size: samples x N m]; a coefficient is a torque.
    """
    scale = log.known["range.phi"]
    x = phi / scale
    powers = [(log.theta_c / _travel(log)) ** j for j in range(_m(log))]
    torques = [x ** (2 * i + 1) / (2 * i + 1) * power for i in range(N) for power in powers]
    slopes = [x ** (2 * i) / scale * power for i in range(N) for power in powers]
    return np.column_stack(torques), np.column_stack(slopes)


def _filtered_regression(log: JointLog) -> RivalEstimate:
    """Estimates on line: the estimate at each sample depends only on samples up to then.

    Parameters are as docs/parameters.md advises: ranges, priors and noise are from the
    data sheet, and all others have start values.
    """
    known = {"prior.B": STD_B, "prior.D_theta": STD_D, "prior.torque_gain": STD_GAIN}
    return _on_line(log, {"method": "FilteredRegression", "range.setPoint": _travel(log), **known})


def _paper2011(log: JointLog) -> RivalEstimate:
    """Estimates on line by Paper2011, without standard deviation or confidence.

    F. Flacco, A. De Luca, I. Sardellitti, N. G. Tsagarakis, "Robust estimation of variable
    stiffness in flexible joints", Proc. IEEE/RSJ IROS 2011: residual (6), (8), kinematic Kalman
    filter (9) to (11), recursive least squares (14), (27). Its own parameters are those of the
    paper, which are the start values of the FMU, but for c of (27): with it the start P(0) counts
    as 1/(c P(0)) in units of the squares of the columns. The paper's columns go up to (100 mm)^2
    times 0.3 rad, so that a single sample counts 1e7 times as much as the start; c is such that a
    sample at the range of the deformation does so here, too.
    """
    c = SAMPLE / (P_0 * log.known["range.phi"] ** 2)
    found = _on_line(log, {"method": "Paper2011", "rls.P_0": P_0, "rls.c": c})
    nothing = np.full(len(log.theta), np.nan)
    return RivalEstimate(found.stiffness, nothing, np.zeros(len(nothing), bool), found.seconds)


def _on_line(log: JointLog, start: dict[str, Value]) -> RivalEstimate:
    """Runs the estimator of this package; `start` has the parameters of the method."""
    of_log = {"samplePeriod": log.sample_period, "rls.n": N, "rls.m": _m(log)}
    set_point = {"setPoint.offset": 0.0, "setPoint.scale": 1.0}
    estimator = sigmahat.Estimator(
        {**of_log, **set_point, **log.known, **start}, ("sigma", "sigma_std", "confident")
    )
    begin = time.perf_counter()
    found = estimator.run(log.theta, log.q, log.tau, log.theta_c)
    seconds = time.perf_counter() - begin
    return RivalEstimate(found["sigma"], found["sigma_std"], found["confident"], seconds)


def _least_squares(log: JointLog) -> RivalEstimate:
    """Ordinary least squares of the motor equation off line, IDIM-LS: the estimate of the whole
    log, the same at every sample but for the deformation.

        g^2 B theta'' + g^2 D theta' + g tau_c sign(theta') + offset - tau_e(phi) = g tau

    M. Gautier, "Dynamic identification of robots with power model", Proc. IEEE ICRA 1997,
    1922-1927; W. Khalil and E. Dombre, "Modeling, Identification and Control of Robots", Hermes
    Penton 2002, chapter 12: the variance of the error is from the residual, and the covariance from
    it and the information. The data sheet's inertia and viscous friction take part as two more rows
    with their own standard deviations, as a priori values do in M. Gautier and G. Venture,
    "Identification of standard dynamic parameters of robots with positive definite inertia matrix",
    Proc. IEEE/RSJ IROS 2013. The uncertainty of the torque gain is added to the standard deviation,
    because the stiffness is proportional to the gain.

    Filters follow Gautier, and A. Janot, P.-O. Vandanjon, M. Gautier, "A generic instrumental
    variable approach for industrial robot identification", IEEE Trans. Control Systems Technology
    22(1):132-145, 2014, section II: a Butterworth filter without lag with a corner at 10 times the
    frequency of the dynamics, central differences, and a low pass without lag (Chebyshev, order 8)
    at twice the frequency of the dynamics, through which both sides of the equation pass before
    most samples are dropped ("parallel decimation").
    """
    begin = time.perf_counter()
    X, y, slope = _regression(log)
    beta, covariance = _solve(X, y, log.known)
    stiffness = slope @ beta[SPRING:]
    variance = np.sum((slope @ covariance[SPRING:, SPRING:]) * slope, axis=1)
    std = np.hypot(np.sqrt(np.maximum(variance, 0.0)), STD_GAIN * stiffness)
    confident = np.isfinite(stiffness) & np.isfinite(std) & (std < CONFIDENT * stiffness)
    return RivalEstimate(stiffness, std, confident, time.perf_counter() - begin)


def _regression(log: JointLog) -> tuple[Array, Array, Array]:
    """X and y of the rows y = X beta + error of a log, beta = (B, D, tau_c, offset, coefficients of
    the spring); and the slope of the functions of the spring [size: samples x coefficients].

    Raises ValueError if the motor does not move.
    """
    T, g, f = log.sample_period, log.known["motor.gamma"], _dynamics(log)
    corner = min(10 * f * 2 * T, 0.8)
    butterworth = signal.butter(ORDER, corner, output="sos")
    theta, q = (signal.sosfiltfilt(butterworth, x) for x in (log.theta, log.q))
    theta_dot, (torque, slope) = np.gradient(theta, T), _spring(log, q - theta)
    columns = (
        *(g**2 * np.gradient(theta_dot, T), g**2 * theta_dot, g * np.sign(theta_dot)),
        *(np.ones(len(theta)), -torque, g * log.tau),
    )
    keep = max(int(0.8 / (2 * f * 2 * T)), 1)  # the low pass of a decimation is at 0.8 of Nyquist
    chebyshev = signal.cheby1(8, 0.05, 0.8 / keep, output="sos")
    rows = signal.sosfiltfilt(chebyshev, np.column_stack(columns), axis=0)[::keep][EDGE:-EDGE]
    return rows[:, :-1], rows[:, -1], slope


def _dynamics(log: JointLog) -> float:
    """Computes the frequency of the dynamics [Hz]. Raises ValueError if the motor does not move."""
    T, counts = log.sample_period, log.known["encoder.theta"]
    segment = min(len(log.theta), round(8 / T))
    f, density = signal.welch(log.theta, 1 / T, nperseg=segment, detrend="linear")
    std = 2 * np.pi / counts / np.sqrt(12)  # of the rounding of the encoder
    rounding = 2 * T * std**2  # white, one-sided density
    power = (2 * np.pi * f) ** 2 * np.where(density > 4 * rounding, density, 0.0)
    if not power.sum() > 0:
        raise ValueError("the motor does not move")
    share = np.cumsum(power) / power.sum()
    return float(f[np.searchsorted(share, DYNAMICS)])


def _solve(X: Array, y: Array, known: Mapping[str, float]) -> tuple[Array, Array]:
    """Computes coefficients and covariance. The variance of the rows follows from the residual."""
    scale = np.sqrt(np.mean(X**2, axis=0))
    X = X / scale
    mean, information = np.zeros(len(scale)), np.zeros(len(scale))  # of the data sheet
    mean[:KNOWN] = np.array([known["motor.B"], known["motor.D_theta"]]) * scale[:KNOWN]
    information[:KNOWN] = (np.array([STD_B, STD_D]) * mean[:KNOWN]) ** -2
    beta = np.linalg.lstsq(X, y)[0]
    for _ in range(2):  # the first residual is computed without the rows of the data sheet
        residual = y - X @ beta
        variance = residual @ residual / (len(y) - len(beta))
        precision = X.T @ X / variance + np.diag(information)
        beta = np.linalg.solve(precision, X.T @ y / variance + information * mean)
    return beta / scale, np.linalg.inv(precision) / np.outer(scale, scale)


Method = Callable[[JointLog], RivalEstimate]
METHODS: dict[str, Method] = {
    "FilteredRegression": _filtered_regression,
    "Paper2011": _paper2011,
    "least_squares": _least_squares,
}
