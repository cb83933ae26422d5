"""`estimate.mcap`: the estimates as messages, for Foxglove and PlotJuggler.

One topic, `/estimate`, with a message for each tick: JSON with a schema that has the unit and the
description of each field. Times count from the start of the log.
"""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
from mcap.writer import Writer
from numpy.typing import NDArray

from sigmahat.fmi.instance import Fmu
from sigmahat.fmi.series import schema

MCAP = "estimate.mcap"
"""Name of the file in the folder of results."""
_TOPIC = "/estimate"

Outputs = Mapping[str, NDArray[Any]]


@contextmanager
def mcap_file(path: Path, fmu: Fmu, T: float) -> Iterator[Callable[[Outputs], None]]:
    """Yields a function that writes a message for each of the next ticks, given their outputs.

    T  time between ticks [s]
    """
    with path.open("wb") as file:
        writer = Writer(file)
        writer.start(library="sigmahat")
        yield _Messages(writer, fmu, T).add
        writer.finish()  # type: ignore[no-untyped-call]


class _Messages:
    """The ticks that were written so far."""

    def __init__(self, writer: Writer, fmu: Fmu, T: float) -> None:
        self._writer, self._fmu, self._T, self._ticks = writer, fmu, T, 0
        self._channel: int | None = None

    def add(self, outputs: Outputs) -> None:
        if self._channel is None:
            self._channel = self._registered(outputs)
        columns = [_with_null(values) for values in outputs.values()]
        for row in zip(*columns, strict=True):
            stamp = round(1e9 * self._T * self._ticks)
            data = json.dumps(dict(zip(outputs, row, strict=True))).encode()
            self._writer.add_message(self._channel, stamp, data, stamp)
            self._ticks += 1

    def _registered(self, outputs: Outputs) -> int:
        data = json.dumps(schema(self._fmu, outputs)).encode()
        described = self._writer.register_schema("estimate", "jsonschema", data)
        return self._writer.register_channel(_TOPIC, "json", described)


def _with_null(values: NDArray[Any]) -> list[Any]:
    """A column for JSON, which has no NaN and no infinity."""
    column: list[Any] = values.tolist()
    if values.dtype.kind == "f" and not np.isfinite(values).all():
        return [each if math.isfinite(each) else None for each in column]
    return column
