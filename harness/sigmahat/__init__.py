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

import lazy_loader

# The list of public names is the stub beside this file. The public names are imported on first use,
# because the command line has to start at once.
_imported, _, _names = lazy_loader.attach_stub(__name__, __file__)

__all__ = sorted([*_names, "__version__"])


def __getattr__(name: str) -> object:
    """A public name. If a required package is missing, the error names it and its extra."""
    if name not in __all__:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}", name=name)
    from sigmahat.fmi import installed

    if name == "__version__":
        return installed.version()
    try:
        return _imported(name)
    except ModuleNotFoundError as error:
        text = installed.how_to_install(error.name)
        if text is None:
            raise
        raise ModuleNotFoundError(text, name=error.name) from error


def __dir__() -> list[str]:
    return __all__
