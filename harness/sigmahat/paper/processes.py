"""Independent jobs, spread over processes."""

from __future__ import annotations

import multiprocessing
import os
import signal
import threading
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from contextlib import contextmanager
from functools import partial
from multiprocessing.resource_tracker import ensure_running
from typing import Any


def spread(
    jobs: Sequence[partial[Any]],
    processes: int | None = None,
    progress: Callable[[int], object] = lambda done: None,
) -> list[Any]:
    """Results of the jobs, in their order; the first exception of one ends them all.

    processes  at most so many, by default one per processor
    progress   called with 1 for every job that is done
    """
    workers = min(len(jobs), processes or os.cpu_count() or 1)
    context = multiprocessing.get_context("spawn")
    executor = ProcessPoolExecutor(workers, mp_context=context)
    try:
        with interrupts_for_the_parent_alone():
            futures = [executor.submit(job) for job in jobs]
        for future in as_completed(futures):
            future.result()
            progress(1)
        return [future.result() for future in futures]
    finally:
        executor.shutdown(cancel_futures=True)


@contextmanager
def interrupts_for_the_parent_alone() -> Iterator[None]:
    """Processes started inside do not hear Ctrl-C, which a terminal sends to them too.

    They inherit the blocked signal. Here it waits until the end of the block, also if it comes to
    another thread, so that no process is left half started.
    """
    if not hasattr(signal, "pthread_sigmask"):
        yield
        return
    waiting: list[int] = []
    main = threading.current_thread() is threading.main_thread()
    if main:
        handler = signal.signal(signal.SIGINT, lambda number, frame: waiting.append(number))
    ensure_running()  # this helper of multiprocessing would lift the block when it starts
    mask = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, mask)
        if main:
            signal.signal(signal.SIGINT, handler)
    if waiting:
        raise KeyboardInterrupt
