"""The library in C that comes with the package: the loop over samples, estimators over arrays.

It is called with ctypes, which lets other threads of Python run meanwhile.
"""

from __future__ import annotations

import ctypes
from functools import lru_cache

from sigmahat.fmi.installed import folder

_EXTENSIONS = (".so", ".dylib", ".dll")


@lru_cache
def library() -> ctypes.CDLL | None:
    """The library of this installation; None if it has none for this platform."""
    for extension in _EXTENSIONS:
        path = folder() / f"sigmahat_native{extension}"
        if path.is_file():
            try:
                return ctypes.CDLL(str(path))
            except OSError:  # of another platform
                continue
    return None
