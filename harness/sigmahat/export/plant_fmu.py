"""An FMU of a plant of your own, from its equations in CasADi: no template, no CMake.

What does not depend on the equations is taken from ``AwasPlant.fmu``, which contains its sources.
So this works wherever sigmahat is installed with its extra ``plants`` and there is a C compiler.
"""

from __future__ import annotations

import shutil
from collections.abc import Mapping
from pathlib import Path
from tempfile import TemporaryDirectory
from xml.etree import ElementTree

import fmpy

from sigmahat.export import archive, c_variables, description, plant_codegen
from sigmahat.export.native_compiler import compile_folder
from sigmahat.export.plant_description import PlantVariable, describe
from sigmahat.fmi.installed import fmu as installed_fmu
from sigmahat.plants.equations import PlantEquations


def write_plant_fmu(
    plant: PlantEquations, variables: Mapping[str, PlantVariable], fmu: Path
) -> None:
    """Write the FMU of a plant, with the binary of this machine and its sources.

    `variables` has each input, output and parameter of the plant by its name, `fmu` is the file to
    write; its folder is made.

    It is for FMI 2.0 Co-Simulation and behaves as the plants that come with sigmahat: inputs are
    held or linear over a step, and a plant with noise has the parameters ``noise.seed`` and
    ``noise.samplePeriod``. Parameters are tunable, but for those that start values of states
    depend on.

    Raises ValueError for a variable that is missing, not in the equations or in an unknown unit,
    RuntimeError if there is no compiler (gcc or clang, or what CC names) or it refuses.
    """
    with TemporaryDirectory() as scratch:
        folder = Path(scratch, "fmu")
        fmpy.extract(str(installed_fmu("AwasPlant")), unzipdir=str(folder))
        for part in ("binaries", "documentation/index.html", "documentation/icon.svg", "model.png"):
            path = folder / part
            shutil.rmtree(path) if path.is_dir() else path.unlink()
        sources = folder / "sources"
        _write_description(plant, variables, folder / "modelDescription.xml", sources)
        plant_codegen.write(
            plant, list(plant.parameters), list(plant.inputs), list(plant.outputs), sources
        )
        place = folder / "binaries" / fmpy.platform
        place.mkdir(parents=True)
        compile_folder(sources, place / f"{plant.name}{fmpy.sharedLibraryExtension}")
        files = [file for file in folder.rglob("*") if file.is_file()]
        archive.write(fmu, {file.relative_to(folder).as_posix(): file for file in files})


def _write_description(
    plant: PlantEquations, variables: Mapping[str, PlantVariable], xml: Path, sources: Path
) -> None:
    """The model description, in place of that of the AwAS, and its table of variables in C."""
    root = ElementTree.parse(xml).getroot()
    describe(plant, variables, root)
    guid = description.complete(root)
    ElementTree.ElementTree(root).write(xml, encoding="UTF-8", xml_declaration=True)
    places = c_variables.storage_in_arrays(root)
    table = c_variables.c_table(root, "sh_plant", places, guid)
    (sources / "variables.h").write_text(table, encoding="utf-8")
