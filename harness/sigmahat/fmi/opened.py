"""FMUs that this process has unpacked and read: all runs of a process share an unpacked FMU."""

from __future__ import annotations

import os
from functools import lru_cache
from pathlib import Path

from sigmahat.fmi.installed import fmu as installed_fmu
from sigmahat.fmi.instance import Fmu


def installed(name: str) -> Fmu:
    """An FMU of this installation. Raises FileNotFoundError if no FMU has this name."""
    return opened(installed_fmu(name))


def named(fmu: str) -> Fmu:
    """An FMU of this installation by its name, or the FMU at a path that ends in .fmu.

    Raises what `installed` and `opened` do.
    """
    path = Path(fmu)
    return opened(path) if path.suffix.lower() == ".fmu" else installed(fmu)


def opened(path: Path) -> Fmu:
    """An FMU, unpacked until the process ends. Raises what Fmu does.

    The FMU is unpacked again if the file has changed since the last call, or if the FMU allows one
    instance per process only. Such an FMU may need its library loaded again.
    """
    status = path.stat()
    fmu = _opened(path.resolve(), status.st_mtime_ns, status.st_size)
    once = fmu.description.coSimulation.canBeInstantiatedOnlyOncePerProcess
    return Fmu(path) if once else fmu


@lru_cache(maxsize=32)
def _opened(path: Path, _changed: int, _size: int) -> Fmu:
    return Fmu(path)


if hasattr(os, "register_at_fork"):  # the folders belong to the parent process
    os.register_at_fork(after_in_child=_opened.cache_clear)
