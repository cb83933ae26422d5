"""What is installed of this package: its FMUs and its version."""

from __future__ import annotations

import sysconfig
from importlib import metadata
from pathlib import Path


def fmu(name: str) -> Path:
    """Path of an FMU of this installation, for example ``fmu("StiffnessEstimator")``.

    Raises ``FileNotFoundError`` if it was not built or there is no FMU of this name.
    """
    folder = Path(__file__).parents[1] / "fmus"
    if not folder.is_dir():  # the package runs from its sources, see cmake/PythonEnvironment.cmake
        folder = Path(sysconfig.get_path("data")) / "share" / "sigmahat"
    path = folder / f"{name}.fmu"
    if not path.is_file():
        found = ", ".join(sorted(p.stem for p in folder.glob("*.fmu"))) or "no FMU"
        raise FileNotFoundError(f"no {name}.fmu in {folder}, which holds {found}")
    return path


def version() -> str:
    """Version of the package, for example "0.1.0"."""
    return metadata.version("sigmahat")
