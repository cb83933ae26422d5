"""An FMU of a plant of your own, from its equations in CasADi: no template, no CMake.

What does not depend on the equations is taken from ``AwasPlant.fmu``, which brings its sources. So
this works wherever sigmahat is installed with its extra ``plants`` and there is a C compiler.
"""

from __future__ import annotations

import os
import shlex
import shutil
import subprocess
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from xml.etree import ElementTree
from xml.etree.ElementTree import Element

import casadi as ca
import fmpy

from sigmahat.export import archive, cross_compiler, description, plant_codegen
from sigmahat.fmi.installed import fmu as installed_fmu
from sigmahat.fmi.installed import version
from sigmahat.plants.equations import PlantEquations
from sigmahat.user_input.unknown_name import unknown

_SEED = "noise.seed"


@dataclass(frozen=True)
class PlantVariable:
    """What the model description says of an input, output or parameter."""

    unit: str
    """One of the units of ``AwasPlant.fmu``: 1, s, rad, rad/s, m, kg.m2, N.m, N.m/rad, ..."""
    description: str
    """One line."""
    start: float = 0.0
    """Start value of an input or parameter in its unit. An output has none."""


def write_plant_fmu(
    plant: PlantEquations, variables: Mapping[str, PlantVariable], fmu: Path
) -> None:
    """Write the FMU of a plant, with the binary of this machine and its sources.

    `variables` has each input, output and parameter of the plant by its name, `fmu` is the file to
    write; its folder is made.

    It is for FMI 2.0 Co-Simulation and behaves as the plants that come with sigmahat: inputs are
    held or linear over a step, and a plant with noise has the parameter ``noise.seed``. Parameters
    are tunable, but for those that start values of states depend on.

    Raises ValueError for a variable that is missing, not in the equations or in an unknown unit,
    RuntimeError if there is no compiler (gcc or clang, or what CC names) or it refuses.
    """
    with TemporaryDirectory() as scratch:
        folder = Path(scratch, "fmu")
        fmpy.extract(str(installed_fmu("AwasPlant")), unzipdir=str(folder))
        for part in ("binaries", "documentation/index.html", "documentation/icon.svg", "model.png"):
            path = folder / part
            shutil.rmtree(path) if path.is_dir() else path.unlink()
        xml = folder / "modelDescription.xml"
        root = _describe(plant, variables, ElementTree.parse(xml).getroot())
        # The table of limits needs what complete() takes out, and the GUID that it makes.
        places = description.storage_in_arrays(root)
        delivered = ElementTree.fromstring(ElementTree.tostring(root))
        guid = description.complete(delivered)
        ElementTree.ElementTree(delivered).write(xml, encoding="UTF-8", xml_declaration=True)
        sources = folder / "sources"
        (sources / "variables.h").write_text(
            description.c_table(root, "sh_plant", places, guid), encoding="utf-8"
        )
        of = {c: [n for n in _names(plant, c) if n != _SEED] for c in _CAUSALITIES}
        plant_codegen.write(plant, of["parameter"], of["input"], of["output"], sources)
        binary = f"{plant.name}{fmpy.sharedLibraryExtension}"
        place = folder / "binaries" / fmpy.platform
        place.mkdir(parents=True)
        _compile(sources, place / binary)
        files = [file for file in folder.rglob("*") if file.is_file()]
        archive.write(fmu, {file.relative_to(folder).as_posix(): file for file in files})


_CAUSALITIES = ("input", "output", "parameter")


def _names(plant: PlantEquations, causality: str) -> list[str]:
    own: dict[str, Iterable[str]] = {
        "input": plant.inputs,
        "output": plant.outputs,
        "parameter": [*plant.parameters, *([_SEED] if plant.normals else [])],
    }
    return list(own[causality])


