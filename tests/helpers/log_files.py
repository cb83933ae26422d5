"""CSV files to drop on the page."""

from __future__ import annotations

import io
from collections.abc import Mapping

import numpy as np
import pyarrow as pa
import pyarrow.csv

from recorded_logs import Array


def csv(columns: Mapping[str, Array]) -> str:
    """A CSV file."""
    text = io.BytesIO()
    pyarrow.csv.write_csv(pa.table(dict(columns)), text)
    return text.getvalue().decode()


def good() -> dict[str, Array]:
    """Columns of a log without a fault."""
    t = 0.001 * np.arange(200)
    return {"time": t, "theta": np.sin(t), "q": 1.002 * np.sin(t), "tau": 0.05 * np.cos(t)}
