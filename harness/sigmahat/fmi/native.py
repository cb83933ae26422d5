"""The library in C that comes with the package: the loop over samples, estimators over arrays.

It is called with ctypes, which lets other threads of Python run meanwhile.
"""

from __future__ import annotations

import ctypes
import logging
from functools import lru_cache

from sigmahat.fmi.installed import folder

_EXTENSIONS = (".so", ".dylib", ".dll")
_INTERFACE = 1  # as in harness/native/version.c

_log = logging.getLogger("sigmahat")


@lru_cache
def library() -> ctypes.CDLL | None:
    """The library of this installation; None if it has none for this platform.

    If there is one that does not work, a warning says so.
    """
    for extension in _EXTENSIONS:
        path = folder() / f"sigmahat_native{extension}"
        if not path.is_file():
            continue
        try:
            found = ctypes.CDLL(str(path))
            if found.sh_native_interface() == _INTERFACE:
                return found
            reason = "it is of another version"
        except (OSError, AttributeError) as error:
            reason = str(error)
        _log.warning("%s cannot be used, so simulations are slow: %s; install again", path, reason)
    return None