def _describe(
    plant: PlantEquations, variables: Mapping[str, PlantVariable], root: Element
) -> Element:
    """The description of another plant turned into that of this one, but for what follows from it.

    It is what a template in ``modelDescription/`` renders to: see ``description``.
    """
    if not (plant.name.isidentifier() and plant.name.isascii()):
        raise ValueError(f"plant {plant.name!r}: expected a name that is also one in C")
    names = [n for c in _CAUSALITIES for n in _names(plant, c) if n != _SEED]
    for name in variables:
        if name not in names:
            raise ValueError(unknown(f"variable of {plant.name}", name, names))
    root.set("modelName", plant.name)
    for attribute in ("guid", "author", "copyright", "license", "version"):
        root.attrib.pop(attribute, None)
    root.set("description", f"{plant.name}, from its equations")
    root.set("generationTool", f"sigmahat {version()}")
    root.findall("CoSimulation")[0].set("modelIdentifier", plant.name)
    root.remove(root.findall("ModelStructure")[0])
    units = [unit.attrib["name"] for unit in root.findall("UnitDefinitions/Unit")]
    listed = root.findall("ModelVariables")[0]
    listed.clear()
    depends, fixed = _depends(plant), _of_the_start(plant)
    for causality in _CAUSALITIES:
        for name in _names(plant, causality):
            element = ElementTree.SubElement(listed, "ScalarVariable", name=name)
            element.set("causality", causality)
            if name == _SEED:
                text = "Seed of the noise: one seed is one sequence of samples"
                element.attrib |= {"variability": "fixed", "initial": "exact", "description": text}
                ElementTree.SubElement(element, "Integer", start="1")
                continue
            if name not in variables:
                raise ValueError(f"{plant.name}: variables has no entry for the {causality} {name}")
            variable = variables[name]
            if variable.unit not in units:
                raise ValueError(f"{plant.name}.{name}: {unknown('unit', variable.unit, units)}")
            element.set("description", variable.description)
            real = ElementTree.SubElement(element, "Real", unit=variable.unit)
            if causality == "output":
                stepped = _steps(plant.outputs[name]) or _SEED in depends[name]
                element.set("variability", "discrete" if stepped else "continuous")
                element.attrib |= {"initial": "calculated", "depends": " ".join(depends[name])}
                continue
            real.set("start", repr(float(variable.start)))
            if causality == "parameter":
                element.set("variability", "fixed" if name in fixed else "tunable")
                element.set("initial", "exact")
            else:
                element.set("variability", "continuous")
    return root


def _depends(plant: PlantEquations) -> dict[str, list[str]]:
    """Names of the variables that the initial value of each output depends on."""
    x = ca.vertcat(*(state.symbol for state in plant.states.values()))
    start = ca.vertcat(*(state.start for state in plant.states.values()))
    noise = {normal.name() for normal in plant.normals}
    depends = {}
    for name, expression in plant.outputs.items():
        symbols = [s.name() for s in ca.symvar(ca.substitute(expression, x, start))]
        depends[name] = sorted({_SEED if s in noise else s for s in symbols})
    return depends


def _of_the_start(plant: PlantEquations) -> set[str]:
    """Names of the parameters that start values of states depend on."""
    start = ca.vertcat(*(state.start for state in plant.states.values()))
    return {symbol.name() for symbol in ca.symvar(start)}


def _steps(expression: ca.SX) -> bool:
    """Whether there is rounding in it, as of an encoder."""
    function = ca.Function("output", ca.symvar(expression), [expression])
    return ca.OP_FLOOR in map(function.instruction_id, range(function.n_instructions()))


def _compile(sources: Path, binary: Path) -> None:
    """Compile every C file of a folder into a shared library."""
    compiler = os.environ.get("CC") or next(filter(shutil.which, ("cc", "gcc", "clang")), None)
    if compiler is None:
        raise RuntimeError("no C compiler found: install gcc or clang, or name one in CC")
    files = sorted(file.name for file in sources.glob("*.c"))
    include = f"-I{Path(fmpy.__file__).parent / 'c-code'}"
    command = [*shlex.split(compiler), *cross_compiler.FLAGS, include, *files]
    try:
        done = subprocess.run(
            [*command, "-lm", "-o", str(binary.resolve())],
            cwd=sources,
            capture_output=True,
            text=True,
        )
    except OSError as error:
        raise RuntimeError(f"CC={compiler}: {error.strerror}") from error
    if done.returncode:
        raise RuntimeError(f"{compiler} could not compile the plant:\n{done.stderr}")
