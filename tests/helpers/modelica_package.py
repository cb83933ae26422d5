"""The Modelica package: its files, its classes as pymoca reads them, and models of it in rumoca."""

import tempfile
from collections.abc import Iterator, Mapping
from functools import cache
from pathlib import Path
from typing import Any

import pymoca.ast
import pymoca.parser
import rumoca

import sigmahat
from c_sources import REPOSITORY
from sigmahat.export.modelica import KEYWORDS, contents

_FOLDER = tempfile.TemporaryDirectory()
PACKAGE = Path(_FOLDER.name) / "Sigmahat"
for _name, _text in contents(
    REPOSITORY / "modelica" / "Sigmahat", REPOSITORY / "modelDescription", sigmahat.__version__
).items():
    (PACKAGE / _name).parent.mkdir(parents=True, exist_ok=True)
    (PACKAGE / _name).write_bytes(_text)
FILES = sorted(PACKAGE.rglob("*.mo"))
NO_NOISE = "redeclare function drawNoise = Sigmahat.Plants.noNoise"
"""For rumoca, which calls no C."""


@cache
def classes() -> Mapping[str, pymoca.ast.Class]:
    """All classes of the package by their names in it, such as "Plants.AwasPlant"."""
    found: dict[str, pymoca.ast.Class] = {}
    for file in FILES:
        parts = file.relative_to(PACKAGE).with_suffix("").parts
        path = [part for part in parts if part != "package"]
        within = pymoca.parser.parse(file.read_text(encoding="utf-8")).classes["Sigmahat"]
        for name in path:
            within = within.classes[name]
        if path:
            found |= dict(_with_inner(".".join(path), within))
    return found


def _with_inner(name: str, of: pymoca.ast.Class) -> Iterator[tuple[str, pymoca.ast.Class]]:
    yield name, of
    for inner, each in of.classes.items():
        yield from _with_inner(f"{name}.{inner}", each)


def modification(**values: Any) -> str:
    """A modification from values by dotted name: "motor(B=1), init(q=2)"."""
    groups: dict[str, list[str]] = {}
    for name, value in values.items():
        group, _, last = in_modelica(name).rpartition(".")
        groups.setdefault(group, []).append(f"{last}={value!r}")
    return ", ".join(f"{group}({', '.join(each)})" for group, each in groups.items())


def in_modelica(name: str) -> str:
    """The name in the package of a parameter of an FMU."""
    group, dot, last = name.partition(".")
    return f"{KEYWORDS.get(group, group)}{dot}{last}"


def compiled(text: str, model: str = "Test", package: Path = PACKAGE) -> rumoca.Model:
    """A model that uses the package, compiled. It has as many equations as unknowns."""
    found = rumoca.Session(roots=[str(package)]).loads(text, model=model)
    assert found.structure().is_balanced
    return found
