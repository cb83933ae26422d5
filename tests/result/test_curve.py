"""Tests of the estimated curve of torque and stiffness: its confidence band and its range."""

import csv
import json
import re
from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from command_line import working_in
from recorded_logs import (
    CONFIGURATION,
    REGRESSION,
    Array,
    Columns,
    awas_log,
    configured,
    in_memory,
    recorded,
    write_log,
)
from regression_joint import STIFFNESS, HardeningJoint, MisfitJoint, hardening
from sigmahat import Estimator
from sigmahat.cli import main
from sigmahat.recording.configuration import read_configuration
from sigmahat.recording.log import LogInMemory
from sigmahat.recording.readers.formats import open_log
from sigmahat.result.curve import (
    CURVE,
    Branch,
    Curve,
    curve_text,
    nearest,
    polynomial_in_words,
    read_curve,
)
from sigmahat.result.curve_of_log import POINTS, MeasuredPoints, reaches, read_points
from sigmahat.result.estimate import Estimate, estimate
from sigmahat.result.headline import Confidence, headline
from sigmahat.result.log_panels import curve_panels
from sigmahat.result.sheet import Polynomial, start_of, with_knees
from sigmahat.result.stored import LearnedLog

GAIN = 0.02
"""Standard deviation of the gain of the torque, the default of prior.torque_gain."""
CLOSED_FORM = configured(
    *("motor.B = 2.3e-5", "motor.D_theta = 1e-3", "motor.gamma = 50", "samplePeriod = 0.001"),
    *("prior.B = 0.05", "prior.tau_coulomb = 0.02", "prior.tau_e = 20", "noise.tau = 1e-3"),
    *("encoder.theta = 262144", "encoder.q = 262144", "range.phi = 0.1", "range.setPoint = 1.2"),
    *("setPoint.offset = 0", "setPoint.scale = 1", "rls.n = 2", "rls.m = 2"),
    ports=("theta", "q", "theta_c", "tau"),
)


def estimated(columns: Columns, configuration: str, folder: Path) -> Estimate:
    log = open_log(write_log(columns, folder / "log.parquet", configuration))
    with working_in(folder):
        return estimate(log, read_configuration(folder / "log.toml"), folder)


def good_log(joint: MisfitJoint, gain: float = 1.0) -> Columns:
    """A log with accurate sensors, except for the gain of the torque."""
    log = recorded(replace(joint, counts=1 << 18, noise=1e-3))
    return {**log, "tau": gain * log["tau"]}


@pytest.mark.slow("twenty logs are estimated")
def test_the_bands_hold_the_truth_as_often_as_they_say() -> None:
    """GIVEN logs with random noise, and random torque gains that match prior.torque_gain."""
    gains = 1 + GAIN * np.random.default_rng(2).normal(size=20)
    configuration = in_memory(CLOSED_FORM)
    inside: dict[str, list[float]] = {"tau_e": [], "sigma": []}
    scores = []
    for seed, gain in enumerate(gains):
        columns = good_log(HardeningJoint(seed=seed), float(gain))
        found = estimate(LogInMemory(Path("log"), columns), configuration).curve
        assert len(found.branches) == 5
        for branch in found.branches:
            torque, stiffness = hardening(branch.phi, branch.set_point)
            bands = {"tau_e": branch.torque_interval(), "sigma": branch.stiffness_interval()}
            for (name, band), true in zip(bands.items(), (torque, stiffness), strict=True):
                assert band is not None
                holds = (band[0] <= true) & (true <= band[1])
                inside[name].append(float(np.mean(holds[branch.within])))
            assert branch.sigma_std is not None
            z = (branch.sigma - stiffness) / branch.sigma_std
            scores.append(float(np.mean(z[branch.within] ** 2)))
    # Of 20 logs, 19 should have a torque gain within 1.96 standard deviations.
    # The probability that fewer than 16 of 20 gains are within 1.96 deviations is only 0.3 %.
    assert np.mean(inside["sigma"]) >= 0.8
    assert np.mean(inside["tau_e"]) >= 0.8
    # The normalised errors of the stiffness are hardly larger than the normalised torque gains.
    assert 0.8 < np.mean(scores) / np.mean(((gains - 1) / GAIN) ** 2) < 1.5


Awas = tuple[Estimate, Columns, Path]


