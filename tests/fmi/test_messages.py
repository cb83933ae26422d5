"""Messages of FMUs: each comes to the slave that it is of."""

from __future__ import annotations

import gc
import logging
import math

import pytest
from fmpy import fmi2

import sigmahat
from sigmahat.fmi.instance import Fmu, FmuError, Slave

T = 1e-3


def step_without_theta(slave: Slave) -> None:
    theta = slave.fmu.references(["theta"])
    one = (fmi2.fmi2Real * 1)(math.nan)
    slave.call(slave.functions.fmi2SetReal, theta, 1, one)
    slave.call(slave.functions.fmi2DoStep, 0.0, T, 1)


def test_a_warning_has_the_name_of_its_slave(caplog: pytest.LogCaptureFixture) -> None:
    with (
        caplog.at_level(logging.WARNING, "sigmahat"),
        Fmu(sigmahat.fmu("StiffnessEstimator")) as fmu,
        Slave(fmu, "first") as first,
        Slave(fmu, "second") as second,
    ):
        for slave in (first, second):
            slave.initialize({})
        step_without_theta(first)
        step_without_theta(second)
    names = [record.getMessage().split(":")[0] for record in caplog.records]
    assert names == ["first", "second"]


def test_an_error_is_raised_with_the_messages_of_its_slave() -> None:
    with (
        Fmu(sigmahat.fmu("StiffnessEstimator")) as fmu,
        Slave(fmu, "wrong") as wrong,
        Slave(fmu, "later"),
        pytest.raises(FmuError, match=r"^wrong: .*residual\.K_I.* out of its range"),
    ):
        wrong.initialize({"residual.K_I": -1.0})


def test_an_older_slave_speaks_after_a_newer_one_is_gone(caplog: pytest.LogCaptureFixture) -> None:
    with (
        caplog.at_level(logging.WARNING, "sigmahat"),
        Fmu(sigmahat.fmu("StiffnessEstimator")) as fmu,
        Slave(fmu, "older") as older,
    ):
        older.initialize({})
        with Slave(fmu, "newer") as newer:
            newer.initialize({})
        del newer
        gc.collect()
        step_without_theta(older)
    assert [record.getMessage().split(":")[0] for record in caplog.records] == ["older"]
