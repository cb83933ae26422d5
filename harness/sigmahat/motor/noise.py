"""Computes the noise of the signals of a log, and the low pass of the motor equation."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from sigmahat.fmi.model import Value
from sigmahat.recording.log import Array

_WINDOWS = 40
_ONLY_NOISE = 1.2  # largest ratio of signal variance to noise variance of a signal without motion
_LOWEST = 5.0  # [Hz]
_HIGHEST = 0.1  # highest bandwidth divided by the sampling frequency
_MOST_REFLECTIONS = 40
SETTLED = 8.0  # periods of the low pass after which a step response has decayed to 1e-15


def variance(values: Array, resolution: float = 0.0) -> float:
    """Computes the variance of the white noise of a signal, in the squared unit of the signal.

    values      samples at even times, finite
    resolution  step of the encoder, or 0; rounding is noise with a variance of at least step^2/12

    Fourth differences remove a motion that is slow compared with the sampling. Fourth differences
    of white noise have 70 times the variance of the noise. The median over windows ignores jumps.
    """
    windows = np.array_split(np.diff(values, 4), min(_WINDOWS, max(1, len(values) // 50)))
    noise = float(np.median([np.mean(window**2) for window in windows])) / 70
    return max(noise, resolution**2 / 12)


def is_only_noise(values: Array) -> bool:
    """Returns whether a signal is constant apart from white noise, as a torque without current."""
    return float(np.var(values)) <= _ONLY_NOISE * variance(values)


def count(parameters: Mapping[str, Value], encoder: str = "theta") -> float:
    """Computes the angle of one encoder count [rad] from all parameters; 0 without an encoder."""
    counts = float(parameters[f"encoder.{encoder}"])
    return 2 * math.pi / counts if counts else 0.0


@dataclass(frozen=True)
class TorqueNoise:
    """White noise of torque and position of a motor, as a torque on the motor's axis."""

    torque: float  # variance [(N.m)2]
    position: float  # variance, rounding included [rad2]
    inertia: float  # torque per acceleration, B gamma [kg.m2]
    T: float  # time between samples [s]

    @staticmethod
    def of(tau: Array, theta: Array, parameters: Mapping[str, Value], T: float) -> TorqueNoise:
        """Computes the noise of the signals of a motor, with all parameters of the estimator."""
        inertia = float(parameters["motor.B"]) * abs(float(parameters["motor.gamma"]))
        return TorqueNoise(variance(tau), variance(theta, count(parameters)), inertia, T)

    @property
    def bandwidth(self) -> float:
        """Frequency above which a twice differentiated position is noisier than the torque [Hz].

        The sum of both noises is almost white below this frequency. At higher frequencies, the
        weight 1/(1 + (f/f_0)^4) attenuates the noise, as a Butterworth filter of second order.
        """
        highest = _HIGHEST / self.T
        if self.position <= 0.0:
            return highest
        ratio = self.torque / (self.inertia**2 * self.position)
        return min(max(math.sqrt(math.sqrt(ratio)) / (2 * math.pi), _LOWEST), highest)

    def density(self, f: Array) -> Array:
        """Computes the one-sided power spectral density [(N.m)2/Hz] at the frequencies f [Hz]."""
        by_position = (self.inertia * (2 * math.pi * f) ** 2) ** 2 * self.position
        return 2 * self.T * (self.torque + by_position)


def low_pass(values: Array, frequency: float, h: float) -> Array:
    """Applies a Butterworth filter of second order forward and backward, without phase shift.

    values     samples along the first axis, h [s] apart; beyond both ends the samples are
               continued by point reflection
    frequency  cut-off frequency, with a gain of 1/sqrt(2) per pass [Hz], less than 1/(2 h)

    The gain is equal to the filter of scipy.signal (bilinear), which takes a second to import.
    """
    # A filter that is slower than the samples sees only the reflections: more of them add nothing.
    settled = min(math.ceil(SETTLED / (frequency * h)), _MOST_REFLECTIONS * len(values))
    ends = [(settled, settled), *[(0, 0)] * (values.ndim - 1)]
    padded = np.pad(values, ends, mode="reflect", reflect_type="odd")
    # The size is a product of small primes, for which the Fourier transform is fast.
    size = min(m << math.ceil(math.log2(len(padded) / m)) for m in (1, 3, 5, 9))
    spectrum = np.fft.rfft(padded, size, axis=0)
    relative = np.tan(np.pi * np.fft.rfftfreq(size)) / math.tan(math.pi * frequency * h)
    spectrum /= (1 + relative**4).reshape(-1, *[1] * (values.ndim - 1))
    return np.fft.irfft(spectrum, size, axis=0)[settled : settled + len(values)]