@pytest.fixture(scope="module")
def awas(tmp_path_factory: pytest.TempPathFactory) -> Awas:
    folder, log = tmp_path_factory.mktemp("awas"), awas_log(1.0, 0.3, 10.0)
    return estimated(log, REGRESSION + "prior.B = 0.2\n", folder), log, folder


def test_the_band_is_what_the_estimator_said_at_its_last_sample(awas: Awas) -> None:
    """The branch of the curve at the last set-point equals the last estimate of the FMU."""
    result, _, folder = awas
    end = json.loads((folder / "joint.json").read_text())["at_the_end"]
    branch = min(result.curve.branches, key=lambda b: abs(b.set_point - end["set_point"]))
    assert branch.set_point == pytest.approx(end["set_point"], rel=1e-3)
    assert branch.sigma_std is not None
    assert np.interp(end["phi"], branch.phi, branch.sigma) == pytest.approx(end["sigma"], rel=5e-3)
    std = (end["interval"][1] - end["sigma"]) / 1.96
    assert np.interp(end["phi"], branch.phi, branch.sigma_std) == pytest.approx(std, rel=5e-3)


def test_torque_is_the_integral_of_the_stiffness(awas: Awas) -> None:
    for branch in awas[0].curve.branches:
        steps = np.diff(branch.phi) * (branch.sigma[1:] + branch.sigma[:-1]) / 2
        np.testing.assert_allclose(np.diff(branch.tau_e), steps, atol=1e-3 * np.ptp(branch.tau_e))
        (zero,) = np.flatnonzero(branch.phi == 0)
        assert branch.tau_e_std is not None
        assert branch.tau_e[zero] == branch.tau_e_std[zero] == 0


def test_measured_points_lie_about_the_curve(awas: Awas) -> None:
    """GIVEN the true torque tau_e = k_s r^2 sin(2 phi) of equation (29)."""
    _, _, folder = awas
    found = read_points(folder / POINTS)
    assert 1000 < len(found.phi) <= 3001
    true = 14220.0 * (found.set_point / 1e3) ** 2 * np.sin(2 * found.phi)
    assert np.sqrt(np.mean((found.tau_e - true) ** 2)) < 0.1 * np.sqrt(np.mean(true**2))


def test_the_file_has_all_digits(awas: Awas, tmp_path: Path) -> None:
    result, _, folder = awas
    read = read_curve(folder / CURVE, result.curve.polynomial)
    for a, b in zip(read.branches, result.curve.branches, strict=True):
        assert (a.set_point, a.reach) == (b.set_point, b.reach)
        for name in ("phi", "tau_e", "tau_e_std", "sigma", "sigma_std"):
            assert np.array_equal(getattr(a, name), getattr(b, name))
    with (folder / CURVE).open() as file:
        row = next(csv.DictReader(file))
    low, std = float(row["sigma low [N.m/rad]"]), float(row["sigma_std [N.m/rad]"])
    assert low == pytest.approx(float(row["sigma [N.m/rad]"]) - 1.96 * std)
    assert row["in the data"] == "false"


def test_the_words_say_the_same(awas: Awas) -> None:
    curve = awas[0].curve
    formula = re.search(r"= (.*); phi in rad, s = setPoint", polynomial_in_words(curve.polynomial))
    assert formula
    program = re.sub(r"(?<=[\d)]) (?=[a-z(])", " * ", formula[1]).replace("^", "**")
    for branch in curve.branches:
        value = eval(program, {"phi": branch.phi, "s": branch.set_point})  # the text is safe
        np.testing.assert_allclose(value, branch.tau_e, rtol=1e-3, atol=1e-3)
    lines = curve_text(curve)
    assert "for phi from" in lines[0]
    assert len(lines) == 3 + 3
    for line, branch in zip(lines[3:], curve.branches[::2], strict=True):
        cells = line.split()
        assert float(cells[0]) == pytest.approx(branch.set_point, rel=1e-3)
        assert float(cells[3]) == pytest.approx(branch.sigma[0], rel=0.1)


