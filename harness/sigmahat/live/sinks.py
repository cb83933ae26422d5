"""Where estimates go: datagrams of JSON."""

from __future__ import annotations

import json
import math
import socket
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from itertools import groupby
from typing import Any

from sigmahat.live.joint import Estimated

Sink = Callable[[Sequence[Estimated]], None]
"""Sends the ticks of one message on."""


def finite(outputs: Mapping[str, Any]) -> dict[str, Any]:
    """Outputs for JSON, which has no nan and no infinity."""
    return {
        name: None if isinstance(value, float) and not math.isfinite(value) else value
        for name, value in outputs.items()
    }


def udp(address: tuple[str, int]) -> Sink:
    """A datagram for each tick, as PlotJuggler reads it: {"timestamp": t, "elbow": {...}}.

    The joint of a configuration of one joint has the name "joint". That nobody listens is no error.
    """
    sender = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    sender.setblocking(False)

    def send(ticks: Sequence[Estimated]) -> None:
        for t, at_once in groupby(ticks, key=lambda each: each.t):
            message = {"timestamp": t} | {e.joint or "joint": finite(e.outputs) for e in at_once}
            with suppress(OSError):
                sender.sendto(json.dumps(message).encode(), address)

    return send
