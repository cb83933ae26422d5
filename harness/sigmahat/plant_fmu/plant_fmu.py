"""An FMU of a plant of your own, from its equations in CasADi: no template, no CMake.

All parts that do not depend on the equations are taken from ``AwasPlant.fmu`` and its sources.
Only sigmahat with its extra ``plants`` and a C compiler are needed.
"""

import shutil
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from xml.etree import ElementTree
from xml.etree.ElementTree import Element

import casadi as ca
import fmpy

from sigmahat.fmi.installed import fmu as installed_fmu
from sigmahat.fmi.installed import version
from sigmahat.fmi.unknown_name import unknown
from sigmahat.plant_fmu import archive, model_description, plant_codegen
from sigmahat.plant_fmu.c_variables import (
    SAMPLE_PERIOD,
    SEED,
    c_table,
    is_of_every_plant,
    storage_in_arrays,
)
from sigmahat.plant_fmu.compiler import compile_folder
from sigmahat.plants.equations import PlantEquations


@dataclass(frozen=True)
class PlantVariable:
    """Entry of the model description for an input, output or parameter."""

    unit: str  #: A unit of the FMUs that come with sigmahat: 1, s, rad, m, kg.m2, N.m, ...
    description: str  #: One line.
    start: float = 0.0  #: Start value of an input or parameter in its unit; an output has none.


def describe(
    plant: PlantEquations, variables: Mapping[str, PlantVariable], description: Element
) -> None:
    """Changes the model description of another plant into the description of this plant.

    The result is like a rendered template of ``modelDescription/``: the parts that follow from
    these data are added by `model_description.complete`.

    Raises ValueError for a plant name that is no name in C, and as `write_plant_fmu` for variables.
    """
    if not (plant.name.isidentifier() and plant.name.isascii()):
        raise ValueError(f"plant {plant.name!r}: expected a name that is an identifier in C")
    (defined,) = description.findall("UnitDefinitions")
    defined[:] = ElementTree.parse(model_description.UNITS).getroot()
    _check(plant, variables, [unit.attrib["name"] for unit in defined])
    description.set("modelName", plant.name)
    for attribute in ("guid", "author", "copyright", "license", "version"):
        description.attrib.pop(attribute, None)
    description.set("description", f"{plant.name}, from its equations")
    description.set("generationTool", f"sigmahat {version()}")
    description.findall("CoSimulation")[0].set("modelIdentifier", plant.name)
    description.remove(description.findall("ModelStructure")[0])
    _list_variables(plant, variables, description.findall("ModelVariables")[0])


def _check(
    plant: PlantEquations, variables: Mapping[str, PlantVariable], units: Sequence[str]
) -> None:
    """Raises ValueError unless all names of the equations, and no others, have a variable."""
    kinds = {"input": plant.inputs, "output": plant.outputs, "parameter": plant.parameters}
    names = [name for names in kinds.values() for name in names]
    for name in plant.parameters:
        if is_of_every_plant(name):
            raise ValueError(f"{plant.name}: every plant has {name}; rename this parameter")
    for name in variables:
        if name not in names:
            raise ValueError(unknown(f"variable of {plant.name}", name, names))
    for kind, names_of_kind in kinds.items():
        for name in names_of_kind:
            if name not in variables:
                raise ValueError(f"{plant.name}: expected an entry for {kind} {name} in variables")
            unit = variables[name].unit
            if unit not in units:
                raise ValueError(f"{plant.name}.{name}: {unknown('unit', unit, units)}")


def _list_variables(
    plant: PlantEquations, variables: Mapping[str, PlantVariable], listed: Element
) -> None:
    def add(name: str, causality: str, **attributes: str) -> None:
        variable = variables[name]
        element = ElementTree.SubElement(listed, "ScalarVariable", name=name, causality=causality)
        element.attrib |= {"description": variable.description, **attributes}
        real = ElementTree.SubElement(element, "Real", unit=variable.unit)
        if causality != "output":
            real.set("start", repr(float(variable.start)))

    listed.clear()
    for name in plant.inputs:
        add(name, "input", variability="continuous")
    x = ca.vertcat(*(state.symbol for state in plant.states.values()))
    start = ca.vertcat(*(state.start for state in plant.states.values()))
    noise = {normal.name() for normal in plant.normals}
    for name, expression in plant.outputs.items():
        # The variables on which the initial value of the output depends.
        symbols = (s.name() for s in ca.symvar(ca.substitute(expression, x, start)))
        depends = sorted({SEED if s in noise else s for s in symbols})
        # Rounding, for example of an encoder, makes steps.
        function = ca.Function("output", ca.symvar(expression), [expression])
        operations = map(function.instruction_id, range(function.n_instructions()))
        discrete = ca.OP_FLOOR in operations or SEED in depends
        variability, on = "discrete" if discrete else "continuous", " ".join(depends)
        add(name, "output", variability=variability, initial="calculated", depends=on)
    # Start values of states depend on these.
    fixed = {symbol.name() for symbol in ca.symvar(start)}
    for name in plant.parameters:
        variability = "fixed" if name in fixed else "tunable"
        add(name, "parameter", variability=variability, initial="exact")
    if plant.normals:
        listed.extend(ElementTree.fromstring(_NOISE))


_NOISE = f"""<ModelVariables>
<ScalarVariable name="{SEED}" causality="parameter" variability="fixed" initial="exact"
 description="Seed of the noise: one seed is one sequence of samples">
<Integer start="1"/></ScalarVariable>
<ScalarVariable name="{SAMPLE_PERIOD}" causality="parameter" variability="fixed" initial="exact"
 description="Time between two samples of the noise, which is held in between">
<Real unit="s" start="1e-3" min="1e-9"/></ScalarVariable>
</ModelVariables>"""


def write_plant_fmu(
    plant: PlantEquations, variables: Mapping[str, PlantVariable], fmu: str | Path
) -> None:
    """Write the FMU of a plant, with the binary of this machine and its sources.

    `variables` has each input, output and parameter of the plant by its name, `fmu` is the file to
    write; its folder is made.

    The FMU is for FMI 2.0 Co-Simulation and behaves as the plants of sigmahat. Inputs are held or
    linear during a step. A plant with noise has the parameters ``noise.seed`` and
    ``noise.samplePeriod``. Parameters are tunable, except parameters on which start values of
    states depend.

    Raises ValueError for a variable that is missing, not in the equations or in an unknown unit.
    Raises RuntimeError if no compiler (gcc or clang, or the compiler in CC) is found, or it fails.
    """
    with TemporaryDirectory() as scratch:
        folder = Path(scratch, "fmu")
        fmpy.extract(str(installed_fmu("AwasPlant")), unzipdir=str(folder))
        for part in ("binaries", "documentation/index.html", "documentation/icon.svg", "model.png"):
            path = folder / part
            shutil.rmtree(path) if path.is_dir() else path.unlink()
        sources = folder / "sources"
        xml = folder / "modelDescription.xml"
        root = ElementTree.parse(xml).getroot()
        describe(plant, variables, root)
        guid = model_description.complete(root)
        table = c_table(root, "sh_plant", storage_in_arrays(root), guid)
        (sources / "variables.h").write_text(table, encoding="utf-8")
        model_description.write_xml(root, xml)
        plant_codegen.write(
            plant, list(plant.parameters), list(plant.inputs), list(plant.outputs), sources
        )
        binaries = folder / "binaries" / fmpy.platform
        binaries.mkdir(parents=True)
        compile_folder(sources, binaries / f"{plant.name}{fmpy.sharedLibraryExtension}")
        archive.write(Path(fmu), archive.files_in(folder))
