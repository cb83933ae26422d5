"""FMUs that this process has unpacked and read: a process that makes many runs does it once."""

from __future__ import annotations

from functools import lru_cache
from pathlib import Path

from sigmahat.fmi.instance import Fmu


def opened(path: Path) -> Fmu:
    """An FMU, unpacked until the process ends. Raises what Fmu does.

    A file that has changed since the last call is unpacked again.
    """
    status = path.stat()
    return _opened(path.resolve(), status.st_mtime_ns, status.st_size)


@lru_cache(maxsize=32)
def _opened(path: Path, _changed: int, _size: int) -> Fmu:
    return Fmu(path)