def test_a_fixed_spring_with_an_offset_has_one_curve(tmp_path: Path) -> None:
    """The band of a general polynomial is wide, because its constant resembles a torque bias."""
    general = CLOSED_FORM.replace("rls.m = 2", "rls.m = 1\nrls.symmetric = false")
    general = general.replace("rls.n = 2", "rls.n = 3")
    result = estimated(good_log(MisfitJoint()), general, tmp_path)
    (branch,) = result.curve.branches
    assert branch.phi[0] < branch.reach[0] < branch.reach[1] < branch.phi[-1]
    assert branch.tau_e_std is not None and branch.sigma_std is not None
    band = branch.torque_interval()
    assert band is not None and np.all(branch.tau_e_std > 0.1)
    true = STIFFNESS * branch.phi
    assert np.all((band[0] <= true) & (true <= band[1]))
    lines = curve_text(result.curve)
    assert "setPoint" not in lines[0]
    middle = lines[4].split()
    assert float(middle[0]) == 0.0
    assert float(middle[2]) < STIFFNESS < float(middle[4])


def test_paper2011_has_a_curve_without_a_band_and_claims_no_interval(tmp_path: Path) -> None:
    result = estimated(awas_log(1.0, 0.3, 4.0), CONFIGURATION, tmp_path)
    assert result.curve.branches and not result.curve.claims
    read = read_curve(tmp_path / CURVE, result.curve.polynomial)
    assert [b.sigma_std for b in read.branches] == [None] * len(read.branches)
    assert "not claimed" in "".join(curve_text(result.curve))
    assert len(read_points(tmp_path / POINTS).phi) > 1000
    sheet = json.loads((tmp_path / "joint.json").read_text())
    assert sheet["curve"] is None and sheet["at_the_end"]["interval"] is None
    assert {p["interval"] for p in sheet["parameters"].values()} == {None}
    assert set(sheet["parameters"]) == {"gamma", "B", "D_theta"}
    assert sheet["start_values"]["rls.n"] == 6


def test_a_joint_that_does_not_move_has_a_point(tmp_path: Path) -> None:
    t = np.arange(0, 2, 1e-3)
    columns = {"t": t, **{name: 0 * t for name in ("theta", "q", "theta_c", "tau")}}
    result = estimated(columns, CLOSED_FORM, tmp_path)
    (branch,) = result.curve.branches
    assert (branch.phi.tolist(), branch.reach) == ([0.0], (0.0, 0.0))
    assert "for phi from 0 to 0 rad" in "".join(curve_text(result.curve))
    assert main(["report", str(tmp_path)]) == 0


def points(set_point: Array, phi: Array) -> MeasuredPoints:
    return MeasuredPoints(phi, set_point, np.zeros(len(phi)))


def test_going_on_adds_to_the_reach() -> None:
    before, fixed = (LearnedLog("a", "b", 10, 0, (-1.0, 0.5), (x, 3.0 - x)) for x in (0.0, 1.5))
    phi = np.linspace(-0.1, 0.9, 100)
    now = points(np.full(100, 1.5), phi)
    (alone,) = reaches(now, [], one_curve=False)
    assert alone.phi == pytest.approx((-0.1, 0.9), abs=2e-3)
    both = reaches(points(np.full(100, 2.0), phi), [before], one_curve=False)
    assert [r.set_point for r in both] == [0.0, 0.75, 1.5, 2.25, 3.0]
    assert [both[i].phi for i in (0, 2, 3)] == [pytest.approx((-1.0, 0.5))] * 3
    assert reaches(now, [before], one_curve=False)[2].phi == pytest.approx((-0.1, 0.9), abs=2e-3)
    for log, one_curve in ((fixed, False), (before, True)):
        (single,) = reaches(now, [log], one_curve=one_curve)
        assert single.phi == pytest.approx((-1.0, 0.9), abs=2e-3)


@pytest.mark.parametrize("levels", [(1.0, 2.0, 5.0), (1.0, 5.0)])
def test_levels_of_the_set_point_are_found_but_not_the_ways_between(levels: list[float]) -> None:
    rng, ways = np.random.default_rng(1), [np.linspace(*ends, 25) for ends in pairwise(levels)]
    path = np.concatenate([np.repeat(levels, 1000), *ways])
    moved = points(path + 1e-3 * rng.normal(size=len(path)), rng.uniform(-1, 1, len(path)))
    found = [r.set_point for r in reaches(moved, [], one_curve=False)]
    assert found == pytest.approx(levels, abs=1e-3)
    assert np.array_equal(nearest([1.0, 2.0, 5.0], np.array([1.1, 1.5, 2.2, 9])), [0, -1, 1, -1])


