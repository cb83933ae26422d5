"""The C library in double and in single precision, compiled as a controller would compile it."""

from __future__ import annotations

import subprocess
import sys
import tempfile
from functools import cache
from pathlib import Path

from c_library import REPOSITORY, Library
from c_sources import FOLDERS, SOURCES
from gate import need

REALS = ("double", "float")


@cache
def compile_library(parent: Path, real: str) -> Library:
    """The library with `real` as the type of its numbers, compiled in a new folder of `parent`."""
    folder = Path(tempfile.mkdtemp(dir=parent))
    suffix = ".dylib" if sys.platform == "darwin" else ".so"
    drivers = REPOSITORY / "tests" / "drivers"
    subprocess.run(
        [
            *(need("cc"), "-std=c99", "-O1", "-ffp-contract=off", "-fPIC", "-shared"),
            *(f"-DSH_REAL={real}", f"-I{drivers}", *(f"-I{each}" for each in FOLDERS)),
            *map(str, [*SOURCES, drivers / "run.c"]),
            *("-lm", "-o", str(folder / f"libsigmahat_test_driver{suffix}")),
        ],
        check=True,
    )
    return Library(folder, real)
