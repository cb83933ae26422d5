"""Stiffness of flexible robot joints, estimated on line by FMUs and validated by co-simulation.

The FMUs of this installation, for any tool that reads them:

>>> import sigmahat
>>> sigmahat.fmu("StiffnessEstimator")  # doctest: +ELLIPSIS
...Path('.../StiffnessEstimator.fmu')

A scenario of the paper, and how well the stiffness was estimated:

>>> recording = sigmahat.run(sigmahat.scenario("table1"), seed=1)
>>> true, estimate = recording.plant["sigma"], recording.estimators["RESIDUAL"]["sigma"]
>>> found = sigmahat.indices(recording.t, true, estimate)
>>> found.msrep_settled < 1  # per cent
True

`simulate` steps plants and estimators of your own. A recorded log goes through `open_log`,
`read_configuration`, and `estimate` or `identify`. `write_plant_fmu` makes an FMU of equations; it
and `encoder` need the extra `plants` and a C compiler.

What is on this page is public, and nothing else: other modules may change with any version.
"""

from __future__ import annotations

import sysconfig
from importlib import import_module, metadata
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from sigmahat.cosimulation import Estimator, Plant, Recording, Series, simulate
    from sigmahat.identification import Identified, Quantity, identify
    from sigmahat.logs.configuration import Configuration, Port, Time, read_configuration
    from sigmahat.logs.errors import LogError
    from sigmahat.logs.estimate import Estimate, estimate
    from sigmahat.logs.files import open_log
    from sigmahat.logs.log import Log
    from sigmahat.metrics import Indices, indices, mean_error, mse, msrep
    from sigmahat.plants.fmu import PlantVariable, write_plant_fmu
    from sigmahat.plants.plant import PlantEquations, encoder
    from sigmahat.reproduce import run
    from sigmahat.scenarios import Comparison, Scenario, Sine, Sines, scenario
    from sigmahat.slave import FmuError

    __version__: str

__all__ = [
    "Comparison",
    "Configuration",
    "Estimate",
    "Estimator",
    "FmuError",
    "Identified",
    "Indices",
    "Log",
    "LogError",
    "Plant",
    "PlantEquations",
    "PlantVariable",
    "Port",
    "Quantity",
    "Recording",
    "Scenario",
    "Series",
    "Sine",
    "Sines",
    "Time",
    "__version__",
    "encoder",
    "estimate",
    "fmu",
    "identify",
    "indices",
    "mean_error",
    "mse",
    "msrep",
    "open_log",
    "read_configuration",
    "run",
    "scenario",
    "simulate",
    "write_plant_fmu",
]

_HOMES = {
    "cosimulation": ("Estimator", "Plant", "Recording", "Series", "simulate"),
    "identification": ("Identified", "Quantity", "identify"),
    "logs.configuration": ("Configuration", "Port", "Time", "read_configuration"),
    "logs.errors": ("LogError",),
    "logs.estimate": ("Estimate", "estimate"),
    "logs.files": ("open_log",),
    "logs.log": ("Log",),
    "metrics": ("Indices", "indices", "mean_error", "mse", "msrep"),
    "plants.fmu": ("PlantVariable", "write_plant_fmu"),
    "plants.plant": ("PlantEquations", "encoder"),
    "reproduce": ("run",),
    "scenarios": ("Comparison", "Scenario", "Sine", "Sines", "scenario"),
    "slave": ("FmuError",),
}


def fmu(name: str) -> Path:
    """Path of an FMU of this installation, for example ``fmu("StiffnessEstimator")``.

    Raises ``FileNotFoundError`` if it was not built or there is no FMU of this name.
    """
    folder = Path(__file__).with_name("fmus")
    if not folder.is_dir():  # the package runs from its sources, see cmake/PythonEnvironment.cmake
        folder = Path(sysconfig.get_path("data")) / "share" / "sigmahat"
    path = folder / f"{name}.fmu"
    if not path.is_file():
        found = ", ".join(sorted(p.stem for p in folder.glob("*.fmu"))) or "no FMU"
        raise FileNotFoundError(f"no {name}.fmu in {folder}, which holds {found}")
    return path


def __getattr__(name: str) -> Any:
    """Public names are imported when they are used: the command line has to start at once."""
    if name == "__version__":
        return metadata.version("sigmahat")
    for home, names in _HOMES.items():
        if name in names:
            return getattr(import_module(f"sigmahat.{home}"), name)
    raise AttributeError(f"module 'sigmahat' has no attribute {name!r}")


def __dir__() -> list[str]:
    return __all__
