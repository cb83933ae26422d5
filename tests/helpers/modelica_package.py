"""The Modelica package: its files, and models of it in rumoca."""

import tempfile
from pathlib import Path
from typing import Any

import rumoca

import sigmahat
from c_sources import REPOSITORY
from sigmahat_build.modelica import KEYWORDS, contents

_FOLDER = tempfile.TemporaryDirectory()
PACKAGE = Path(_FOLDER.name) / "Sigmahat"
for _name, _text in contents(
    REPOSITORY / "modelica" / "Sigmahat", REPOSITORY / "modelDescription", sigmahat.__version__
).items():
    (PACKAGE / _name).parent.mkdir(parents=True, exist_ok=True)
    (PACKAGE / _name).write_bytes(_text)
FILES = sorted(PACKAGE.rglob("*.mo"))
NO_NOISE = "redeclare function drawNoise = Sigmahat.Plants.noNoise"
"""Replacements for rumoca, which calls no C."""


def modification(**values: Any) -> str:
    """Modelica modification "motor(B=1), init(q=2)" from values by their names in the FMU."""
    groups: dict[str, list[str]] = {}
    for name, value in values.items():
        group, _, last = name.rpartition(".")
        groups.setdefault(KEYWORDS.get(group, group), []).append(f"{last}={value!r}")
    return ", ".join(f"{group}({', '.join(each)})" for group, each in groups.items())


def compiled(text: str, model: str = "Test", package: Path = PACKAGE) -> rumoca.Model:
    """A model that uses the package, compiled. The model has as many equations as unknowns."""
    found = rumoca.Session(roots=[str(package)]).loads(text, model=model)
    assert found.structure().is_balanced
    return found
