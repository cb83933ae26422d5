"""`estimate.mcap`: the estimates as messages, for Foxglove and PlotJuggler.

One topic, `/estimate`, with a message for each tick: JSON with a schema that has the unit and the
description of each field. The times are those since the start of the log.
"""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from contextlib import AbstractContextManager
from pathlib import Path
from types import TracebackType
from typing import Any

import numpy as np
from mcap.writer import Writer
from numpy.typing import NDArray

from sigmahat.fmi.instance import Fmu

MCAP = "estimate.mcap"
"""Name of the file in the folder of results."""
_TOPIC = "/estimate"


class McapFile(AbstractContextManager["McapFile"]):
    """Writes the outputs of the ticks."""

    def __init__(self, path: Path, fmu: Fmu, T: float) -> None:
        """T  time between ticks [s]"""
        self._fmu, self._T, self._ticks = fmu, T, 0
        self._file = path.open("wb")
        self._writer = Writer(self._file)
        self._writer.start(library="sigmahat")
        self._channel: int | None = None

    def add(self, outputs: Mapping[str, NDArray[Any]]) -> None:
        """Writes a message for each of the next ticks."""
        if self._channel is None:
            self._channel = self._registered(outputs)
        columns = [_with_null(values) for values in outputs.values()]
        for row in zip(*columns, strict=True):
            stamp = round(1e9 * self._T * self._ticks)
            data = json.dumps(dict(zip(outputs, row, strict=True))).encode()
            self._writer.add_message(self._channel, stamp, data, stamp)
            self._ticks += 1

    def _registered(self, outputs: Mapping[str, NDArray[Any]]) -> int:
        schema = {"type": "object", "title": "estimate", "properties": {}}
        schema["properties"] = {name: self._property(name, outputs[name]) for name in outputs}
        data = json.dumps(schema).encode()
        described = self._writer.register_schema("estimate", "jsonschema", data)
        return self._writer.register_channel(_TOPIC, "json", described)

    def _property(self, name: str, values: NDArray[Any]) -> dict[str, Any]:
        variable = self._fmu.variable(name, "output")
        unit = f" [{variable.unit}]" if variable.unit else ""
        kinds = {"b": "boolean", "f": "number"}
        described = f"{variable.description or name}{unit}"
        return {"type": kinds.get(values.dtype.kind, "string"), "description": described}

    def __exit__(
        self,
        _kind: type[BaseException] | None,
        _error: BaseException | None,
        _trace: TracebackType | None,
    ) -> None:
        try:
            self._writer.finish()  # type: ignore[no-untyped-call]
        finally:
            self._file.close()


def _with_null(values: NDArray[Any]) -> list[Any]:
    """A column for JSON, which has no NaN and no infinity."""
    column: list[Any] = values.tolist()
    if values.dtype.kind == "f" and not np.isfinite(values).all():
        return [each if math.isfinite(each) else None for each in column]
    return column