def test_a_band_that_is_wide_leaves_the_curve_visible() -> None:
    phi = np.linspace(-0.1, 0.1, 11)
    std = np.where(np.abs(phi) > 0.09, 1e8, 1.0)
    branch = Branch(0.0, (-0.1, 0.1), phi, 50 * phi, std, 50 + 0 * phi, std)
    panels = curve_panels(Curve(OF_KNEE, [branch]), points(np.zeros(1), np.zeros(1)))
    shown: list[Any] = [panel.y_range for panel in panels]
    np.testing.assert_allclose(shown, [(-11.0, 11.0), (-10.0, 110.0)], rtol=0.1)


# ---- a polynomial that approximates a curve with knees -------------------------------------------


OF_KNEE = Polynomial(
    powers_of_phi=[0, 1, 2, 3],
    powers_of_set_point=[0, 1],
    eta=[[0.5, 0.0], [100.0, 3.0], [20.0, 0.0], [-40.0, 0.0]],
    units=[["N.m"] * 2, ["N.m/rad"] * 2, ["N.m/rad2"] * 2, ["N.m/rad3"] * 2],
    phi=None,
    set_point=None,
)
ANGLES, SETTINGS = np.linspace(-0.2, 0.3, 101), np.linspace(1.0, 2.0, 101)
SLOPE = 100 + 3 * SETTINGS + 40 * ANGLES - 120 * ANGLES**2
TORQUE = 0.5 + (100 + 3 * SETTINGS) * ANGLES + 20 * ANGLES**2 - 40 * ANGLES**3


def test_a_polynomial_without_knees_stays_as_it_is() -> None:
    assert with_knees(OF_KNEE, ANGLES, SETTINGS, TORQUE, SLOPE) is OF_KNEE


@pytest.mark.parametrize("low", [0, 50])  # with and without a deformation of 0 rad
def test_more_powers_come_near_a_knee(low: int) -> None:
    x, s = ANGLES[low:], SETTINGS[low:]
    beyond, knee = 30 * np.maximum(x - 0.1, 0), np.where(x > 0.1, 30.0, 0.0)
    found = with_knees(OF_KNEE, x, s, TORQUE[low:] + beyond, SLOPE[low:] + knee)
    torque, slope = found.at(x, s)
    # As references, numpy fits polynomials to the torque alone and to the stiffness alone.
    errors = torque - TORQUE[low:] - beyond, slope - SLOPE[low:] - knee
    for error, wanted, degree in zip(errors, (beyond, knee), (7, 6), strict=True):
        best = np.polynomial.Polynomial.fit(x, wanted, degree)(x)
        assert np.std(error) < 2 * np.std(best - wanted)
        assert abs(np.mean(error)) < 0.2 * np.std(error)
    assert found.powers_of_phi == list(range(8)) and found.eta[1][1] == 3.0


def test_the_estimator_has_columns_for_the_powers_near_a_knee() -> None:
    """GIVEN two knees of a spring and five powers of the set-point, THEN the estimator accepts
    these parameters."""
    many = replace(OF_KNEE, powers_of_set_point=[0, 1, 2, 3, 4], eta=[[1.0] * 5] * 4)
    torque, slope = many.at(ANGLES, SETTINGS)
    start = start_of(with_knees(many, ANGLES, SETTINGS, torque, slope + (ANGLES > 0.1)))
    knees = {"rls.symmetric": False, "range.knee": 0.3, "range.knee_2": 0.6, "prior.B": 0.15}
    Estimator({"method": "FilteredRegression", **knees, **start})


@pytest.mark.parametrize(
    ("std", "text"),
    [(5.0, "200 +- 9.8 N.m/rad"), (1e9, "cannot tell (200 +- 1.96e+09) N.m/rad")],
)
def test_an_interval_wider_than_the_stiffness_tells_nothing(std: float, text: str) -> None:
    phi = np.array([-0.1, 0.0, 0.1])
    spring = 200.0 + 0 * phi
    branch = Branch(0.0, (-0.1, 0.1), phi, spring * phi, std * phi, spring, std + 0 * phi)
    curve = Curve(Polynomial([1], [0], [[200.0]], [["N.m/rad"]], None, None), [branch])
    assert headline(curve, Confidence("None", {"None": 1.0})) == f"{text} at 0 rad, confident"
