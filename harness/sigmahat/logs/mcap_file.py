"""`estimate.mcap`: the estimates as messages, for Foxglove and PlotJuggler.

One topic, `/estimate`, with a message for each tick: JSON with a schema that has the unit and the
description of each field. Times count from the start of the log.
"""

import json
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from mcap.writer import Writer
from numpy.typing import NDArray

from sigmahat.files.output import finite
from sigmahat.fmi.instance import Fmu
from sigmahat.fmi.series import schema

MCAP = "estimate.mcap"  # name of the file in the folder of results
_TOPIC = "/estimate"

Outputs = Mapping[str, NDArray[Any]]


@contextmanager
def mcap_file(path: Path, fmu: Fmu, T: float) -> Iterator[Callable[[Outputs], None]]:
    """Yields a function that writes a message for each of the next ticks, which are T [s] apart."""
    with path.open("wb") as file:
        writer = Writer(file)
        writer.start(library="sigmahat")
        ticks, channel = 0, -1

        def add(outputs: Outputs) -> None:
            nonlocal ticks, channel
            if not ticks:
                data = json.dumps(schema(fmu, outputs)).encode()
                described = writer.register_schema("estimate", "jsonschema", data)
                channel = writer.register_channel(_TOPIC, "json", described)
            columns = [finite(values.tolist()) for values in outputs.values()]
            for row in zip(*columns, strict=True):
                stamp = round(1e9 * T * ticks)
                data = json.dumps(dict(zip(outputs, row, strict=True))).encode()
                writer.add_message(channel, stamp, data, stamp)
                ticks += 1

        yield add
        writer.finish()  # type: ignore[no-untyped-call]
