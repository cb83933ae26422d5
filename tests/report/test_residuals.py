"""The panels of the residual: white noise looks like it, and a model that fails shows where."""

import numpy as np
import pytest

from sigmahat.report.residuals import Residuals, autocorrelation, means, residuals

T, BANDWIDTH = 1e-3, 314.0
ROWS = 40_000


def found(more: float = 0.0, constant: float = 0.0) -> Residuals:
    """Residuals of a spring of 200 N.m/rad with white noise, and an unknown part phi^2."""
    rng = np.random.default_rng(7)
    t = np.arange(ROWS, dtype=np.float64) * T
    phi = 0.05 * np.sin(2.1 * t) + 0.02 * np.sin(11.3 * t)
    signals = {
        "phi": phi,
        "theta_dot": np.cos(3.7 * t),
        "tau_e": 200 * phi,
        "epsilon": rng.normal(0, 0.1, ROWS) + more * phi**2 + constant,
    }
    result = residuals(t, signals, np.ones(ROWS, np.bool_), BANDWIDTH)
    assert result is not None
    return result


def test_the_fit_is_that_of_the_second_half() -> None:
    result = found(constant=0.3)
    late = 200 * (result.signals["phi"])
    assert result.t[0] >= T * (ROWS // 2)
    assert pytest.approx(np.pi / BANDWIDTH, rel=0.05) == result.T
    assert result.fit == pytest.approx(100 * (1 - 0.1 / late.std()), abs=0.2)


def test_noise_is_within_the_bands() -> None:
    result = found()
    limit = 1.96 / np.sqrt(len(result.residual))
    assert np.mean(np.abs(autocorrelation(result.residual, 40)) > limit) < 0.15
    for signal in result.signals.values():
        _, mean, half = means(signal, result.residual)
        assert np.mean(np.abs(mean) > half) <= 0.15


def test_what_the_model_lacks_shows_over_its_signal() -> None:
    x, mean, half = means(found(more=100.0).signals["phi"], found(more=100.0).residual)
    ends = np.abs(x) > 0.04
    assert np.all(mean[ends] > half[ends])
    assert mean[ends].mean() == pytest.approx(100 * np.mean(x[ends] ** 2), rel=0.2)


def test_a_short_log_says_nothing() -> None:
    few = {name: np.zeros(300) for name in ("phi", "theta_dot", "tau_e", "epsilon")}
    assert residuals(np.linspace(0.0, 0.299, 300), few, np.ones(300, np.bool_), BANDWIDTH) is None
