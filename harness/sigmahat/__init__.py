"""Stiffness of flexible robot joints, estimated on line by FMUs and validated by co-simulation."""

import sysconfig
from importlib.metadata import version
from pathlib import Path

__version__ = version("sigmahat")


def fmu(name: str) -> Path:
    """Path of an FMU of this installation, for example ``fmu("StiffnessEstimator")``.

    Raises ``FileNotFoundError`` if it was not built or there is no FMU of this name.
    """
    folder = Path(sysconfig.get_path("data")) / "share" / "sigmahat"
    path = folder / f"{name}.fmu"
    if not path.is_file():
        found = ", ".join(sorted(p.stem for p in folder.glob("*.fmu"))) or "no FMU"
        raise FileNotFoundError(f"no {name}.fmu in {folder}, which holds {found}")
    return path
