"""Computes the frequency up to which the torque of the spring causes the deformation.

Above this frequency, the measured deformation consists of errors of gears, couplings and encoders.
In a regressor, these errors would make the stiffness too small.
"""

import itertools
import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

from sigmahat.motor import equation
from sigmahat.motor.equation import MOTOR, Equations, Form
from sigmahat.motor.log_view import LogView
from sigmahat.motor.noise import TorqueNoise
from sigmahat.motor.signals import Signals
from sigmahat.recording.log import Array

_FIRST = 5.0  # low pass of the fit from which the spectra are computed [Hz]
_SEGMENT = 2.0  # duration of a segment of a spectrum [s]
_LOWEST = 2.0  # [Hz]
_COHERENT = 0.5
_LARGER = 4.0  # least ratio of the power of the deformation to the power from the torque noise
_BUTTERWORTH = 1.11  # noise bandwidth of the low pass divided by its frequency
_HIDDEN = 0.5  # least ratio of the rounding variance to the residual variance of the deformation


@dataclass(frozen=True)
class PassBand:
    """Frequencies at which a log shows the motor equation."""

    noise: TorqueNoise
    coherent: float  # frequency above which the deformation is noise [Hz]; inf without noise

    def low_pass(self, T: float) -> float:
        """Returns the low pass of the equations [Hz], for samples T apart [s]."""
        return min(replace(self.noise, T=T).bandwidth, self.coherent)


def pass_band(view: LogView, has_sensor: bool) -> PassBand:
    """Finds the frequencies at which the longest stretch of a log shows the motor equation.

    has_sensor  whether a torque sensor replaces the spring or the motor
    """
    longest = view.longest
    noise = TorqueNoise.of(longest.tau, longest.theta, view.parameters, view.T)
    coherent = math.inf if has_sensor else coherent_range(longest, view.gamma, noise)
    return PassBand(noise, coherent)


def coherent_range(piece: Signals, gamma: float, noise: TorqueNoise) -> float:
    """Computes the frequency above which the deformation is noise [Hz]; inf without noise.

    The frequency is found in bands of half an octave. Above the frequency, the coherence of
    deformation and torque is below one half everywhere. At the frequency, the deformation has more
    power than the noise of the torque explains.
    """
    T, highest = noise.T, noise.bandwidth
    if highest <= _LOWEST or len(piece.theta) * T < 2 * _SEGMENT:
        return math.inf
    slow = Form(min(_FIRST, highest), min(_FIRST, highest))
    system = equation.equations([piece], T, gamma, slow)
    p = np.array(list(equation.fit(system).value.values()))
    motor = slice(len(MOTOR))
    rest = slice(len(MOTOR), None)
    torques, springs = [], []
    for even in equation.rows(piece, T, gamma, Form(highest, highest), system.units):
        torques.append(even.y[0] - even.X[0][:, motor] @ p[motor])
        springs.append(even.X[0][:, rest] @ p[rest])
    torque, spring = np.concatenate(torques), np.concatenate(springs)
    if not np.all(np.isfinite(torque) & np.isfinite(spring)):
        return math.inf
    frequency, shared, power = spectra(torque, spring, 2 * T)  # every second sample
    bands = math.ceil(2 * math.log2(highest / _LOWEST))
    limit = math.inf
    edges = np.geomspace(_LOWEST, highest, bands + 1)
    for low, high in reversed(list(itertools.pairwise(edges))):
        band = (frequency >= low) & (frequency < high)
        if not band.any() or np.mean(shared[band]) >= _COHERENT:
            break
        if np.mean(power[band]) > _LARGER * np.mean(noise.density(frequency[band])):
            limit = float(low)
    return limit


def spectra(x: Array, y: Array, h: float) -> tuple[Array, Array, Array]:
    """Computes frequencies [Hz], the coherence of two signals, and the one-sided density of y.

    Welch's method uses segments of two seconds with half overlap and Hann windows, without means.
    The module scipy.signal has this method too, but takes a second to import.

    x, y  signals of one size, samples h [s] apart, at least two seconds
    """
    segment = round(_SEGMENT / h)
    window = np.hanning(segment + 1)[:-1]
    of_x, of_y = (
        np.fft.rfft(window * (each - each.mean(axis=1, keepdims=True)))
        for each in (sliding_window_view(s, segment)[:: segment - segment // 2] for s in (x, y))
    )
    xx, yy = (np.mean(np.abs(each) ** 2, axis=0) for each in (of_x, of_y))
    frequency: Array = np.arange(segment // 2 + 1) / (segment * h)
    coherence: Array = np.abs(np.mean(of_x.conj() * of_y, axis=0)) ** 2 / (xx * yy)
    density: Array = 2 * h * yy / np.sum(window**2)
    return frequency, coherence, density


def is_hidden(system: Equations, f_0: float, T: float, noise: float, known: bool) -> bool:
    """Returns whether the deformation is a function of the motor motion, apart from rounding. Such
    a log shows only the sum of inertia, friction and load.

    An example is a free load in one slow sine: the spring torque looks like an added inertia.

    system  the equations, see plain_equations()
    f_0, T  low pass of the equations [Hz], and the time between samples [s]
    noise   variance of the rounding of the deformation [rad2]
    known   whether the inertia is known
    """
    names = [*MOTOR[int(known) :], *equation.eta(2, 1)]  # the spring is a constant and a slope
    R = system.only(names).factor()
    others, spring = R[:, :-2], R[:, -2]  # the last one is y
    left = spring - others @ np.linalg.lstsq(others, spring, rcond=None)[0]
    variance = float(left @ left) / int(system.rows.sum()) * system.units[0] ** 2
    share = min(1.0, _BUTTERWORTH * 4 * f_0 * T)  # share of white noise in every second sample
    return bool(noise * share > _HIDDEN * variance)
