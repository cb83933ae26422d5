"""Jobs in parallel: their order, their errors, and processes that are lost."""

from __future__ import annotations

import os
import signal
import time
from collections.abc import Callable
from functools import partial

import pytest

from sigmahat.paper.scenarios import scenario
from sigmahat.runs.engine import measured, run_all
from sigmahat.runs.metrics import INDICES, Indices
from sigmahat.runs.pool import WorkersLostError, spread


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
    assert [place for place, _ in spread(jobs, processes=2)][-1] == 0  # it takes longest


def test_the_first_exception_ends_them_all() -> None:
    jobs: list[Callable[[], int]] = [refuse, *[partial(after, 1.0, 1)] * 100]
    started = time.monotonic()
    with pytest.raises(ValueError, match="refused"):
        run_all(jobs, processes=1)
    assert time.monotonic() - started < 50


@pytest.mark.skipif(not hasattr(signal, "SIGKILL"), reason="no signal that ends a process at once")
def test_a_process_that_is_ended_from_outside() -> None:
    jobs: list[Callable[[], int]] = [die, partial(after, 0.0, 1)]
    with pytest.raises(WorkersLostError, match="a process was ended from outside"):
        run_all(jobs, processes=1)


def test_only_what_is_measured_comes_back() -> None:
    short = scenario("single-linear")
    assert measured(short, 1, lambda scenario, recording: len(recording.t)) == short.steps + 1


def test_every_index_is_described_once() -> None:
    assert tuple(INDICES) == tuple(Indices.__dataclass_fields__)
    assert all(field == index.field for field, index in INDICES.items())
    titles = [index.title("after 1 s" if index.settled else "") for index in INDICES.values()]
    assert titles[1::3] == ["MSREP [%]", "MSREP after 1 s [%]"]
    assert len(set(titles)) == len(titles)
