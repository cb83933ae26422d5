"""The C library in other precisions, in plain C as a controller compiles it."""

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
LONG = "_Float64x"
"""long double, for which glibc has functions by this name."""


@cache
def compile_library(parent: Path, real: str, *flags: str) -> Library:
    """The library with `real`, one of REALS or LONG, compiled in a new folder of `parent`."""
    folder = Path(tempfile.mkdtemp(dir=parent))
    suffix = ".dylib" if sys.platform == "darwin" else ".so"
    drivers = REPOSITORY / "tests" / "drivers"
    subprocess.run(
        [
            *(need("cc"), "-std=gnu99", "-O1", "-ffp-contract=off", "-fPIC", "-shared", *flags),
            *("-D_GNU_SOURCE", f"-DSH_FOR_{LONG}(a,b)=a##f64x", f"-DSH_IS_{LONG}=0"),
            *(f"-DSH_REAL={real}", f"-I{drivers}", *(f"-I{each}" for each in FOLDERS)),
            *map(str, [*SOURCES, drivers / "run.c"]),
            *("-lm", "-o", str(folder / f"libsigmahat_test_driver{suffix}")),
        ],
        check=True,
    )
    return Library(folder, real)
