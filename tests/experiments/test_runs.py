"""Tests of parallel jobs, and of the performance indices in equations (35) and (36)."""

import math
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from functools import partial

import numpy as np
import pytest

from sigmahat.experiments.metrics import indices, mean_error, mean_interval, mse, msrep
from sigmahat.experiments.pool import WorkersLostError, run_all, spread


def after(seconds: float, value: int) -> int:
    time.sleep(seconds)
    return value


def refuse() -> int:
    raise ValueError("refused")


def die() -> int:
    os.kill(os.getpid(), signal.SIGKILL)
    return 0


def test_results_are_in_the_order_of_the_jobs() -> None:
    done: list[int] = []
    jobs = [partial(after, seconds, value) for seconds, value in ((0.5, 1), (0.0, 2), (0.0, 3))]
    assert run_all(jobs, processes=2, progress=done.append) == [1, 2, 3]
    assert done == [1, 1, 1]
    assert [place for place, _ in spread(jobs, processes=2)][-1] == 0  # job 0 is the slowest


def test_the_first_exception_ends_them_all() -> None:
    jobs: list[Callable[[], int]] = [refuse, *[partial(after, 1.0, 1)] * 100]
    started = time.monotonic()
    with pytest.raises(ValueError, match="refused"):
        run_all(jobs, processes=1)
    assert time.monotonic() - started < 50


@pytest.mark.skipif(not hasattr(signal, "SIGKILL"), reason="no signal that ends a process at once")
def test_a_process_that_is_ended_from_outside() -> None:
    jobs: list[Callable[[], int]] = [die, partial(after, 0.0, 1)]
    with pytest.raises(WorkersLostError, match="another program ended a worker process"):
        run_all(jobs, processes=1)


# ---- indices -------------------------------------------------------------------------------------


def test_indices_by_hand() -> None:
    # The errors are 0, 1, 2, the relative errors 0, 1/2, 1/2, and p = 2.
    assert mse([1.0, 2.0, 4.0], [1.0, 1.0, 2.0]) == 2.5
    assert msrep([1.0, 2.0, 4.0], [1.0, 1.0, 2.0]) == 25.0
    assert mean_error([1.0, 2.0, 4.0], [1.0, 1.0, 2.0]) == pytest.approx(-100 / 3, rel=1e-15)


def test_errors_relative_to_another_stiffness_by_hand() -> None:
    # The errors are +1, -1, +2; relative to the reference, the errors are 1/2, -1/4, 2/8.
    arguments = [0.0, 3.0, 6.0], [1.0, 2.0, 8.0], [2.0, 4.0, 8.0]
    assert msrep(*arguments) == pytest.approx((1 / 4 + 1 / 16 + 1 / 16) / 2 * 100, rel=1e-14)
    assert mean_error(*arguments) == pytest.approx((1 / 2 - 1 / 4 + 1 / 4) / 3 * 100, rel=1e-14)


def test_indices_of_an_estimate_that_starts_late() -> None:
    t = 1e-3 * np.arange(2001, dtype=np.float64)
    sigma = np.full(2001, 50.0)
    estimate = np.where(t < 0.02, 0.0, np.where(t < 1.0, 50.0, 50.5))
    # The error is 100 % in 20 samples, then 1 % in 1001 samples from t = 1 s to 2 s.
    found = indices(t, sigma, estimate)
    assert found.mse == pytest.approx((20 * 2500.0 + 1001 * 0.25) / 2000)
    assert found.msrep == pytest.approx((20 + 1001 * 1e-4) / 2000 * 100)
    assert found.error == pytest.approx((-20 * 1.0 + 1001 * 0.01) / 2001 * 100)
    assert found.mse_settled == pytest.approx(1001 * 0.25 / 1000)
    assert found.msrep_settled == pytest.approx(1001 * 1e-4 / 1000 * 100)
    assert found.error_settled == pytest.approx(1.0)


def test_relative_indices_are_unknown_where_the_reference_is_zero() -> None:
    t = 1e-3 * np.arange(2001, dtype=np.float64)
    true = np.full(2001, 50.0)
    reference, estimate = np.where(t < 0.5, 0.0, 50.0), np.where(t < 0.5, 5.0, 50.0)
    found = indices(t, reference, estimate)
    assert found.mse == pytest.approx(500 * 25.0 / 2000)
    assert math.isnan(found.msrep) and math.isnan(found.error)
    assert (found.mse_settled, found.msrep_settled, found.error_settled) == (0.0, 0.0, 0.0)
    found = indices(t, reference, estimate, relative_to=true)
    assert found.msrep == pytest.approx(500 * 0.01 / 2000 * 100)
    assert found.error == pytest.approx(500 * 0.1 / 2001 * 100)


@pytest.mark.parametrize(
    ("sigma", "estimate", "message"),
    [
        ([1.0, 2.0], [1.0], "same shape"),
        ([1.0], [1.0], "same shape"),
        ([[1.0, 2.0]], [[1.0, 2.0]], "same shape"),
        ([1.0, 2.0], [1.0, math.nan], "finite"),
        ([1.0, math.inf], [1.0, 2.0], "finite"),
    ],
)
def test_bad_arguments_are_refused(sigma: object, estimate: object, message: str) -> None:
    for index in (mse, msrep, mean_error):
        with pytest.raises(ValueError, match=message):
            index(sigma, estimate)  # type: ignore[arg-type]


def test_relative_error_of_zero_stiffness_is_refused() -> None:
    for index in (msrep, mean_error):
        with pytest.raises(ValueError, match="zero"):
            index([0.0, 1.0], [0.0, 1.0])
        with pytest.raises(ValueError, match="zero"):
            index([1.0, 1.0], [1.0, 1.0], [1.0, 0.0])


def test_interval_of_equal_values_is_exactly_zero() -> None:
    assert float(np.std([0.1] * 20)) > 0  # wrong because of rounding
    assert mean_interval([0.1] * 20) == (0.1, 0.0)


@pytest.mark.skipif(os.name != "posix", reason="sends Ctrl-C to one process")
def test_a_second_interrupt_leaves_no_workers() -> None:
    """GIVEN jobs of two seconds in two processes, WHEN the user is impatient."""
    script = (
        "import time\n"
        "from functools import partial\n"
        "from sigmahat.experiments.pool import run_all\n"
        "jobs = [partial(time.sleep, 2.0)] * 6\n"
        "run_all(jobs, 2, lambda done: print(done, flush=True))\n"
    )
    command = [sys.executable, "-c", script]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE) as process:
        assert process.stdout is not None
        assert process.stdout.readline() == b"1\n"
        process.stdout.readline()  # both workers have begun other jobs
        time.sleep(0.5)
        for _ in range(2):
            process.send_signal(signal.SIGINT)
            time.sleep(0.5)
        try:
            _, errors = process.communicate(timeout=20)
        except subprocess.TimeoutExpired:
            process.kill()
            raise
    assert errors.strip().endswith(b"KeyboardInterrupt")
