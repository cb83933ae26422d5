"""Outputs of an FMU as a JSON schema, with their units and descriptions."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from sigmahat.fmi.instance import Fmu

_KINDS = {"Real": "number", "Boolean": "boolean", "Enumeration": "string"}


def schema(fmu: Fmu, names: Iterable[str]) -> dict[str, Any]:
    """Schema of a message with these outputs; an enumeration is the name of its item."""
    properties = {}
    for name in names:
        variable = fmu.variable(name, "output")
        unit = f" [{variable.unit}]" if variable.unit else ""
        described = f"{variable.description or name}{unit}"
        properties[name] = {"type": _KINDS[variable.type], "description": described}
    return {"type": "object", "title": "estimate", "properties": properties}
