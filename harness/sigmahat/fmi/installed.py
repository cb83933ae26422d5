"""Installed parts of this package: its FMUs, its version, and optional packages."""

import re
import shlex
import sys
import sysconfig
from importlib import metadata
from pathlib import Path


def folder() -> Path:
    """Folder of the FMUs of this installation, and of the library in C."""
    in_wheel = Path(__file__).parents[1] / "fmus"
    if in_wheel.is_dir():
        return in_wheel
    # The package runs from its sources, see cmake/PythonEnvironment.cmake.
    return Path(sysconfig.get_path("data")) / "share" / "sigmahat"


def fmu(name: str) -> Path:
    """Path of an FMU of this installation, for example ``fmu("StiffnessEstimator")``.

    Raises ``FileNotFoundError`` if the FMU is not built or no FMU has this name.
    """
    path = folder() / f"{name}.fmu"
    if not path.is_file():
        found = ", ".join(sorted(p.stem for p in folder().glob("*.fmu"))) or "no FMU"
        raise FileNotFoundError(f"no {name}.fmu in {folder()}; this folder contains {found}")
    return path


def version() -> str:
    """Version of the package, for example "1.0.0"."""
    return metadata.version("sigmahat")


_DISTRIBUTIONS = {"foxglove": "foxglove-sdk"}  # distributions with another name


def how_to_install(package: str | None) -> str | None:
    """Returns one line on a missing package that sigmahat or one of its extras requires.

    None for any other package. pip finds sigmahat installed, and adds only the missing packages.
    """
    distribution = _DISTRIBUTIONS.get(package or "", package)
    pattern = re.compile(r"""([\w.-]+)[^;]*(?:;\s*extra\s*==\s*["'](.+)["'])?""")
    matches = [pattern.match(each) for each in metadata.requires("sigmahat") or ()]
    extras = [match[2] for match in matches if match and match[1] == distribution]
    if not extras:
        return None
    extra = package if package in extras else extras[0]  # several may require it
    wanted = f"sigmahat[{extra}]" if extra else "sigmahat"
    command = shlex.join([sys.executable, "-m", "pip", "install", wanted])
    return f"{distribution} is not installed; to install it: {command}"
