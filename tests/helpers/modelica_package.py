"""The Modelica package: its files, its classes as pymoca reads them, and models of it in rumoca."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from functools import cache
from pathlib import Path
from typing import Any

import pymoca.ast
import pymoca.parser
import rumoca

REPOSITORY = Path(__file__).resolve().parents[2]
PACKAGE = REPOSITORY / "modelica" / "Sigmahat"
FILES = sorted(PACKAGE.rglob("*.mo"))
KEYWORDS = {"initial": "init", "model": "nominal"}
"""Groups of parameters whose names in the FMUs are keywords of Modelica: their names there."""
NO_NOISE = "redeclare function drawNoise = Sigmahat.Plants.noNoise"
"""For rumoca, which calls no C."""


@cache
def classes() -> Mapping[str, pymoca.ast.Class]:
    """All classes of the package by their names in it, such as "Plants.AwasPlant"."""
    found: dict[str, pymoca.ast.Class] = {}
    for file in FILES:
        path = [
            *file.relative_to(PACKAGE).parent.parts,
            *([] if _is_package(file) else [file.stem]),
        ]
        within = pymoca.parser.parse(file.read_text(encoding="utf-8")).classes["Sigmahat"]
        for name in path:
            within = within.classes[name]
        if path:
            found |= dict(_with_inner(".".join(path), within))
    return found


def _is_package(file: Path) -> bool:
    return file.name == "package.mo"


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


def external_arguments(file: str, function: str) -> list[str]:
    """The arguments with which a file of the package calls a C function."""
    text = (PACKAGE / file).read_text(encoding="utf-8")
    call = re.search(rf'external "C" (?:\w+ = )?{function}\(([^)]*)\)', text)
    assert call, function
    return [argument.strip() for argument in call[1].split(",")]


def compiled(text: str, model: str = "Test") -> rumoca.Model:
    """A model that uses the package, compiled."""
    return rumoca.Session(roots=[str(PACKAGE)]).loads(text, model=model)
