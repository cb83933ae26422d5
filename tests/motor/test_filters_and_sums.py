"""Filters of `identify` equal scipy.signal, and fits to sums equal fits to rows of equations."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.signal import butter, coherence, sosfiltfilt, welch

from recorded_logs import Array
from sigmahat.motor.coherence import spectra
from sigmahat.motor.equation import (
    MOTOR,
    Form,
    equations,
    fit,
    left_out,
    rows,
)
from sigmahat.motor.identify import _apart
from sigmahat.motor.noise import low_pass
from sigmahat.motor.signals import Signals, units


@pytest.mark.parametrize(("frequency", "h"), [(5.0, 1e-3), (100.0, 1e-3), (1.2, 1e-2)])
def test_the_low_pass_is_that_of_scipy(frequency: float, h: float) -> None:
    walk: Array = np.cumsum(np.random.default_rng(1).standard_normal((5000, 2)), axis=0)
    expected = sosfiltfilt(butter(2, 2 * h * frequency, output="sos"), walk, axis=0)
    inner = slice(round(5 / frequency / h), -round(5 / frequency / h))
    found = low_pass(walk, frequency, h)
    assert found[inner] == pytest.approx(expected[inner], abs=1e-6)
    assert low_pass(walk[:, 0], frequency, h) == pytest.approx(found[:, 0], abs=1e-9)
    line = np.arange(50, dtype=np.float64)  # a line passes the filter unchanged
    assert low_pass(line, frequency, h) == pytest.approx(line, abs=1e-9)


def test_the_spectra_are_those_of_scipy() -> None:
    noise = np.random.default_rng(1).standard_normal((2, 5003))
    x, y = noise[0], np.convolve(noise[0], [0.2, 0.5, 0.3], "same") + 0.3 * noise[1]
    frequency, shared, power = spectra(x, y, 2e-3)
    expected, expected_shared = coherence(x, y, 500.0, nperseg=1000)
    assert frequency == pytest.approx(expected)
    assert shared[1:-1] == pytest.approx(expected_shared[1:-1], rel=1e-9)
    assert power[1:-1] == pytest.approx(welch(y, 500.0, nperseg=1000)[1][1:-1], rel=1e-9)


T, GAMMA, FORM = 1e-3, 50.0, Form(20.0, 50.0, n=2, load_friction=True)


def piece(count: int, seed: int) -> Signals:
    random = np.random.default_rng(seed)
    t = T * np.arange(count)
    theta = np.sin(5 * t) + 1e-4 * random.standard_normal(count)
    phi = 0.02 * np.sin(5 * t + 1) + 1e-5 * random.standard_normal(count)
    tau = 1e-3 * np.cos(5 * t) - 0.3 * phi + 0.01 * random.standard_normal(count)
    return Signals(theta, phi, np.ones(count), tau, None)


def test_a_fit_to_sums_is_a_fit_to_rows() -> None:
    pieces = [piece(9001, 1), piece(4400, 2)]
    found = fit(equations(pieces, T, GAMMA, FORM))
    # GIVEN a fit to all rows of the equations instead of a fit to sums
    every = [each for p in pieces for each in rows(p, T, GAMMA, FORM, units(pieces))]
    y, X, Z = (
        np.concatenate([np.concatenate(part) for part in parts])
        for parts in ([e.y for e in every], [e.X for e in every], [e.Z for e in every])
    )
    p = np.linalg.solve(Z.T @ X, Z.T @ y)
    # THEN both fits are equal, except for the rounding error of the sums Z'X
    scale = np.sqrt(np.mean(X**2, axis=0))
    rounding = 100 * np.finfo(np.float64).eps * np.linalg.cond((Z / scale).T @ (X / scale))
    assert rounding < 1e-5
    assert list(found.value.values()) == pytest.approx(p.tolist(), rel=rounding)
    assert found.squares.sum() == pytest.approx(np.sum((y - X @ p) ** 2), rel=1e-6)
    # AND the covariance follows from sums of Z times error over blocks of a quarter of a second
    scores = []
    for each in every:
        errors = each.Z * (each.y - each.X @ p)[..., None]
        first = [0, *(np.flatnonzero(np.diff(each.place // 125)) + 1)]
        scores.append(np.add.reduceat(errors.sum(axis=0), first))
    S = np.concatenate(scores)
    inverse = np.linalg.inv(Z.T @ X)
    expected = inverse @ S.T @ S @ inverse.T * len(S) / (len(S) - len(p))
    assert found.covariance == pytest.approx(expected, rel=rounding)


def test_a_known_coefficient_and_parts_that_are_left_out() -> None:
    system = equations([piece(9001, 1)], T, GAMMA, FORM)
    free = fit(system)
    known = fit(system.known("B", free.value["B"]))
    rest = {name: value for name, value in free.value.items() if name != "B"}
    assert known.value == pytest.approx(rest, rel=1e-9)
    eighths = system.in_parts(8)
    assert eighths.rows.sum() == system.rows.sum()
    assert fit(system).squares.sum() / system.rows.sum() < left_out(eighths).mean()


# ---- a slow motor, whose rounding errors are not independent from sample to sample ---------------


GEAR, K, COUNT, B, D_THETA = 160.0, 2400.0, 2 * np.pi / 16384, 1.3e-4, 6e-4


def recording(seed: int, noise: float) -> Signals:
    """Simulates 40 s of a joint with a linear spring and noise of the torque [N.m]."""
    rng, t = np.random.default_rng(seed), T * np.arange(40_000)
    w, amplitude = 2 * np.pi * np.array([0.35, 0.8, 1.7]), np.array([0.025, 0.015, 0.0075])
    angle = np.outer(t, w) + rng.uniform(0, 2 * np.pi, 3)
    theta = np.sin(angle) @ amplitude
    motor = B * -np.sin(angle) @ (amplitude * w**2) + D_THETA * np.cos(angle) @ (amplitude * w)
    phi = 0.01 * np.sin(2 * np.pi * 0.23 * t + 1) + 0.006 * np.sin(2 * np.pi * 1.1 * t)
    tau: Array = GEAR * motor - K * phi / GEAR + noise * rng.standard_normal(len(t))
    motor_angle, link_angle = (np.round(x / COUNT) * COUNT for x in (theta, theta + phi))
    return Signals(motor_angle, link_angle - motor_angle, np.zeros(len(t)), tau, None)


@pytest.mark.parametrize(("f_0", "noise"), [(20.0, 0.02), (100.0, 0.19)])
def test_the_interval_of_the_inertia_holds_it(f_0: float, noise: float) -> None:
    """GIVEN a motion of 0.3 counts per sample, THEN a fit to samples that are two counts apart has
    an interval that contains B. A fit to all samples underestimates B with a small interval."""
    held = {1: 0, 5: 0}
    for seed in range(12):
        piece = recording(seed, noise)
        assert _apart([piece], COUNT) == 5
        for apart in held:
            form = Form(min(f_0, 0.25 / (apart * T)), min(2.5 * f_0, 0.1 / (apart * T)))
            found = fit(equations([piece[::apart]], apart * T, GEAR, form))
            held[apart] += abs(found.value["B"] - B) <= found.half_width["B"]
    assert held[5] >= 9
    assert held[1] <= 2


def test_a_motor_that_moves_fast_or_rests_keeps_all_samples() -> None:
    piece = recording(1, 0.02)
    at_rest = replace(piece, theta=np.zeros(len(piece.theta)))
    for moves, count in ((piece, COUNT / 10), (at_rest, COUNT), (piece, 0.0)):
        assert _apart([moves], count) == 1


def test_a_torque_that_is_held_acts_half_a_sample_later() -> None:
    """A fit with a held torque equals a fit with the sampled torque, even to every 20th sample."""
    t = T * np.arange(40001)
    theta, phi = np.sin(5 * t) + 0.3 * np.sin(13 * t), 0.02 * np.sin(7 * t + 1)
    torque = np.cos(5 * t) - 2 * np.sin(13 * t) - 0.3 * phi
    held = (torque[:-1] + torque[1:]) / 2  # mean torque between two samples
    at_samples = Signals(theta[:-1], phi[:-1], np.ones(40000), torque[:-1], None)
    recorded = replace(at_samples, tau=held, held=True)
    for apart in (1, 20):
        fits = [
            fit(equations([each.with_acting_torque()[::apart]], apart * T, GAMMA, Form(2.0, 5.0)))
            for each in (at_samples, recorded)
        ]
        expected, found = ([each.value[name] for name in MOTOR] for each in fits)
        assert found == pytest.approx(expected, rel=1e-4)
