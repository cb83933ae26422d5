"""The library in C that comes with the package: the loop over samples, estimators over arrays.

Python calls the library with ctypes, so that other threads of Python can run meanwhile.
"""

import ctypes
from functools import lru_cache
from typing import Any

import fmpy

from sigmahat.fmi.installed import folder
from sigmahat.fmi.model import FmuError

_INTERFACE = 4  # as in harness/native/sample_loop.c
_POINTER, _SIZE, _NUMBER = ctypes.c_void_p, ctypes.c_size_t, ctypes.c_uint
_FUNCTIONS: dict[str, tuple[Any, list[Any]]] = {
    "sh_sample_loop": (_SIZE, [_POINTER, *[_SIZE] * 3]),
    "sh_joint_guid": (ctypes.c_char_p, []),
    "sh_joint_size": (_SIZE, []),
    "sh_joint_place": (_SIZE, [_NUMBER]),
    "sh_joint_default": (None, [_POINTER, ctypes.c_double]),
    "sh_joint_set": (None, [_POINTER, _NUMBER, ctypes.c_double]),
    "sh_joint_check": (ctypes.c_int, [_POINTER, _POINTER]),
    "sh_joint_start": (None, [_POINTER]),
    "sh_joint_evaluate": (None, [_POINTER, _SIZE, *[_POINTER] * 3]),
    "sh_joint_covariance": (ctypes.c_int, [_POINTER, _SIZE, *[_POINTER] * 5]),
    "sh_joints_saved_size": (_SIZE, [_SIZE]),
    "sh_joints_save": (None, [_POINTER, _SIZE, _SIZE, _POINTER]),
    "sh_joints_restore": (ctypes.c_char_p, [_POINTER, _SIZE, _SIZE, _POINTER, _SIZE]),
    "sh_joints_run": (None, [_POINTER, *[_SIZE] * 5, *[_POINTER] * 6, _SIZE]),
}
"""Result and arguments of the functions in harness/native/*.h."""


@lru_cache
def library() -> ctypes.CDLL:
    """The library of this installation. Raises FmuError if none has the right version."""
    path = folder() / f"sigmahat_native{fmpy.sharedLibraryExtension}"
    try:
        found = ctypes.CDLL(str(path))
        if found.sh_native_interface() != _INTERFACE:
            raise OSError("it is of another version")
        for name, (result, arguments) in _FUNCTIONS.items():
            function = getattr(found, name)
            function.restype, function.argtypes = result, arguments
    except (OSError, AttributeError) as error:
        raise FmuError(f"{path}: cannot load this ({error}); install or build it again") from error
    return found
