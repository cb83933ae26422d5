"""The runs of a sweep: one of them, and all in processes of this machine or on a Dask cluster."""

from __future__ import annotations

import asyncio
import logging
import multiprocessing
import os
import threading
from collections.abc import Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from concurrent.futures.process import BrokenProcessPool
from dataclasses import astuple, dataclass
from functools import lru_cache
from multiprocessing.connection import wait

from sigmahat.fmi.instance import FmuError
from sigmahat.fmi.master import simulate
from sigmahat.paper.processes import interrupts_for_the_parent_alone
from sigmahat.paper.reproduction import all_indices
from sigmahat.paper.scenarios import T
from sigmahat.sweep.plan import Run, fmu_digest, prepare

_CONNECT = 10.0
"""How long a scheduler and its first worker are waited for [s]."""
_AGAIN = "the same command goes on from what is done"


class WorkerError(RuntimeError):
    """A worker cannot do runs of this sweep."""


@dataclass(frozen=True)
class Outcome:
    """What came out of a run."""

    number: int
    """Of the run."""
    indices: dict[str, tuple[float, ...]]
    """Fields of sigmahat.metrics.Indices by comparison; empty if the run failed."""
    failure: str | None
    """Why it failed: an FMU refused a value, or an estimate is not finite."""


def execute(run: Run, fmus: str) -> Outcome:
    """Does a run. Raises WorkerError if the FMUs here are not those of this digest."""
    if _digest(run.scenario) != fmus:
        raise WorkerError(
            "a worker has other FMUs than this machine; install the same sigmahat on both"
        )
    try:
        scenario = prepare(run)
        recording = simulate(scenario.plant, scenario.estimators, T, scenario.steps)
        found = all_indices(scenario, recording)
    except (FmuError, ValueError) as error:
        return Outcome(run.number, {}, " ".join(str(error).split()))
    return Outcome(run.number, {name: astuple(each) for name, each in found.items()}, None)


@lru_cache
def _digest(scenario: str) -> str:
    return fmu_digest([scenario])


def local(runs: Sequence[Run], processes: int | None = None) -> Iterator[Outcome]:
    """Yields outcomes as they come; by default one process for each processor.

    Raises WorkerError if a process was ended from outside.
    """
    workers = min(len(runs), processes or os.cpu_count() or 1)
    context = multiprocessing.get_context("spawn")
    executor = ProcessPoolExecutor(workers, mp_context=context, initializer=_end_with_the_parent)
    digests = _digests(runs)
    try:
        with interrupts_for_the_parent_alone():
            futures = [executor.submit(execute, run, digests[run.scenario]) for run in runs]
        for future in as_completed(futures):
            yield future.result()
    except BrokenProcessPool as error:
        raise WorkerError(f"a process was ended from outside; {_AGAIN}") from error
    finally:
        executor.shutdown(cancel_futures=True)


def cluster(runs: Sequence[Run], scheduler: str) -> Iterator[Outcome]:
    """Yields outcomes as they come from the workers of a Dask scheduler, "tcp://host:port".

    What a lost worker had is done by another one, and each outcome comes once. Raises WorkerError
    if there is no scheduler or no worker, or if the scheduler is lost.
    """
    import distributed
    from distributed.comm.core import CommClosedError
    from distributed.scheduler import KilledWorker

    for name in ("distributed", "distributed.client"):  # what matters is raised here
        logging.getLogger(name).setLevel(logging.CRITICAL)
    try:
        # A client would wait for ever for the answer of something else that listens there.
        asyncio.run(asyncio.wait_for(_ask(scheduler), _CONNECT))
        client = distributed.Client(scheduler, timeout=_CONNECT, set_as_default=False)
    except (OSError, ValueError, TimeoutError, asyncio.TimeoutError) as error:
        raise WorkerError(
            f"no Dask scheduler at {scheduler}; start one with `dask scheduler`, "
            "which prints its address"
        ) from error
    digests = _digests(runs)
    try:
        try:
            client.wait_for_workers(1, timeout=_CONNECT)
        except TimeoutError as error:
            raise WorkerError(
                f"the scheduler at {scheduler} has no workers; "
                f"start one with `dask worker {scheduler}`"
            ) from error
        futures = client.map(execute, runs, [digests[r.scenario] for r in runs], pure=False)
        for future in distributed.as_completed(futures, loop=client.loop):
            yield future.result()
            future.release()
    except (distributed.CancelledError, CommClosedError) as error:
        raise WorkerError(f"the scheduler at {scheduler} was lost; {_AGAIN}") from error
    except KilledWorker as error:
        raise WorkerError(f"several workers died in the same run; {_AGAIN}") from error
    except ImportError as error:
        raise WorkerError(f"a worker cannot import sigmahat: {error}; install it there") from error
    finally:
        client.close(timeout=1)


async def _ask(scheduler: str) -> None:
    import distributed

    async with distributed.rpc(scheduler) as remote:
        await remote.identity()


def _digests(runs: Sequence[Run]) -> dict[str, str]:
    return {name: fmu_digest([name]) for name in {run.scenario for run in runs}}


def _end_with_the_parent() -> None:
    """Ends this process when its parent is gone; it would wait for work for ever."""
    parent = multiprocessing.parent_process()
    assert parent is not None
    sentinel = parent.sentinel

    def watch() -> None:
        wait([sentinel])
        os._exit(1)

    threading.Thread(target=watch, daemon=True).start()
