"""`sigmahat identify`: the zero of the deformation, and a deformation that is noise."""

import math
from pathlib import Path

import numpy as np
import pytest

from recorded_logs import CONFIGURATION, Array, Columns, T, awas_log, write
from sigmahat.identification.coherence import coherent_range
from sigmahat.identification.identify import identify
from sigmahat.identification.noise import TorqueNoise
from sigmahat.identification.quantities import Identified
from sigmahat.identification.regression import Signals
from sigmahat.logs.configuration import read_configuration
from sigmahat.logs.log import LogInMemory
from sigmahat.logs.units import convert


@pytest.fixture
def path(tmp_path: Path) -> Path:
    path = tmp_path / "log.toml"
    path.write_text(CONFIGURATION)
    return path


def identified(log: Columns, path: Path) -> Identified:
    return identify(LogInMemory(Path("log"), log), read_configuration(path))


def test_the_zero_is_where_the_spring_has_no_torque(path: Path) -> None:
    log = awas_log(1.0, 0.3, 8.0)
    true, offset = log["q"], 15e-3
    log = {**log, "q": 0.5 - 2.0 * np.degrees(true + offset)}
    column = '"q"\nunit = "deg"\nsign = -1\nzero = 0.5\ngear_ratio = 2.0'
    path.write_text(CONFIGURATION.replace('"q"', column))
    found = identified(log, path)
    zero = found.quantities["zero"]
    assert zero.determined
    assert abs(zero.value - offset) <= zero.half_width < 5e-3
    assert found.phi == pytest.approx(np.max(np.abs(true - log["theta"])), abs=zero.half_width)
    assert "ports.q.zero" in write(found, path)
    q = convert("q", read_configuration(path).ports["q"], log["q"])
    assert np.max(np.abs(q - true)) <= zero.half_width
    # THEN a second run leaves it
    again = identified(log, path)
    assert again.zero == 0 and "ports.q.zero" not in write(again, path)


def motor(noise_of_phi: float) -> Signals:
    """A spring of 300 N.m/rad on a motor that follows two sines, and noise above 3 Hz in phi."""
    rng = np.random.default_rng(1)
    t = T * np.arange(20000)
    theta = np.sin(2 * np.pi * 0.7 * t)
    velocity = 2 * np.pi * 0.7 * np.cos(2 * np.pi * 0.7 * t)
    phi = 0.01 * np.sin(3.0 * t) + 0.01 * np.sin(2 * np.pi * 1.5 * t)
    acceleration = -((2 * np.pi * 0.7) ** 2) * theta
    tau = 2e-5 * 50 * acceleration + 1e-3 * 50 * velocity - 300 * phi / 50
    tau = tau + rng.normal(0, 3e-3, len(t))
    return Signals(theta, phi + rng.normal(0, noise_of_phi, len(t)), np.ones_like(t), tau, None)


def recorded(joint: Signals) -> Columns:
    t: Array = np.arange(len(joint.theta)) * np.float64(T)
    q = joint.theta + joint.phi
    return {"t": t, "theta": joint.theta, "q": q, "theta_c": 0 * t, "tau": joint.tau}


def test_with_a_wrong_sign_the_zero_stays(path: Path) -> None:
    log = awas_log(1.0, 0.3, 8.0)
    log = {**log, "q": 2 * log["theta"] - log["q"] + 15e-3}  # phi with the other sign
    found = identified(log, path)
    assert not found.quantities["zero"].determined
    assert "ports.q.zero" not in write(found, path)


def test_the_prior_holds_what_encoders_read_at_different_times_show(path: Path) -> None:
    # GIVEN a link encoder read 20 ms late: k times -20 ms times the velocity looks like friction
    late, log = 20, recorded(motor(0.0))
    q = log["q"]
    found = identified({**log, "q": np.concatenate([q[:late], q[:-late]])}, path)
    D_theta = found.quantities["D_theta"]
    assert not D_theta.determined
    assert D_theta.value == pytest.approx(1e-3 - 300 * late * T / 50**2, rel=0.05)
    write(found, path)
    prior = float(read_configuration(path).parameters["prior.D_theta"])
    assert prior > 1
    for end in D_theta.interval:
        assert abs(end - 1.2e-3) <= prior * 1.2e-3 * (1 + 1e-5)


@pytest.mark.parametrize(("noise_of_phi", "is_noise"), [(1e-7, False), (2e-3, True)])
def test_a_noisy_deformation_limits_the_bandwidth(noise_of_phi: float, is_noise: bool) -> None:
    equal_at_40_Hz = 9e-6 / (1e-3 * (2 * np.pi * 40) ** 2) ** 2
    noise = TorqueNoise(torque=9e-6, position=equal_at_40_Hz, inertia=1e-3, T=T)
    assert noise.bandwidth == pytest.approx(40.0)
    limit = coherent_range(motor(noise_of_phi), 50.0, noise)
    assert (limit < 6.0) if is_noise else limit == math.inf


def test_a_torque_that_is_late_does_not_look_like_friction(path: Path) -> None:
    # GIVEN a torque that acts 2 ms after it is recorded, and a spring that looks like friction then
    late, log = 2, recorded(motor(1e-7))
    found = identified({**log, "tau": np.roll(log["tau"], -late)}, path)
    for name, true in (("B", 2e-5), ("D_theta", 1e-3)):
        quantity = found.quantities[name]
        assert abs(quantity.value - true) <= quantity.half_width < 0.05 * true
