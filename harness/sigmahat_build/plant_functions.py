"""Writes the C code of a plant of the package: its equations, for its FMU."""

import re
from importlib import import_module
from pathlib import Path

from sigmahat.plant_fmu import plant_codegen
from sigmahat.plant_fmu.c_variables import storage_in_arrays
from sigmahat_build.description_template import render


def write(template: Path, folder: Path) -> None:
    """Write the code of a plant into a folder, variables in the order of its template.

    The equations of ``FlexibleJointPlant.xml`` are in ``sigmahat.plants.flexible_joint``.
    """
    words = re.findall("[A-Z][a-z]*", template.stem.removesuffix("Plant"))
    plant = import_module(f"sigmahat.plants.{'_'.join(words).lower()}").plant
    places = storage_in_arrays(render(template, version=""))

    def names(array: str) -> list[str]:
        return [name for name, place in places.items() if place.startswith(f"{array}[")]

    plant_codegen.write(plant, names("p"), names("u"), names("y"), folder)
