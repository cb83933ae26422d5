"""Turns of a counter that nobody saw, because it went on during a gap."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from sigmahat.logs.configuration import Port
from sigmahat.logs.log import Array
from sigmahat.logs.resampling import stretches
from sigmahat.logs.units import factor


def put_right(
    values: Array, names: Sequence[str], ports: Mapping[str, Port], T: float
) -> Iterator[str]:
    """Moves theta or q behind gaps by whole periods of its counter, so that it went as far as the
    other one. Motor and link go together, but for the deformation.

    values  of the ports at the ticks [size: ticks x ports], nan where there is none; it is changed
    T       time between ticks [s]

    Yields what was done, in sentences.
    """
    if not {"theta", "q"} <= set(names):
        return
    both = [list(names).index(name) for name in ("theta", "q")]
    periods = [_period(name, ports[name]) for name in ("theta", "q")]
    own = int(np.argmin(periods))  # the other counter starts again later, or never
    if not np.isfinite(periods[own]):
        return
    column, period = both[own], periods[own]
    begins, ends = stretches(np.isfinite(values[:, both]).all(axis=1))
    for end, begin in zip(ends[:-1], begins[1:], strict=True):
        step = values[begin] - values[end - 1]
        turns = round((step[both[1 - own]] - step[column]) / period)
        if turns:
            values[begin:, column] += turns * period
            yield (
                f"{names[column]}: {turns:+d} periods of its counter during the gap after "
                f"{(end - 1) * T:.6g} s, by the motion of the other encoder"
            )


def _period(name: str, port: Port) -> float:
    """Angle after which a counter starts again [rad]; inf if it does not."""
    if port.wrap is None:
        return np.inf
    return float(abs(factor(name, port) * port.wrap / port.gear_ratio))
