"""Sinks of estimates: datagrams of JSON."""

from __future__ import annotations

import json
import socket
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from itertools import groupby
from typing import Any

from sigmahat.files.output import finite
from sigmahat.joint.curve import NORMAL_95
from sigmahat.live.joint import Estimated

Sink = Callable[[Sequence[Estimated]], None]
"""Sends the ticks of one message on."""
BANDED = ("sigma", "tau_e")
"""Outputs whose 95 % intervals are sent, too: sigma_low and sigma_high, ..."""


def shown(outputs: Mapping[str, Any]) -> dict[str, Any]:
    """Outputs and intervals for JSON, which has no nan and no infinity."""
    values = dict(outputs)
    for name in BANDED:
        half = NORMAL_95 * values[f"{name}_std"]
        values[f"{name}_low"], values[f"{name}_high"] = values[name] - half, values[name] + half
    found: dict[str, Any] = finite(values)
    return found


def udp(address: tuple[str, int]) -> Sink:
    """A datagram for each tick, as PlotJuggler reads it: {"timestamp": t, "elbow": {...}}.

    A missing receiver is no error.
    """
    sender = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    sender.setblocking(False)

    def send(ticks: Sequence[Estimated]) -> None:
        for t, at_once in groupby(ticks, key=lambda each: each.t):
            message = {"timestamp": t} | {e.joint: shown(e.outputs) for e in at_once}
            with suppress(OSError):
                sender.sendto(json.dumps(message).encode(), address)

    return send
