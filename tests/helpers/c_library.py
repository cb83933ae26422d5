"""The C library for Python, with the declarations of its headers and with numpy arrays."""

import re
import subprocess
import sys
import tempfile
from collections.abc import Mapping, Sequence
from functools import cache
from pathlib import Path
from typing import Any

import cffi
import numpy as np
from numpy.typing import NDArray

from c_sources import FOLDERS, HEADERS, REPOSITORY, SOURCES
from controllers import run
from gate import need

Array = NDArray[np.float64]
DRIVERS = REPOSITORY / "tests" / "drivers"
FILE = f"libsigmahat_test_driver{'.dylib' if sys.platform == 'darwin' else '.so'}"
REALS = ("double", "float")
LONG = "_Float64x"
"""long double, for which glibc has functions by this name."""
_WITHOUT_DECLARATIONS = ("real_math.h", "pair.h")
"""Headers with nothing but macros and inline functions. These headers include headers of the
standard library, which cffi cannot read.
"""

_FORMATS = {"double": "f8", "float": "f4", "long double": "g", "int": "i4"}
MEASUREMENTS = ("theta", "q", "theta_c", "tau", "tau_e_sensor")


def declarations(*headers: Path) -> str:
    """The declarations of headers and of all that they include, from the C preprocessor."""
    folders = {*FOLDERS, *(header.parent for header in headers)}
    done = subprocess.run(
        [need("cc"), "-E", "-P", "-x", "c", *(f"-I{folder}" for folder in folders), "-"],
        input="".join(f'#include "{header.name}"\n' for header in headers),
        capture_output=True,
        text=True,
        check=True,
    )
    # cffi reads no function bodies.
    return re.sub(r"^static inline .*?^}", "", done.stdout, flags=re.DOTALL | re.MULTILINE)


@cache
def load(build: Path) -> "Library":
    """The library of a build tree."""
    return Library(build)


class Library:
    """The estimator library, and the loops over ticks in `drivers/run.c`."""

    def __init__(self, build: Path, real: str = "double") -> None:
        self.ffi, self.real = cffi.FFI(), real
        own = (header for header in HEADERS if header.name not in _WITHOUT_DECLARATIONS)
        text = declarations(*own, DRIVERS / "run.h")
        self.ffi.cdef("typedef long double _Float64x;" + text.replace("double", real))
        self.lib: Any = self.ffi.dlopen(str(build / FILE))

    def new(self, struct: str, **values: Any) -> Any:
        """A new struct with the given fields; all others are zero."""
        return self.ffi.new(f"{struct} *", values)

    @property
    def start(self) -> Any:
        """The function `sh_estimator_start`, whose name for the linker contains the sizes."""
        (name,) = (name for name in dir(self.lib) if name.startswith("sh_estimator_start"))
        return getattr(self.lib, name)

    def pointer(self, array: Array) -> Any:
        """A pointer to a contiguous array of reals, valid as long as the array exists."""
        return self.ffi.cast(f"{self.real} *", self.ffi.from_buffer(array, require_writable=False))

    def dtype(self, struct: str) -> np.dtype[Any]:
        """The numpy type with the layout of a struct of doubles, integers and arrays of them."""
        declared = self.ffi.typeof(struct)
        names, formats, offsets = [], [], []
        for name, field in declared.fields or []:
            item, shape = field.type, []
            while item.kind == "array":
                shape.append(item.length)
                item = item.item
            names.append(name)
            formats.append((_FORMATS[item.cname], tuple(shape)))
            offsets.append(field.offset)
        size = self.ffi.sizeof(struct)
        return np.dtype({"names": names, "formats": formats, "offsets": offsets, "itemsize": size})

    def parameters(self, values: Mapping[str, Any]) -> Any:
        """A new `sh_parameters *` with the defaults, except for `values` by dotted name."""
        p = self.ffi.new("sh_parameters *")
        self.lib.sh_parameters_default(p)
        for name, value in values.items():
            self.set(p, name, value)
        return p

    def set(self, p: Any, name: str, value: Any) -> None:
        """Sets a parameter by its dotted name."""
        *groups, last = name.split(".")
        for group in groups:
            p = getattr(p, group)
        setattr(p, last, value)

    def violation(self, p: Any) -> tuple[str, float, str] | None:
        """Name, value and range of the first parameter out of range, None if there is none."""
        violation = self.new("sh_violation")
        if self.lib.sh_parameters_check(p, violation) == 0:
            return None
        name, allowed = (
            self.ffi.string(text).decode() for text in (violation.name, violation.range)
        )
        return name, violation.value, allowed


