"""The library in C that comes with the package: the loop over samples, estimators over arrays.

Python calls the library with ctypes, so that other threads of Python can run meanwhile.
"""

import ctypes
import logging
from functools import lru_cache
from typing import Any

import fmpy

from sigmahat.fmi.installed import folder

_INTERFACE = 2  # as in harness/native/sample_loop.c
_POINTER, _SIZE, _NUMBER = ctypes.c_void_p, ctypes.c_size_t, ctypes.c_uint
_FUNCTIONS: dict[str, tuple[Any, list[Any]]] = {
    "sh_sample_loop": (_SIZE, [_POINTER, *[_SIZE] * 3]),
    "sh_joint_guid": (ctypes.c_char_p, []),
    "sh_joint_size": (_SIZE, []),
    "sh_joint_place": (_SIZE, [_NUMBER]),
    "sh_joint_default": (None, [_POINTER]),
    "sh_joint_set": (None, [_POINTER, _NUMBER, ctypes.c_double]),
    "sh_joint_check": (ctypes.c_int, [_POINTER, _POINTER]),
    "sh_joint_start": (None, [_POINTER]),
    "sh_joint_evaluate": (None, [_POINTER, _SIZE, *[_POINTER] * 3]),
    "sh_joints_run": (None, [_POINTER, *[_SIZE] * 5, *[_POINTER] * 6, _SIZE]),
}
"""Result and arguments of the functions in harness/native/*.h."""

_log = logging.getLogger("sigmahat")


@lru_cache
def library() -> ctypes.CDLL | None:
    """The library of this installation; None without a library for this platform.

    A warning reports a library that does not work.
    """
    path = folder() / f"sigmahat_native{fmpy.sharedLibraryExtension}"
    if not path.is_file():
        return None
    try:
        found = ctypes.CDLL(str(path))
        if found.sh_native_interface() == _INTERFACE:
            for name, (result, arguments) in _FUNCTIONS.items():
                function = getattr(found, name)
                function.restype, function.argtypes = result, arguments
            return found
        reason = "it is of another version"
    except (OSError, AttributeError) as error:
        reason = str(error)
    _log.warning("%s cannot be used, so simulations are slow: %s; install again", path, reason)
    return None
