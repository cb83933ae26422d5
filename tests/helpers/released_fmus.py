"""The FMUs as they are released, and one run of each that every importer repeats."""

from pathlib import Path
from typing import Any

import fmpy
import numpy as np
from numpy.typing import NDArray

from fmi_runs import ESTIMATORS, PLANTS

FMUS = sorted(ESTIMATORS + PLANTS)
TWINS = [f"{name}_FMI3" for name in FMUS]
INTEGERS = [f"{name}{version}_Integers" for name in ESTIMATORS for version in ("", "_FMI3")]
STEP, STEPS = 1e-3, 1000

# Largest permitted difference between two runs, relative to the range of the variable.
AGREEMENT = 1e-9


class Run:
    """An FMU and the trajectory that FMPy computes with it: held inputs, one row per step."""

    def __init__(self, fmu: Path) -> None:
        self.fmu = fmu
        self.description: Any = fmpy.read_model_description(str(fmu))
        variables = self.description.modelVariables
        self.inputs = [v for v in variables if v.causality == "input"]
        self.outputs = [
            v for v in variables if v.causality == "output" and v.type in ("Real", "Float64")
        ]
        self.time = STEP * np.arange(STEPS + 1)
        # Each input has another signal, so that a test notices exchanged inputs. All inputs are 0
        # at the start, because only some importers set inputs before the initialisation ends.
        self.signals = np.array(
            [
                0.3 * np.sin(2 * np.pi * (1 + 0.37 * number) * self.time)
                for number in range(len(self.inputs))
            ]
        ).T
        self.trajectory = self.simulate(fmu)

    def table(self) -> NDArray[Any]:
        """The inputs with their times, as FMPy takes them."""
        columns = [(name, np.float64) for name in ("time", *(v.name for v in self.inputs))]
        return np.asarray(np.rec.fromarrays([self.time, *self.signals.T], dtype=columns))

    def simulate(self, fmu: Path) -> NDArray[np.float64]:
        """Real outputs of an FMU with this description under FMPy [size: steps + 1, outputs]."""
        messages: list[str] = []
        result = fmpy.simulate_fmu(
            str(fmu),
            stop_time=self.time[-1],
            output_interval=STEP,
            input=self.table(),
            output=[v.name for v in self.outputs],
            logger=lambda *message: messages.append(str(message)),
        )
        assert messages == []
        trajectory: NDArray[np.float64] = np.array([result[v.name] for v in self.outputs]).T
        return trajectory

    def assert_same(self, other: NDArray[np.float64]) -> None:
        """Fails and names the worst variable if a trajectory differs from FMPy's trajectory."""
        assert other.shape == self.trajectory.shape
        scale = np.abs(self.trajectory).max(axis=0)
        difference = np.abs(other - self.trajectory).max(axis=0)
        relative = difference / np.where(scale > 0, scale, 1)
        worst = int(np.argmax(relative))
        assert relative[worst] <= AGREEMENT, f"{self.outputs[worst].name}: {relative[worst]:.1e}"
