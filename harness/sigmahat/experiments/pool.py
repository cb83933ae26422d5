"""Runs independent jobs in parallel processes of this machine."""

import multiprocessing
import os
import signal
import threading
from collections.abc import Callable, Generator, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from concurrent.futures.process import BrokenProcessPool
from contextlib import closing, contextmanager
from multiprocessing.connection import wait
from multiprocessing.resource_tracker import ensure_running
from typing import TypeVar

from sigmahat.fmi.interrupts import interrupts_wait

Result = TypeVar("Result")
Progress = Callable[[int], object]
"""Is called now and then with the number of jobs that are done since the last call."""


class WorkerError(RuntimeError):
    """A process, or a machine of a cluster, cannot do its jobs."""


class WorkersLostError(WorkerError):
    """Processes or machines were lost during their jobs; another call may do these jobs."""


def spread(
    jobs: Sequence[Callable[[], Result]], processes: int | None = None
) -> Generator[tuple[int, Result], None, None]:
    """Yields the place of a job and its result, in the order in which the jobs are done.

    jobs       partial objects or functions that other processes can import; a single job is done
               in this process
    processes  largest number of processes, by default one per processor

    Raises what a job raises, and WorkersLostError if another program ended a process. Closing
    the generator cancels the jobs that have not begun.
    """
    if len(jobs) == 1:
        yield 0, jobs[0]()
        return
    workers = max(min(len(jobs), processes or os.cpu_count() or 1), 1)
    context = multiprocessing.get_context("spawn")
    executor = ProcessPoolExecutor(workers, mp_context=context, initializer=_end_with_the_parent)
    try:
        with _interrupts_for_the_parent_alone():
            places = {executor.submit(job): place for place, job in enumerate(jobs)}
        for future in as_completed(places):
            yield places[future], future.result()
    except BrokenProcessPool as error:
        raise WorkersLostError("another program ended a worker process") from error
    finally:
        # A second Ctrl-C would leave workers that wait for jobs, and this process waiting for them.
        with interrupts_wait():
            executor.shutdown(cancel_futures=True)


def run_all(
    jobs: Sequence[Callable[[], Result]],
    processes: int | None = None,
    progress: Progress = lambda done: None,
) -> list[Result]:
    """Returns the results of all jobs in their order; the first exception of a job ends all jobs.

    jobs, processes  as for spread(); the number of processes has no effect on the results
    progress         called with 1 for every job that is done
    """
    results: dict[int, Result] = {}
    with closing(spread(jobs, processes)) as done:
        for place, result in done:
            results[place] = result
            progress(1)
    return [results[place] for place in range(len(jobs))]


@contextmanager
def _interrupts_for_the_parent_alone() -> Iterator[None]:
    """Processes that start inside the block ignore Ctrl-C, which a terminal sends to them too.

    New processes inherit the blocked signal. In this process, the signal waits until the end of the
    block, also if another thread receives the signal. Therefore each process is fully started.
    """
    if not hasattr(signal, "pthread_sigmask"):
        yield
        return
    with interrupts_wait():
        ensure_running()  # the resource tracker would lift the block when it starts
        mask = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
        try:
            yield
        finally:
            signal.pthread_sigmask(signal.SIG_SETMASK, mask)


def _end_with_the_parent() -> None:
    """Ends this process when the parent process has ended, instead of waiting forever."""
    parent = multiprocessing.parent_process()
    assert parent is not None
    sentinel = parent.sentinel

    def watch() -> None:
        wait([sentinel])
        os._exit(1)

    threading.Thread(target=watch, daemon=True).start()
