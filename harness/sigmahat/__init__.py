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

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from sigmahat.export.plant_fmu import PlantVariable, write_plant_fmu
    from sigmahat.fmi.installed import fmu
    from sigmahat.fmi.instance import FmuError
    from sigmahat.fmi.master import Estimator, Plant, Recording, Series, simulate
    from sigmahat.identification.identify import Identified, Quantity, identify
    from sigmahat.logs.configuration import Configuration, Port, Time, read_configuration
    from sigmahat.logs.errors import LogError
    from sigmahat.logs.estimate import Estimate, estimate
    from sigmahat.logs.log import Log
    from sigmahat.logs.readers.formats import open_log
    from sigmahat.paper.scenarios import scenario
    from sigmahat.plants.equations import PlantEquations, encoder
    from sigmahat.runs.engine import run
    from sigmahat.runs.metrics import Indices, indices, mean_error, mse, msrep
    from sigmahat.runs.scenario import Comparison, Scenario, Sine, Sines

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
    "fmi.installed": ("fmu",),
    "fmi.master": ("Estimator", "Plant", "Recording", "Series", "simulate"),
    "identification.identify": ("Identified", "Quantity", "identify"),
    "logs.configuration": ("Configuration", "Port", "Time", "read_configuration"),
    "logs.errors": ("LogError",),
    "logs.estimate": ("Estimate", "estimate"),
    "logs.readers.formats": ("open_log",),
    "logs.log": ("Log",),
    "export.plant_fmu": ("PlantVariable", "write_plant_fmu"),
    "plants.equations": ("PlantEquations", "encoder"),
    "paper.scenarios": ("scenario",),
    "runs.engine": ("run",),
    "runs.metrics": ("Indices", "indices", "mean_error", "mse", "msrep"),
    "runs.scenario": ("Comparison", "Scenario", "Sine", "Sines"),
    "fmi.instance": ("FmuError",),
}


def __getattr__(name: str) -> Any:
    """Public names are imported when they are used: the command line has to start at once."""
    if name == "__version__":
        from sigmahat.fmi.installed import version

        return version()
    for home, names in _HOMES.items():
        if name in names:
            return getattr(import_module(f"sigmahat.{home}"), name)
    raise AttributeError(f"module 'sigmahat' has no attribute {name!r}")


def __dir__() -> list[str]:
    return __all__
