"""Programs for other processors, built with the toolchains of cmake/ and run in QEMU."""

import os
import subprocess
import tempfile
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from c_sources import REPOSITORY
from gate import need, need_of_environment


@dataclass(frozen=True)
class Target:
    """A processor, and the tools that must be installed to compile for it and to emulate it."""

    toolchain: str | None
    """File in cmake/toolchains; None for this machine."""
    tools: tuple[str, ...] = ()


_CORTEX_M = ("arm-none-eabi-gcc", "qemu-system-arm")
HOST = Target(None)
TARGETS = {
    "Cortex-M4F": Target("cortex-m4", _CORTEX_M),
    "Cortex-M7": Target("cortex-m7", _CORTEX_M),
    "aarch64": Target("aarch64", ("aarch64-linux-gnu-gcc", "qemu-aarch64")),
}


@cache
def cross_build(
    project: str, target: Target, real: str, folder: Path, more: tuple[str, ...] = ()
) -> Path:
    """Builds a project for a target, with SH_REAL = real. Returns the build tree.

    project  in the repository, or an absolute path
    more     variables of CMake, as SH_MAX_N=2
    """
    for tool in target.tools:
        need(tool)
    tree = Path(tempfile.mkdtemp(dir=folder))
    toolchain = REPOSITORY / "cmake" / "toolchains" / f"{target.toolchain}.cmake"
    run(
        *("cmake", "-S", str(REPOSITORY / project), "-B", str(tree), "-G", "Ninja"),
        *(f"-DCMAKE_MAKE_PROGRAM={need_of_environment('ninja')}", f"-DSH_REAL={real}"),
        "-DCMAKE_BUILD_TYPE=Release",
        *(["--toolchain", str(toolchain)] if target.toolchain else []),
        *(f"-D{each}" for each in more),
    )
    run("cmake", "--build", str(tree))
    return tree


def run(
    *command: str | Path, cwd: Path | None = None, environment: Mapping[str, str] | None = None
) -> str:
    """Runs a command, which must succeed within 5 minutes. Returns what it printed.

    environment  variables besides those of this process
    """
    done = subprocess.run(
        [str(part) for part in command],
        cwd=cwd,
        env={**os.environ, **(environment or {})},
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        timeout=300,
    )
    assert done.returncode == 0, done.stdout
    return done.stdout


def replay(
    tree: Path,
    measurements: NDArray[np.float64],
    configuration: str,
    folder: Path,
    estimate: np.dtype[Any],
) -> NDArray[np.void]:
    """Runs a build of tests/replay. Returns the estimate of each tick, of this type."""
    measurements.astype("<f8").tofile(folder / "log")
    program, arguments = str(tree / "replay"), ["log", "out", configuration]
    command = [part for part in (tree / "emulator.txt").read_text().split(";") if part]
    if command and command[-1] == "-kernel":  # there is no operating system that passes arguments
        run(*command, program, "-append", " ".join(arguments), cwd=folder)
    else:
        run(*command, program, *arguments, cwd=folder)
    rows = np.fromfile(folder / "out", estimate)
    assert len(rows) == len(measurements)
    return rows
