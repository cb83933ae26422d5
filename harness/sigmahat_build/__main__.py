"""Runs the steps of the build for CMake; each step is a process with few imports."""

from importlib import import_module
from pathlib import Path
from typing import Any

import click

_STEPS = {
    "describe": "descriptions.write template out sources... --version --struct --storage",
    "equations": "plant_functions.write template folder",
    "pack": "packing.pack fmu sources... --fmi --described --binary --licence --shown",
    "document": "documentation.write template out --version",
    "system": "system.write ssp plant estimator --templates --version",
    "release": "cross_compiler.release fmu out --cache",
    "integers": "integers.write fmu out",
    "distribute": "distribution.write out contents... --project --sources... --includes... --cache",
    "bill": "bill.write out release --version",
    "web": "web.write out plant estimator --page --sources... --includes... --cache",
    "amalgamate": "amalgamation.write out sources... --interface --licence --version",
    "parameters": "parameter_table.write template out",
    "modelica": "modelica.write out library sources... --descriptions --licence --version",
}
"""The function of each step, and its arguments; an argument with "..." may be repeated."""
_KINDS: dict[str, Any] = {"--version": str, "--struct": str, "--storage": str, "--fmi": int}
"""Types of the options that are no paths."""


def _step(name: str, spec: str) -> click.Command:
    function, *arguments = spec.split()
    module, _, called = function.partition(".")
    parameters: list[click.Parameter] = []
    for listed in arguments:
        argument = listed.removesuffix("...")
        several = listed.endswith("...")
        kind = _KINDS.get(argument, click.Path(path_type=Path))
        if argument.startswith("--"):
            parameters.append(click.Option([argument], type=kind, required=True, multiple=several))
        else:
            parameters.append(click.Argument([argument], type=kind, nargs=-1 if several else 1))

    def run(**values: Any) -> None:
        getattr(import_module(f"sigmahat_build.{module}"), called)(**values)

    return click.Command(name, params=parameters, callback=run)


click.Group(commands=[_step(name, spec) for name, spec in _STEPS.items()])()