@cache
def compile_library(parent: Path, real: str, *flags: str) -> Library:
    """The library with `real`, one of REALS or LONG, compiled in a new folder of `parent`.

    Compiles the library in plain C, as for a controller.
    """
    folder = Path(tempfile.mkdtemp(dir=parent))
    run(
        *(need("cc"), "-std=gnu99", "-O1", "-ffp-contract=off", "-fPIC", "-shared", *flags),
        *("-D_GNU_SOURCE", f"-DSH_FOR_{LONG}(a,b)=a##f64x", f"-DSH_IS_{LONG}=0"),
        *(f"-DSH_REAL={real}", f"-I{DRIVERS}", *(f"-I{each}" for each in FOLDERS)),
        *(*SOURCES, DRIVERS / "run.c"),
        *("-lm", "-o", str(folder / FILE)),
    )
    return Library(folder, real)


@cache
def type_of_estimate(build: Path, real: str) -> np.dtype[Any]:
    """The layout of `sh_estimate` is the same on every processor of the tests."""
    return Library(build, real).dtype("sh_estimate")


def covariance(P: Any) -> Array:
    """P = U D U' of a `sh_ud_factor` [size: P.size x P.size]. least_squares.c says where U is."""
    U = np.eye(P.size)
    for j in range(P.size):
        first = j * j // 2
        U[:j, j] = list(P.U[first : first + j])
    product: Array = (U * diagonal(P)) @ U.T
    return product


def diagonal(P: Any) -> Array:
    """D of a `sh_ud_factor` [size: P.size]."""
    return np.array([column.D for column in P.columns[0 : P.size]])


class Estimator:
    """One estimator with its parameters and its last estimate."""

    def __init__(self, library: Library, values: Mapping[str, Any]) -> None:
        self.library = library
        self.parameters = library.parameters(values)
        problem = library.violation(self.parameters)
        if problem:
            raise ValueError("{} is {}, allowed: {}".format(*problem))
        self.state = library.new("sh_estimator")
        self.estimate = library.new("sh_estimate")
        library.start(self.state, self.parameters, self.estimate)

    def tick(self, measurement: Sequence[float] | Array) -> bool:
        """Runs a tick with theta, q, theta_c, tau, tau_e_sensor; False if it was skipped."""
        z = self.library.new(
            "sh_measurement", **dict(zip(MEASUREMENTS, map(float, measurement), strict=True))
        )
        lib = self.library.lib
        return bool(lib.sh_estimator_tick(self.state, self.parameters, z, self.estimate) == 0)

    def lasting(self) -> bytes:
        """The state as bytes, without the work arrays, which have no meaning between ticks."""
        ffi = self.library.ffi
        state = ffi.new("sh_estimator *", self.state[0])
        if self.parameters.method == self.library.lib.SH_METHOD_PAPER2011:
            P = state.method.paper2011.rls.P
            for column in P.columns:
                column.f = 0.0
            ffi.memmove(P.PF, bytes(ffi.sizeof(P.PF)), ffi.sizeof(P.PF))
        return bytes(ffi.buffer(state))

    def run(self, measurements: Array) -> NDArray[np.void]:
        """Runs a tick for each row of measurements [size: ticks x 5]. Returns all estimates."""
        record = np.zeros(len(measurements), self.library.dtype("sh_estimate"))
        self._drive(measurements, len(measurements), record)
        return record

    def repeat(self, measurements: Array, ticks: int) -> int:
        """Runs ticks over repeated measurements. Returns the number of valid ticks."""
        return self._drive(measurements, ticks, None)

    def _drive(self, measurements: Array, ticks: int, record: NDArray[np.void] | None) -> int:
        ffi, p = self.library.ffi, self.parameters
        z = np.zeros(len(measurements), self.library.dtype("sh_measurement"))
        for i, name in enumerate(MEASUREMENTS):
            z[name] = measurements[:, i]
        samples = ffi.from_buffer("sh_measurement[]", z)
        rows = ffi.NULL if record is None else ffi.from_buffer("sh_estimate[]", record)
        run = self.library.lib.test_run
        good: int = run(self.state, p, samples, len(z), ticks, self.estimate, rows)
        return good
