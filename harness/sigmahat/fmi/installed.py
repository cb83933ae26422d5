"""What is installed of this package: its FMUs, its version, and packages that it may lack."""

from __future__ import annotations

import re
import shlex
import sys
import sysconfig
from importlib import metadata
from pathlib import Path


def folder() -> Path:
    """Where the FMUs of this installation are, and the library in C."""
    in_wheel = Path(__file__).parents[1] / "fmus"
    if in_wheel.is_dir():
        return in_wheel
    # The package runs from its sources, see cmake/PythonEnvironment.cmake.
    return Path(sysconfig.get_path("data")) / "share" / "sigmahat"


def fmu(name: str) -> Path:
    """Path of an FMU of this installation, for example ``fmu("StiffnessEstimator")``.

    Raises ``FileNotFoundError`` if it was not built or there is no FMU of this name.
    """
    path = folder() / f"{name}.fmu"
    if not path.is_file():
        found = ", ".join(sorted(p.stem for p in folder().glob("*.fmu"))) or "no FMU"
        raise FileNotFoundError(f"no {name}.fmu in {folder()}, which holds {found}")
    return path


def version() -> str:
    """Version of the package, for example "0.1.0"."""
    return metadata.version("sigmahat")


_DISTRIBUTIONS = {"foxglove": "foxglove-sdk"}
"""Where a package is in a distribution of another name."""


def how_to_install(package: str | None) -> str | None:
    """One line for a package that sigmahat requires, itself or with an extra, and that is missing.

    None for any other package. pip finds sigmahat itself installed, and adds only what is missing.
    """
    for requirement in metadata.requires("sigmahat") or ():
        match = re.match(r"""([\w.-]+)[^;]*(?:;\s*extra\s*==\s*["'](.+)["'])?""", requirement)
        if match and match[1] == _DISTRIBUTIONS.get(package or "", package):
            wanted = f"sigmahat[{match[2]}]" if match[2] else "sigmahat"
            command = shlex.join([sys.executable, "-m", "pip", "install", wanted])
            return f"{match[1]} is not installed; to install it: {command}"
    return None
