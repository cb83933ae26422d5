"""The page of ``docs/live``: the FMUs as WebAssembly, their variables, and the page, in one folder.

The binaries are compiled from the sources in the FMUs. The binaries call nothing of the browser but
the logger of the page. They are part of a script, because a page that was opened as a file must not
read other files.
"""

import base64
import json
import shutil
from collections.abc import Mapping
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from sigmahat import guess
from sigmahat.files import toml_file
from sigmahat.fmi.instance import Fmu
from sigmahat.fmi.model import Value
from sigmahat.paper.scenarios import scenario
from sigmahat.plant_fmu.compiler import CODE, HEADERS
from sigmahat.recording.configuration import ANOTHER_ROBOT, ANY_COULOMB
from sigmahat_build import cross_compiler
from sigmahat_build.system import torques

FUNCTIONS = (
    *("fmi2Instantiate", "fmi2SetupExperiment", "fmi2EnterInitializationMode"),
    *("fmi2ExitInitializationMode", "fmi2DoStep", "fmi2GetReal", "fmi2GetInteger"),
    *("fmi2GetBoolean", "fmi2SetReal", "fmi2SetInteger", "fmi2SetBoolean"),
    *("page_callbacks", "malloc"),
)
"""Functions that the page calls."""
_TARGET, _KIND = "wasm32-wasi", "-mexec-model=reactor"
_UNKNOWN = {f"prior.{name}": ANOTHER_ROBOT for name in ("B", "D_theta")}
_UNKNOWN["prior.tau_coulomb"] = ANY_COULOMB
"""Parameters that `sigmahat init` writes for a log whose motor is not known."""
_SHOWN = ("type", "unit", "start", "description")


def write(out: Path, page: Path, fmus: list[Path], cache: Path) -> None:
    """Writes the page into a folder, whose old files are removed.

    page   folder with the page itself and callbacks.c
    fmus   to compile
    cache  for compiled parts that can be used again

    Raises ``subprocess.CalledProcessError`` if the compiler fails, which prints why on stderr.
    """
    opened = {path.stem: Fmu(path) for path in fmus}
    types = {name: _described(fmu, page / "callbacks.c", cache) for name, fmu in opened.items()}
    shutil.rmtree(out, ignore_errors=True)
    out.mkdir(parents=True)
    for file in page.iterdir():
        if file.suffix in (".html", ".css", ".js"):
            shutil.copyfile(file, out / file.name)
    # The words by which `sigmahat init` recognises columns.
    words = toml_file.read(Path(guess.__file__).parent / "vocabulary.toml").unwrap()
    data = {"FMUS": types, "SCENARIO": _scenario(opened), "WORDS": words, "UNKNOWN": _UNKNOWN}
    encode = json.JSONEncoder(separators=(",", ":"), default=dict).encode
    lines = ['"use strict";', *(f"const {name} = {encode(each)};" for name, each in data.items())]
    (out / "fmus.js").write_text("\n".join([*lines, ""]), encoding="utf-8")


def _described(fmu: Fmu, callbacks: Path, cache: Path) -> dict[str, Any]:
    """Data of an FMU that the page needs, with the binary and the page's callbacks in it."""
    with TemporaryDirectory() as scratch:
        folder, binary = Path(fmu.folder), Path(scratch) / "fmu.wasm"
        arguments: list[str | Path] = [
            *(_KIND, *CODE),
            *(f"-I{each.resolve()}" for each in (folder / "sources", HEADERS)),
            *(source.resolve() for source in cross_compiler.source_files(folder)),
            *(callbacks.resolve(), "-lm", "-o", binary),
            *(f"-Wl,--export={name}" for name in FUNCTIONS),
        ]
        cross_compiler.compile_files(_TARGET, arguments, cache, Path(scratch))
        return {
            "name": fmu.name,
            "guid": fmu.description.guid,
            "variables": {name: _variable(v) for name, v in fmu.variables.items()},
            "wasm": base64.b64encode(binary.read_bytes()).decode("ascii"),
        }


def _variable(variable: Any) -> dict[str, Any]:
    shown = {key: getattr(variable, key) for key in _SHOWN if getattr(variable, key) is not None}
    shown["reference"] = variable.valueReference
    if variable.type == "Enumeration":
        shown["items"] = {item.name: int(item.value) for item in variable.declaredType.items}
    return shown


def _scenario(fmus: Mapping[str, Fmu]) -> dict[str, Any]:
    def numbers(fmu: str, start: Mapping[str, Value]) -> dict[str, float | int]:
        return {name: fmus[fmu].number(name, value) for name, value in start.items()}

    table1 = scenario("table1")
    estimator = table1.estimators["RESIDUAL"]
    return {
        "T": table1.T,
        "duration": table1.duration,
        "connections": estimator.connections,
        "plant": numbers(table1.plant.fmu, {**table1.plant.start, **torques(table1)}),
        "estimator": numbers(estimator.fmu, estimator.start),
    }
