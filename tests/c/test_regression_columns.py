"""Each column of FilteredRegression against its definition, by scipy on a motion that is given.

The row of the regression of a joint that has what a column stands for is the column times its
coefficient: so also the sign of every column, and of what it means, is tested.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from c_library import Array, Estimator, Library
from c_regression import coefficients
from dense_signals import GAPS, PLAYS, through

T, W = 1e-3, 350.0
B, D, COULOMB = 2.3e-5, 1e-3, 0.02
PHI, SET_POINT = 0.3, 100.0
VALUES = {
    **{"method": 2, "rls.n": 3, "rls.m": 3, "prior.B": 0.1, "prior.nominal": 0.2},
    **{"encoder.theta": 0.0, "encoder.q": 0.0},
}
K_0 = 45.0 / PHI


t = T * np.arange(600)
theta = 0.8 * (1 - np.cos(7 * t))
theta_dot = 5.6 * np.sin(7 * t)
phi = 0.1 * np.sin(11 * t) * (1 - np.cos(5 * t))
q = theta + phi
theta_c = 30.0 * np.sin(3 * t)
lever = (100.0 - 2.5 / (2 * np.pi) * theta_c) / SET_POINT
tau = 0.4 * np.sin(9 * t)


def rows(c: Library, **values: float) -> tuple[dict[tuple[str, int], Array], Array, Array]:
    """The columns over time, each without its prior, and the two sides."""
    eta_0 = np.zeros((8, 5))
    eta_0[0, 0], eta_0[1, 1] = 100.0, 3.0
    estimator = Estimator(c, {**VALUES, "rls.eta_0": eta_0.tolist(), **values})
    regression = c.ffi.addressof(estimator.state.method, "regression")
    row, found = np.zeros(regression.columns.size + 2), []
    for sample in np.column_stack([theta, q, theta_c, tau, 5 * tau]):
        assert estimator.tick(sample)
        c.lib.sh_columns_row(regression, estimator.parameters, c.pointer(row))
        found.append(row.copy())
    array = np.array(found)
    names = coefficients(estimator)
    by_name = {
        name: array[:, i] / regression.columns.column[i].prior for i, name in enumerate(names)
    }
    return by_name, array[:, -2], array[:, -1]


def filtered(x: Array, order: int = 0, held: bool = False) -> Array:
    return through(x, order, W, T, held)


def steady(x: Array, order: int = 0) -> Array:
    """The signal has always been at its first value."""
    return filtered(x - x[0], order) + (x[0] if order == 0 else 0.0)


def as_if_smooth(x: Array, held: bool = False) -> Array:
    return filtered(x, 0, held) + T**2 / 12 * filtered(x, 2, held)


def assert_close(got: Array, want: Array) -> None:
    assert np.max(np.abs(got - want)) <= 1e-9 * np.max(np.abs(want))


def nominal() -> Array:
    torque: Array = 100.0 * phi + 3.0 * SET_POINT * lever * phi**3
    return torque


def definitions(gamma: float) -> dict[tuple[str, int], Array]:
    """Columns that do not depend on the estimate."""
    x = phi / PHI
    sign = np.sign(theta_dot[1:] + theta_dot[:-1])
    sign = np.append(sign, 0.0)  # of the sample that begins at each instant
    play, plays = np.zeros(3), []
    widths = PHI * np.array(PLAYS)
    for k in range(len(t)):
        play = np.clip(play + (phi[k] - phi[k - 1] if k else 0.0), -widths, widths)
        plays.append(play / widths)
    want = {
        **{("POWER", 3 * j + i): filtered(x ** (2 * i + 1) / (2 * i + 1) * lever**j)
           for i in range(3) for j in range(3)},
        ("NOMINAL", 0): filtered(nominal()),
        ("BIAS", 0): filtered(np.ones(len(t))),
        ("DAMPING", 0): steady(phi, 1),
        ("DAMPING", 2): steady(phi * lever**2, 1),
        ("SIN_Q", 0): filtered(np.sin(q)),
        ("COS_Q", 0): filtered(np.cos(q)),
        ("HIGHER_POWER", 0): filtered(x**7 / 7),
        ("HIGHER_POWER", 1): filtered(x**9 / 9),
        ("SET_POWER", 0): filtered(x * lever**3),
        **{("DEAD_ZONE", i): filtered(np.clip(x, -GAPS[i], GAPS[i]) / GAPS[i]) for i in range(3)},
        **{("HYSTERESIS", i): filtered(np.array(plays)[:, i]) for i in range(3)},
        ("VISCOUS", 0): -(gamma**2) * D * steady(theta, 1),
        ("INERTIA", 0): -(gamma**2) * B * steady(theta, 2),
        ("COULOMB", 0): -abs(gamma) * as_if_smooth(sign, held=True),
        ("DRIVE", 0): -np.abs(gamma * as_if_smooth(tau)) * as_if_smooth(sign, held=True),
        ("REVERSAL", 0): abs(gamma) * filtered(sign, 1, held=True),
    }  # fmt: skip
    return want


@pytest.mark.parametrize("gamma", [50.0, -50.0])
def test_every_column_is_its_definition(c: Library, gamma: float) -> None:
    found, _, _ = rows(c, **{"motor.gamma": gamma})
    want = definitions(gamma)
    assert found.keys() - want.keys() == {("LOAD", 0), ("DELAY", 0), ("SIN_M", 0), ("COS_M", 0)}
    assert want.keys() <= found.keys()
    for name, column in want.items():
        if name[0] in ("COULOMB", "DRIVE", "REVERSAL"):  # the sign is detected from the positions
            late = 12  # from the second sample on
            error = np.abs(found[name] - column)[late:]
            assert np.mean(error) < 0.03 * np.max(np.abs(column)), name
        else:
            assert_close(found[name], column)


@pytest.mark.parametrize("held", [0, 1])
@pytest.mark.parametrize("gamma", [50.0, -50.0])
def test_the_sides_are_the_torque_and_all_that_is_known(
    c: Library, gamma: float, held: int
) -> None:
    _, by_gain, y = rows(c, **{"motor.gamma": gamma, "torque.held": held})
    torque = as_if_smooth(tau, bool(held))
    assert_close(by_gain, -gamma * torque)
    motor = gamma**2 * (B * steady(theta, 2) + D * steady(theta, 1))
    assert_close(y, motor - gamma * torque - filtered(nominal()))


def test_a_measured_torque_has_no_columns_of_the_motor(c: Library) -> None:
    found, by_gain, y = rows(c, **{"modality": 2, "prior.delay": 1e-12})
    assert_close(by_gain, filtered(5 * tau))
    assert_close(y, filtered(5 * tau) - filtered(nominal()))
    for kind in ("LOAD", "DRIVE", "REVERSAL", "SIN_M", "COS_M", "VISCOUS", "COULOMB", "INERTIA"):
        assert not np.any(found[kind, 0])
    assert_close(found["DELAY", 0], -filtered(5 * tau, 1))


@pytest.mark.parametrize("gamma", [50.0, -50.0])
def test_the_torque_that_is_late_is_explained_by_the_delay(c: Library, gamma: float) -> None:
    """GIVEN a torque that is recorded late by delta, THEN y of the true torque less that of the
    recorded one is delta times the column: the coefficient is the delay, whatever the gear."""
    delta = 1e-4
    found, _, _ = rows(c, **{"motor.gamma": gamma, "prior.delay": 1e-12})
    late = 0.4 * np.sin(9 * (t - delta))
    change = -gamma * (filtered(late) - filtered(tau))  # of y
    later = slice(100, None)  # both begin at rest, with another torque
    want = delta * found["DELAY", 0][later]
    assert np.max(np.abs(change[later] - want)) < 2e-3 * np.max(np.abs(want))


@pytest.mark.parametrize("gamma", [50.0, -50.0])
def test_friction_of_the_load_acts_against_the_motion(c: Library, gamma: float) -> None:
    """It takes its share of the flexibility torque from that of the motor, as Coulomb friction: the
    column is negative where the motor turns forwards, whatever the gear."""
    found, _, _ = rows(c, **{"motor.gamma": gamma})
    forwards, backwards = slice(50, 440), slice(520, 600)
    assert np.all(theta_dot[forwards] > 0) and np.all(theta_dot[backwards] < 0)
    for kind in ("LOAD", "DRIVE", "COULOMB"):
        assert np.all(found[kind, 0][forwards] <= 0)
        assert np.all(found[kind, 0][backwards] >= 0)
    assert np.min(found["LOAD", 0]) < 0 < np.max(found["LOAD", 0])


def test_the_order_has_the_inertia_last(c: Library) -> None:
    names = [kind for kind, _ in coefficients(Estimator(c, {**VALUES}))]
    assert names[-3:] == ["VISCOUS", "COULOMB", "INERTIA"]
    assert names[:9] == ["POWER"] * 9


NEW: dict[str, tuple[str, ...]] = {
    "prior.nominal": ("NOMINAL",),
    "prior.bias": ("BIAS",),
    "prior.damping": ("DAMPING",),
    "prior.eccentric": ("SIN_Q", "COS_Q"),
    "prior.load_friction": ("LOAD", "DRIVE"),
    "prior.delay": ("DELAY",),
    "prior.reversal": ("REVERSAL",),
    "prior.power": ("HIGHER_POWER", "SET_POWER"),
    "prior.gap": ("DEAD_ZONE",),
    "prior.hysteresis": ("HYSTERESIS",),
    "prior.eccentric_motor": ("SIN_M", "COS_M"),
    "prior.D_theta": ("VISCOUS",),
    "prior.tau_coulomb": ("COULOMB", "DRIVE", "REVERSAL"),
    "prior.B": ("INERTIA",),
}


@pytest.mark.parametrize("prior", NEW)
def test_a_prior_of_zero_removes_its_columns_and_no_other(c: Library, prior: str) -> None:
    eta_0: Any = np.zeros((8, 5))
    eta_0[0, 0] = 1.0
    values = {**VALUES, "rls.eta_0": eta_0.tolist()}
    of_all = coefficients(Estimator(c, values))
    without = coefficients(Estimator(c, {**values, prior: 0.0}))
    assert without == [name for name in of_all if name[0] not in NEW[prior]]
    assert {kind for kind, _ in of_all} - {kind for kind, _ in without} == set(NEW[prior])


@pytest.mark.parametrize("symmetric", [0, 1])
def test_the_slope_of_a_column_of_the_torque_is_its_derivative(c: Library, symmetric: int) -> None:
    """Dead zone, hysteresis and all that is not of the spring have none."""
    estimator = Estimator(c, {**VALUES, "rls.symmetric": symmetric})
    regression = c.ffi.addressof(estimator.state.method, "regression")

    def signals(phi: float) -> tuple[Array, Array]:
        at, columns = c.new("sh_joint_point"), c.ffi.addressof(regression, "columns")
        history, size = c.ffi.addressof(regression, "history"), regression.columns.size
        position = (0.3, 0.2, phi, 80.0, history.play)
        c.lib.sh_joint_point_at(at, columns, estimator.parameters, *position)
        return np.array(list(at.F[0:size])), np.array(list(at.dF[0:size]))

    small = 1e-5
    above, below = signals(0.15 + small)[0], signals(0.15 - small)[0]
    curve = [kind in ("POWER", "HIGHER_POWER", "SET_POWER") for kind, _ in coefficients(estimator)]
    assert sum(curve) == 12
    slopes = np.where(curve, (above - below) / (2 * small), 0.0)
    assert signals(0.15)[1] == pytest.approx(slopes, rel=1e-6)
