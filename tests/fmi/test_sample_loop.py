"""The loop over samples: what it refuses, interrupts, and FMUs of other makers."""

import logging
import os
import signal
import sys
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import sigmahat
from controllers import run
from sigmahat.experiments.scenario import T
from sigmahat.fmi import native
from sigmahat.fmi.instance import Fmu, Slave
from sigmahat.fmi.interrupts import interrupts_wait
from sigmahat.fmi.master import Plant, simulate
from sigmahat.fmi.model import FmuError
from sigmahat.fmi.sample_loop import SampleLoop
from sigmahat.paper.scenarios import scenario

TABLE1 = scenario("table1")


def test_a_refused_step_ends_it_with_the_message_of_the_fmu() -> None:
    plant = replace(TABLE1.plant, inputs={"tau": lambda t: np.where(t < 0.0105, 0.1, np.nan)})
    with pytest.raises(FmuError, match=r"Step from t = 0\.01 s refused.* finite"):
        simulate(plant, {}, T, 20)


@pytest.mark.parametrize(
    ("name", "value", "reason"),
    [("folder", Path, "No such file"), ("_INTERFACE", 0, "it is of another version")],
)
def test_a_library_that_cannot_be_used(
    name: str, value: object, reason: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(native, name, value)
    with pytest.raises(FmuError, match=rf"native.*: cannot load this \(.*{reason}.*again"):
        native.library.__wrapped__()


def test_calls_are_made_in_their_order_up_to_the_one_that_fails() -> None:
    with Fmu(sigmahat.fmu("StiffnessEstimator")) as fmu, Slave(fmu, "one") as slave:
        slave.initialize({})
        table, loop = np.zeros((5, 1)), SampleLoop()
        times = np.column_stack([T * np.arange(5.0), np.full(5, T)])
        times[3, 1] = -1.0
        loop.set_real(slave, fmu.references(["theta"], "input"), np.arange(5.0)[:, None])
        loop.step(slave, times)
        loop.get(slave, "Real", fmu.references(["theta"]), table)
        with pytest.raises(FmuError, match="fmi2DoStep"):
            loop.run(0, 5)
    assert table[:, 0].tolist() == [0.0, 1.0, 2.0, 0.0, 0.0]


@pytest.mark.parametrize(
    "table", [np.zeros((2, 5)).T, np.zeros((5, 1)), np.zeros((5, 2), np.float32), np.zeros(3)]
)
def test_a_table_of_another_layout_is_refused(table: np.typing.NDArray[np.float64]) -> None:
    with Fmu(sigmahat.fmu("StiffnessEstimator")) as fmu, Slave(fmu, "one") as slave:
        both = fmu.references(["theta", "q"])
        with pytest.raises(ValueError, match="C-contiguous table of float64 with 2 columns"):
            SampleLoop().set_real(slave, both, table)
        loop = SampleLoop()
        loop.set_real(slave, both, np.zeros((5, 2)))
        with pytest.raises(ValueError, match="within 5 rows, got 0 to 6"):
            loop.run(0, 6)


def test_an_interrupt_has_its_effect_at_the_end_of_the_block() -> None:
    done = []
    with pytest.raises(KeyboardInterrupt), interrupts_wait():
        signal.raise_signal(signal.SIGINT)
        done.append("after the signal")
    assert done == ["after the signal"]
    with pytest.raises(KeyboardInterrupt):  # the handler is the earlier one
        signal.raise_signal(signal.SIGINT)


def test_an_ignored_interrupt_stays_ignored() -> None:
    handler = signal.signal(signal.SIGINT, signal.SIG_IGN)
    try:
        with interrupts_wait():
            signal.raise_signal(signal.SIGINT)
    finally:
        signal.signal(signal.SIGINT, handler)


@pytest.mark.skipif(not hasattr(signal, "setitimer"), reason="no timers")
@pytest.mark.filterwarnings("ignore")
def test_interrupts_at_any_moment_end_it_and_leave_it_whole() -> None:
    path = str(sigmahat.fmu("StiffnessEstimator"))
    lost = {"theta": lambda t: np.where(np.arange(len(t)) % 4 < 2, 0.0, np.nan)}
    plant = Plant(path, {}, lost, ["sigma"])  # a warning every fourth sample
    random = np.random.default_rng(1)
    interrupted = 0
    simulate(plant, {}, T, 10)  # reads the FMU in advance: other libraries are not tested here
    logging.getLogger("sigmahat").propagate = False  # to pytest, which keeps every warning
    before = signal.signal(signal.SIGALRM, lambda *_: signal.raise_signal(signal.SIGINT))
    for _ in range(60):
        try:
            signal.setitimer(signal.ITIMER_REAL, random.uniform(0.001, 0.02))
            simulate(plant, {}, T, 200_000)
        except KeyboardInterrupt:
            interrupted += 1
    signal.signal(signal.SIGALRM, before)
    logging.getLogger("sigmahat").propagate = True
    assert interrupted >= 55  # Python itself drops one that comes in a finalizer
    assert len(simulate(plant, {}, T, 10).plant["sigma"]) == 11


@pytest.mark.skipif(not hasattr(os, "fork"), reason="no fork")
def test_forked_processes_leave_nothing_and_take_nothing(tmp_path: Path) -> None:
    program = """
import multiprocessing, os, sys, sigmahat
table1 = sigmahat.scenario("table1")

def run(_):
    return sigmahat.simulate(table1.plant, {}, 1e-3, 2).plant.parameters["noise.seed"]

run(0)
child = os.fork()
if child == 0:
    sys.exit(0)
os.waitpid(child, 0)
with multiprocessing.get_context("fork").Pool(2) as pool:
    print(pool.map(run, range(4)))
    pool.close()
    pool.join()
print(run(0))
"""
    command = [sys.executable, "-W", "error::ResourceWarning", "-c", program]
    assert run(*command, environment={"TMPDIR": str(tmp_path)}) == "[1, 1, 1, 1]\n1\n"
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("period", "steps"), [(0.0, 1), (np.nan, 1), (np.inf, 1), (T, -1), (T, 0.5)]
)
def test_periods_and_steps_that_make_no_sense(period: float, steps: Any) -> None:
    with pytest.raises(ValueError, match="expected T > 0 s and a number of steps"):
        simulate(TABLE1.plant, {}, period, steps)


