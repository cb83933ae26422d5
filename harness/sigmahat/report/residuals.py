"""Shows where a model fails: the predicted and the measured torque, and the residual.

The torque of every tick is predicted before the estimator uses this tick. So the second
half of a log is a test set: no sample was known when its torque was predicted.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sigmahat.result.curve import NORMAL_95
from sigmahat.show.panel import COLORS, TRUE, Panel, Trace
from sigmahat.show.style import QUANTITIES, around, plain_axis

Array = NDArray[np.float64]

_SHOWN = 600  # samples of the torque over time
_LAGS, _BINS = 40, 20
_FEWEST = 200  # independent residuals
_OVER = ("phi", "theta_dot", "tau_e")  # signals with which the residual is compared


@dataclass(frozen=True)
class Residuals:
    """Samples of the second half of a log, one in each period of the estimator filters."""

    T: float  # time between the samples [s]
    t: Array  # [s]
    residual: Array  # measured torque minus predicted torque [N.m]
    signals: Mapping[str, Array]  # signals _OVER, at the same times

    @property
    def fit(self) -> float:
        """1 - |residual| / |measured torque less its mean| (normalised RMS error) [%]."""
        measured = self.signals["tau_e"] + self.residual
        return 100 * (1 - float(np.std(self.residual) / np.std(measured)))


def residuals(
    t: Array, signals: Mapping[str, NDArray[Any]], used: NDArray[np.bool_], bandwidth: float
) -> Residuals | None:
    """Computes the residuals of a log; None if the second half is too short.

    signals    outputs of the estimator at the times t: epsilon and _OVER
    used       whether the estimator used the sample
    bandwidth  of its filters [rad/s]: samples within half a period of it are not independent
    """
    rows = np.flatnonzero(used & (np.arange(len(t)) >= len(t) // 2))
    if len(rows) < 2:
        return None
    step = float(np.median(np.diff(t)))
    stride = max(1, round(np.pi / bandwidth / step)) if step > 0 else 1
    rows = rows[::stride]
    if len(rows) < _FEWEST:
        return None
    every = {name: np.asarray(signals[name], np.float64)[rows] for name in (*_OVER, "epsilon")}
    return Residuals(stride * step, t[rows], every.pop("epsilon"), every)


def residual_panels(found: Residuals) -> Iterator[Panel]:
    """The torque over time, autocorrelation of the residual, and its mean against each signal."""
    predicted, torque = found.signals["tau_e"], QUANTITIES["tau_e"]
    shown, panel = slice(-_SHOWN, None), partial(Panel, linked=False)
    yield panel(
        "Torque, measured and predicted before it was known",
        plain_axis("t"),
        plain_axis("tau_e"),
        [
            Trace("measured", TRUE, found.t[shown], (predicted + found.residual)[shown], width=2.4),
            Trace("predicted", COLORS[0], found.t[shown], predicted[shown]),
        ],
        caption=f"fit {found.fit:.1f} % in the second half of the log",
    )
    lags = found.T * np.arange(1, _LAGS + 1)
    limit = NORMAL_95 / np.sqrt(len(found.residual))
    yield panel(
        "Autocorrelation of the residual",
        "lag [s]",
        "correlation [1]",
        [
            Trace("residual", COLORS[0], lags, autocorrelation(found.residual, _LAGS)),
            Trace(
                "no correlation", TRUE, lags, np.zeros(_LAGS),
                band=(np.full(_LAGS, -limit), np.full(_LAGS, limit)),
            ),
        ],
        caption="band: 95 % of the correlations of white noise",
    )  # fmt: skip
    for name in _OVER:
        x, mean, half = means(found.signals[name], found.residual)
        yield panel(
            f"Residual against {QUANTITIES[name].words}",
            plain_axis(name),
            f"residual [{torque.unit.replace('.', '·')}]",
            [
                Trace("mean", COLORS[0], x, mean, band=(mean - half, mean + half)),
                Trace("0", TRUE, x, np.zeros(len(x))),
            ],
            caption="band: 95 %; where the band does not contain 0, the model fails",
            y_range=around([mean - half, mean + half], 0.1),
        )


def autocorrelation(x: Array, lags: int) -> Array:
    """Computes the autocorrelation of a signal for lags of 1 to `lags` samples [size: lags]."""
    x = x - x.mean()
    power = float(np.mean(x**2)) or 1.0
    return np.array([np.mean(x[k:] * x[:-k]) / power for k in range(1, lags + 1)])


def means(x: Array, y: Array) -> tuple[Array, Array, Array]:
    """Computes means of y in bins of x with equal counts, and half of the 95 % intervals."""
    order = np.argsort(x, kind="stable")
    bins = np.array_split(order, _BINS)
    center = np.array([x[each].mean() for each in bins])
    mean = np.array([y[each].mean() for each in bins])
    std = np.array([y[each].std(ddof=1) / np.sqrt(len(each)) for each in bins])
    return center, mean, NORMAL_95 * std
