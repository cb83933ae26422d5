"""`sigmahat identify` selects powers of the deformation for symmetric and asymmetric springs."""

from pathlib import Path

import numpy as np
import pytest

from foreign_joint import GEAR, STIFFNESS, T, joint
from recorded_logs import Array, configured, in_memory, write
from sigmahat.checks.check import check
from sigmahat.checks.findings import Kind
from sigmahat.motor.identify import identify
from sigmahat.recording.configuration import read_configuration
from sigmahat.recording.log import LogInMemory
from sigmahat.result.estimate import estimate

COUNTS = 2**17
STIFFER = 4.0  # relative slope of the stiffness over the deformation [1/rad]
CONFIGURATION = configured(
    *(f"samplePeriod = {T}", f"motor.gamma = {GEAR}", "motor.B = 1e-4", "motor.D_theta = 1e-3"),
    *("prior.B = 1.0", "prior.D_theta = 1.0", "prior.torque_gain = 0.0", "rls.m = 1"),
    *(f"encoder.theta = {COUNTS}", f"encoder.q = {COUNTS}"),
)
ODD = "rls.symmetric = true\n"


def log_of(stiffer: float, seed: int) -> LogInMemory:
    m, rng = joint(False, 12.0, stiffer), np.random.default_rng(seed)
    step = 2 * np.pi / COUNTS
    columns = {"t": m.t, "tau": m.tau + 2e-3 * rng.standard_normal(len(m.t))}
    columns |= {"theta": step * np.round(m.theta / step), "q": step * np.round(m.q / step)}
    return LogInMemory(Path("log"), columns)


def within(log: LogInMemory, path: Path, stiffer: float) -> tuple[Array, Array]:
    """Relative error and standard deviation of the stiffness in the measured range.

    `identify` completes the configuration before the estimate.
    """
    write(identify(log, read_configuration(path)), path)
    (branch,) = estimate(log, read_configuration(path)).curve.branches
    assert branch.sigma_std is not None
    true = STIFFNESS * (1 + stiffer * branch.phi[branch.within])
    error = np.abs(branch.sigma[branch.within] - true) / true
    return error, branch.sigma_std[branch.within] / true


@pytest.fixture
def path(tmp_path: Path) -> Path:
    path = tmp_path / "log.toml"
    path.write_text(CONFIGURATION)
    return path


def test_a_spring_that_is_softer_to_one_side(path: Path) -> None:
    log = log_of(STIFFER, 1)
    error, std = within(log, path, STIFFER)
    assert np.mean(error <= 1.96 * std) >= 0.9
    assert np.max(error) < 0.05
    # WHEN the user asks for odd powers only, THEN the intervals miss the stiffness at more places.
    path.write_text(CONFIGURATION + ODD)
    error, std = within(log, path, STIFFER)
    assert read_configuration(path).parameters["rls.symmetric"]
    assert np.mean(error <= 1.96 * std) < 0.9


def test_a_linear_spring_hardly_loses(path: Path) -> None:
    """GIVEN a linear spring, THEN all powers make the confidence band at most 10 % wider than odd
    powers do."""
    widths = {}
    for name, text in (("all", CONFIGURATION), ("odd", CONFIGURATION + ODD)):
        path.write_text(text)
        error, std = within(log_of(0.0, 2), path, 0.0)
        assert np.mean(error <= 1.96 * std) >= 0.9
        widths[name] = float(np.mean(std))
    assert widths["all"] <= 1.1 * widths["odd"]


@pytest.mark.parametrize(("stiffer", "is_named"), [(0.0, False), (STIFFER, True)])
def test_check_names_an_asymmetric_spring(stiffer: float, is_named: bool) -> None:
    # THEN `check` no longer reports an asymmetric spring once the polynomial has all powers.
    for text, names in (("", is_named), ("rls.symmetric = false\n", False)):
        found = check(log_of(stiffer, 3), in_memory(CONFIGURATION + text)).findings
        named = [each for each in found if each.kind is Kind.ASYMMETRY]
        assert [(each.key, each.proposed) for each in named] == [("rls.symmetric", False)] * names