def test_a_plant_of_another_maker_that_takes_no_slopes(tmp_path: Path) -> None:
    script = tmp_path / "integrator.py"
    script.write_text(
        """
from pythonfmu import Boolean, Fmi2Causality, Fmi2Slave, Fmi2Variability, Integer, Real, String

class Integrator(Fmi2Slave):
    def __init__(self, **kwargs):
        super().__init__(**kwargs)
        self.u, self.x, self.steps, self.far, self.label = 0.0, 0.0, 0, False, "a"
        self.register_variable(Real("u", causality=Fmi2Causality.input))
        self.register_variable(Real("x", causality=Fmi2Causality.output))
        for kind, name in ((Integer, "steps"), (Boolean, "far"), (String, "label")):
            self.register_variable(kind(name, causality=Fmi2Causality.output,
                                        variability=Fmi2Variability.discrete))

    def do_step(self, t, h):
        self.x += self.u * h
        self.steps += 1
        self.far = self.x > 0.25
        return True
"""
    )
    run(sys.executable, "-m", "pythonfmu", "build", "-f", script, "-d", tmp_path)
    (fmu,) = map(str, tmp_path.glob("*.fmu"))
    plant = Plant(fmu, {}, {"u": lambda t: t}, ["x", "steps", "far"])
    h, steps = 0.01, 100
    found = simulate(plant, {}, h, steps).plant
    k = np.arange(steps + 1)
    x = h * h * k * (k - 1) / 2  # inputs that are held: a sum, and not the integral
    np.testing.assert_allclose(found["x"], x, rtol=0, atol=1e-12)
    np.testing.assert_array_equal(found["steps"], k)
    np.testing.assert_array_equal(found["far"], x > 0.25)
    with pytest.raises(ValueError, match=r"Integrator\.label: a String cannot be recorded"):
        simulate(replace(plant, record=["label"]), {}, h, 1)
