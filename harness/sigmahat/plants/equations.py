"""A plant as equations, which a user writes, and from which C code is generated."""

import math
from dataclasses import dataclass

import casadi as ca


@dataclass(frozen=True)
class State:
    """One state of a plant."""

    symbol: ca.SX
    start: ca.SX
    scale: float


class PlantEquations:
    """Ordinary differential equations with inputs, parameters, noise and outputs.

    A plant file creates such an object, declares its symbols, and adds equations::

        plant = PlantEquations("MassPlant")
        force = plant.input("force")
        mass = plant.parameter("mass")
        x = plant.state("x", start=plant.parameter("initial.x"), scale=1.0)
        v = plant.state("v", start=0.0, scale=1.0)
        plant.derivative(x, v)
        plant.derivative(v, force / mass)
        plant.output("x", x)

    Names of inputs, parameters and outputs are the names of the FMU variables. Their units, start
    values and ranges are in ``modelDescription/NAME.xml``, or for `write_plant_fmu` in the
    `PlantVariable` of each variable. Expressions are CasADi ``SX``.
    """

    def __init__(self, name: str) -> None:
        self.name = name  #: Name of the FMU.
        self.inputs: dict[str, ca.SX] = {}  #: Symbols by name.
        self.parameters: dict[str, ca.SX] = {}  #: Symbols by name.
        self.states: dict[str, State] = {}  #: Symbols, start values and scales by name.
        self.derivatives: dict[str, ca.SX] = {}  #: d/dt of each state by its name.
        self.outputs: dict[str, ca.SX] = {}  #: Expressions by name.
        self.normals: list[ca.SX] = []  #: Noises of variance 1.

    def input(self, name: str) -> ca.SX:
        """Input ``name``; held, or linear in time, over a communication step."""
        return self._declare(self.inputs, name)

    def parameter(self, name: str) -> ca.SX:
        """Parameter ``name``."""
        return self._declare(self.parameters, name)

    def state(self, name: str, start: ca.SX | float, scale: float) -> ca.SX:
        """State ``name``. The start value of a state is an expression of the parameters alone.

        ``scale`` is a change of the state that matters, in its unit. The integrator keeps the error
        of each step far below ``scale + |state|`` (``fmu_src/radau.h``).
        """
        if not 0 < scale < math.inf:
            raise ValueError(f"state {name}: expected a finite scale above 0, got {scale}")
        if name in self.states:
            raise ValueError(f"{self.name}: state {name} is declared twice")
        symbol = ca.SX.sym(name)
        self.states[name] = State(symbol, ca.SX(start), scale)
        return symbol

    def derivative(self, state: ca.SX, expression: ca.SX) -> None:
        """d/dt of a state [its unit/s], of states, inputs and parameters."""
        name = state.name()
        if name not in self.states:
            raise ValueError(f"{self.name}: {name} is not a state")
        if name in self.derivatives:
            raise ValueError(f"{self.name}: the derivative of {name} is given twice")
        self.derivatives[name] = ca.SX(expression)

    def output(self, name: str, expression: ca.SX) -> None:
        """Output ``name``, of states, inputs, parameters and noise at the end of a step."""
        if name in self.outputs:
            raise ValueError(f"{self.name}: output {name} is given twice")
        self.outputs[name] = ca.SX(expression)

    def noise(self, variance: ca.SX) -> ca.SX:
        """White Gaussian noise for outputs, drawn once per communication step.

        The noises of two calls are independent.
        """
        normal = ca.SX.sym(f"normal_{len(self.normals)}")
        self.normals.append(normal)
        return ca.sqrt(variance) * normal

    def _declare(self, symbols: dict[str, ca.SX], name: str) -> ca.SX:
        if name in self.inputs or name in self.parameters:
            raise ValueError(f"{self.name}: {name} is declared twice")
        symbols[name] = ca.SX.sym(name)
        return symbols[name]


def encoder(angle: ca.SX, counts: ca.SX | float) -> ca.SX:
    """Angle [rad] rounded to the nearest of `counts` per turn; unchanged for 0 counts."""
    count = 2 * math.pi / ca.if_else(counts > 0, counts, 1)
    return ca.if_else(counts > 0, count * ca.floor(angle / count + 0.5), angle)
