"""The model description of a plant of your own, from its equations."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from xml.etree import ElementTree
from xml.etree.ElementTree import Element

import casadi as ca

from sigmahat.export import templates
from sigmahat.export.c_variables import SAMPLE_PERIOD, SEED, is_of_every_plant
from sigmahat.fmi.installed import version
from sigmahat.fmi.unknown_name import unknown
from sigmahat.plants.equations import PlantEquations


@dataclass(frozen=True)
class PlantVariable:
    """What the model description says of an input, output or parameter."""

    unit: str
    """One of the units of the FMUs that come with sigmahat: 1, s, rad, m, kg.m2, N.m, ..."""
    description: str
    """One line."""
    start: float = 0.0
    """Start value of an input or parameter in its unit. An output has none."""


def describe(
    plant: PlantEquations, variables: Mapping[str, PlantVariable], description: Element
) -> None:
    """Turns the model description of another plant into that of this one.

    The result is what a template in ``modelDescription/`` renders to: ``description.complete`` adds
    what follows from the rest.

    Raises ValueError for a plant name that is none in C, and as `write_plant_fmu` for variables.
    """
    if not (plant.name.isidentifier() and plant.name.isascii()):
        raise ValueError(f"plant {plant.name!r}: expected a name that is also one in C")
    (defined,) = description.findall("UnitDefinitions")
    defined[:] = ElementTree.parse(templates.UNITS).getroot()
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
            raise ValueError(f"{plant.name}: the name of the parameter {name} is taken")
    for name in variables:
        if name not in names:
            raise ValueError(unknown(f"variable of {plant.name}", name, names))
    for kind, own in kinds.items():
        for name in own:
            if name not in variables:
                raise ValueError(f"{plant.name}: variables has no entry for the {kind} {name}")
            unit = variables[name].unit
            if unit not in units:
                raise ValueError(f"{plant.name}.{name}: {unknown('unit', unit, units)}")


def _list_variables(
    plant: PlantEquations, variables: Mapping[str, PlantVariable], listed: Element
) -> None:
    """Fills the element ModelVariables."""

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
    depends = _depends(plant)
    for name, expression in plant.outputs.items():
        discrete = _has_steps(expression) or SEED in depends[name]
        variability = "discrete" if discrete else "continuous"
        on = " ".join(depends[name])
        add(name, "output", variability=variability, initial="calculated", depends=on)
    fixed = _needed_at_the_start(plant)
    for name in plant.parameters:
        variability = "fixed" if name in fixed else "tunable"
        add(name, "parameter", variability=variability, initial="exact")
    if plant.normals:
        seed = ElementTree.SubElement(listed, "ScalarVariable", name=SEED, causality="parameter")
        text = "Seed of the noise: one seed is one sequence of samples"
        seed.attrib |= {"variability": "fixed", "initial": "exact", "description": text}
        ElementTree.SubElement(seed, "Integer", start="1")
        period = ElementTree.SubElement(
            listed, "ScalarVariable", name=SAMPLE_PERIOD, causality="parameter"
        )
        text = "Time between two samples of the noise, which is held in between"
        period.attrib |= {"variability": "fixed", "initial": "exact", "description": text}
        ElementTree.SubElement(period, "Real", unit="s", start="1e-3", min="1e-9")


def _depends(plant: PlantEquations) -> dict[str, list[str]]:
    """Names of the variables that the initial value of each output depends on."""
    x = ca.vertcat(*(state.symbol for state in plant.states.values()))
    start = ca.vertcat(*(state.start for state in plant.states.values()))
    noise = {normal.name() for normal in plant.normals}
    depends = {}
    for name, expression in plant.outputs.items():
        symbols = [s.name() for s in ca.symvar(ca.substitute(expression, x, start))]
        depends[name] = sorted({SEED if s in noise else s for s in symbols})
    return depends


def _needed_at_the_start(plant: PlantEquations) -> set[str]:
    """Names of the parameters that start values of states depend on."""
    start = ca.vertcat(*(state.start for state in plant.states.values()))
    return {symbol.name() for symbol in ca.symvar(start)}


def _has_steps(expression: ca.SX) -> bool:
    """Whether there is rounding in it, as of an encoder."""
    function = ca.Function("output", ca.symvar(expression), [expression])
    return ca.OP_FLOOR in map(function.instruction_id, range(function.n_instructions()))
