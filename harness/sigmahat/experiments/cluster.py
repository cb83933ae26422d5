"""Runs jobs on a Dask cluster; pool.py runs jobs in processes of this machine."""

import asyncio
import logging
from collections.abc import Callable, Generator, Sequence
from typing import Any, TypeVar

from sigmahat.experiments.pool import WorkerError, WorkersLostError

Result = TypeVar("Result")

_CONNECT = 10.0  # longest wait for a reply of a scheduler, and for its first worker [s]


def spread_on_cluster(
    jobs: Sequence[Callable[[], Result]], scheduler: str
) -> Generator[tuple[int, Result], None, None]:
    """Yields the place of a job and its result, in the order in which the jobs are done.

    scheduler  address of a Dask scheduler, "tcp://host:port"

    Another worker does the jobs of a lost worker, and each result is yielded once. Raises
    WorkerError without a scheduler or a worker, WorkersLostError if the scheduler is lost.
    """
    import distributed
    from distributed.comm.core import CommClosedError
    from distributed.scheduler import KilledWorker

    client = _connect(scheduler)
    try:
        _need_workers(client, scheduler)
        futures = client.map(_call, jobs, pure=False)
        places = {future.key: place for place, future in enumerate(futures)}
        for future in distributed.as_completed(futures, loop=client.loop):
            yield places[future.key], future.result()
            future.release()
    except (distributed.CancelledError, CommClosedError) as error:
        raise WorkersLostError(f"lost connection to the Dask scheduler at {scheduler}") from error
    except KilledWorker as error:
        raise WorkersLostError("the same run ended several workers") from error
    except ImportError as error:
        raise WorkerError(f"a worker cannot import sigmahat: {error}; install it there") from error
    finally:
        client.close(timeout=1)


def _call(job: Callable[[], Result]) -> Result:
    return job()


def _connect(scheduler: str) -> Any:
    import distributed

    for name in ("distributed", "distributed.client"):  # important errors are raised here
        logging.getLogger(name).setLevel(logging.CRITICAL)
    try:
        # A client would wait for ever for a reply of another program at this address.
        asyncio.run(asyncio.wait_for(_ask(scheduler), _CONNECT))
        return distributed.Client(scheduler, timeout=_CONNECT, set_as_default=False)
    except (OSError, ValueError, TimeoutError, asyncio.TimeoutError, MemoryError) as error:
        # MemoryError: Dask takes the first bytes of another protocol for the length of a message.
        raise WorkerError(
            f"no Dask scheduler at {scheduler}; start one with `dask scheduler`, "
            "which prints its address"
        ) from error


async def _ask(scheduler: str) -> None:
    import distributed

    async with distributed.rpc(scheduler) as remote:
        await remote.identity()


def _need_workers(client: Any, scheduler: str) -> None:
    try:
        client.wait_for_workers(1, timeout=_CONNECT)
    except TimeoutError as error:
        raise WorkerError(
            f"the scheduler at {scheduler} has no workers; start one with `dask worker {scheduler}`"
        ) from error
