"""Time series of the variables of an FMU, as tables of other libraries, and their JSON schema."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from sigmahat.fmi.model import Model, Value

if TYPE_CHECKING:
    import pandas
    import xarray


@dataclass(frozen=True)
class Series:
    """Recorded variables of one FMU, or of an estimator for one joint or several."""

    values: Mapping[str, NDArray[Any]]
    """Recorded variables by name, of shape (N,) or (joints, N), in the unit of the variable."""
    units: Mapping[str, str]  #: Unit of each recorded Real, as in the model description.
    parameters: Mapping[str, Value]
    """All parameters of the FMU at the start; with several joints, those of the first joint."""
    t: NDArray[np.float64]  #: Time of each sample since the first sample [s], shape (N,).
    descriptions: Mapping[str, str]  #: Description of each variable, as in the model description.

    @staticmethod
    def of(
        model: Model,
        values: Mapping[str, NDArray[Any]],
        parameters: Mapping[str, Value],
        t: NDArray[np.float64],
    ) -> Series:
        """Variables of an FMU, with units and descriptions from its model description."""
        variables = {name: model.variable(name) for name in values}
        units = {name: v.unit for name, v in variables.items() if v.unit is not None}
        descriptions = {name: v.description or "" for name, v in variables.items()}
        return Series(values, units, parameters, t, descriptions)

    def __getitem__(self, name: str) -> NDArray[Any]:
        return self.values[name]

    def to_dataframe(self) -> pandas.DataFrame:
        """A column for each variable; the index is "t" [s], or "joint" and "t" for several joints.

        `attrs["unit"]` and `attrs["description"]` describe the columns. Needs pandas.
        """
        import pandas

        index: Any = pandas.Index(self.t, name="t")
        first = next(iter(self.values.values()), self.t)
        if first.ndim == 2:
            index = pandas.MultiIndex.from_product(
                [range(len(first)), self.t], names=["joint", "t"]
            )
        columns = {name: values.reshape(-1) for name, values in self.values.items()}
        frame: pandas.DataFrame = pandas.DataFrame(columns, index=index)
        frame.attrs |= {"unit": dict(self.units), "description": dict(self.descriptions)}
        return frame

    def to_xarray(self) -> xarray.Dataset:
        """A dataset of all variables against "t" [s], with attributes "unit" and "description".

        Several joints are the dimension "joint". Needs xarray: `pip install sigmahat[xarray]`.
        """
        import xarray

        found = xarray.Dataset(coords={"t": ("t", self.t, {"unit": "s"})})
        for name, values in self.values.items():
            about = {"description": self.descriptions[name]}
            if name in self.units:
                about["unit"] = self.units[name]
            found[name] = (("joint", "t")[-values.ndim :], values, about)
        return found


_KINDS = {"Real": "number", "Boolean": "boolean", "Enumeration": "string"}


def schema(model: Model, names: Iterable[str]) -> dict[str, Any]:
    """Schema of a message with these outputs; an enumeration is the name of its item."""
    properties = {}
    for name in names:
        variable = model.variable(name, "output")
        unit = f" [{variable.unit}]" if variable.unit else ""
        described = f"{variable.description or name}{unit}"
        properties[name] = {"type": _KINDS[variable.type], "description": described}
    return {"type": "object", "title": "estimate", "properties": properties}
