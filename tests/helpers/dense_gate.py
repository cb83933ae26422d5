"""Which samples FilteredRegression accepts, in numpy: section 14 of docs/filtered-regression/."""

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from c_library import Array
from dense_signals import SENSOR, Parameters, resolution


class Signal:
    """One of the signals; numbers with `at` are indices of samples."""

    def __init__(self, x: Array, straight: bool, scale: float, least: float) -> None:
        self.x, self.straight, self.scale, self.least = x, straight, scale, least
        self.slope = self.peak = self.jump = 0.0
        self.last_at = 0

    def begin(self, at: int, slope: float) -> None:
        self.last_at, self.slope, self.jump = at, slope, 0.0

    def accepts(self, at: int, learns: bool, largest: float, T: float) -> bool:
        """The prediction is a line through the last two accepted samples, or the last sample."""
        x, since = self.x, at - self.last_at
        error = abs(x[at] - x[self.last_at] - since * self.slope)
        if error <= max(10 * self.peak, self.scale if learns else self.least):
            self.peak = max(self.peak * (1 - T / 60), error)
            slope = (x[at] - x[self.last_at]) / since
        else:
            if since == 1 and not learns:
                self.jump = error
            if since * T < 0.12 or abs(x[at]) > largest:
                return False
            self.peak = max(self.peak, self.jump / 5)
            slope = x[at] - x[at - 1]
        self.begin(at, slope if self.straight else 0.0)
        return bool(abs(x[at]) <= largest)


class Gate:
    """The gate of a run with one modality."""

    def __init__(self, p: Parameters, z: Array, modality: int) -> None:
        self.T = p["samplePeriod"]
        gamma, phi = abs(p["motor.gamma"]), p["range.phi"]
        load = p["prior.tau_e"] + self.nominal(p)
        counts = [4 * resolution(p[f"encoder.{name}"]) for name in ("theta", "q")]
        moved = min(load / (p["motor.B"] * gamma**2) * self.T**2, phi)
        measured = modality == SENSOR
        torque = load if measured else load / gamma + p["prior.tau_coulomb"]
        noise = 10 * p["noise.tau_e" if measured else "noise.tau"]
        set_point = 100 - 2.5 / (2 * math.pi) * z[:, 2] - p["range.setPoint_center"]
        self.signals = {
            Signal(z[:, 0], True, phi, counts[0] + moved): math.inf,
            Signal(z[:, 1] - z[:, 0], True, phi, sum(counts) + moved): 1000 * phi,
            Signal(z[:, 4 if measured else 3], False, torque + noise, torque / 2 + noise): (
                1000 * torque + noise
            ),
        }
        if p["rls.m"] > 1:
            largest = p["range.setPoint"]
            self.signals[Signal(set_point, True, largest, largest)] = math.inf
        self.good = 0  # samples
        self.last_at = -1  # of the last call

    def nominal(self, p: Parameters) -> float:
        """Torque of the nominal curve at range.phi, plus its stiffness there times range.phi."""
        torque = slope = 0.0
        for (i, j), value in np.ndenumerate(p.get("rls.eta_0", [])):
            power = 2 * i + 1 if p["rls.symmetric"] else i
            term = value * 100**j * p["range.phi"] ** power
            torque, slope = torque + term, slope + power * term
        return abs(torque) + abs(slope)

    def accepts(self, at: int) -> bool:
        missing, self.last_at = at - self.last_at - 1, at
        if missing:
            self.good = 0
        learns = self.good < 20 or self.good * self.T < 0.1
        accepted = True
        for signal, largest in self.signals.items():
            if self.good == 0:
                signal.begin(at, 0.0)
                accepted &= abs(signal.x[at]) <= largest
            elif self.good == 1 and signal.straight:
                signal.begin(at, signal.x[at] - signal.x[signal.last_at])
                accepted &= abs(signal.x[at]) <= largest
            else:
                accepted &= signal.accepts(at, learns, largest, self.T)
        self.good += accepted
        return bool(accepted)


def accepted(p: Parameters, z: Array, modality: NDArray[Any]) -> NDArray[np.bool_]:
    """Whether each sample is accepted [size: ticks]. A new modality begins with a new gate."""
    good: NDArray[np.bool_] = np.all(np.isfinite(z), axis=1)
    gate, used = Gate(p, z, modality[0]), modality[0]
    for at in map(int, np.flatnonzero(good)):
        if modality[at] != used:
            gate, used = Gate(p, z, modality[at]), modality[at]
            gate.last_at = at - 1
        good[at] = gate.accepts(at)
    return good
