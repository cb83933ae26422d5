"""What a result rests on and no log can verify: what the configuration says of each port."""

from collections.abc import Iterator, Mapping

import numpy as np

from sigmahat.checks.findings import Finding, Kind, Severity
from sigmahat.motor.log_view import LogView
from sigmahat.recording.configuration import PORTS, Port
from sigmahat.recording.units import factor


def of_ports(ports: Mapping[str, Port]) -> Iterator[Finding]:
    """Yields what a configuration says of unit and side of the gear of each port.

    `measured` is the gear ratio; `expected` is the value at the port of 1 in the column, if this
    follows from a scale or a torque constant.
    """
    for name in ("theta", "q", "phi", "tau", "tau_e_sensor"):
        port = ports.get(name)
        if port is None or port.value is not None:
            continue
        key = "gear_ratio" if name == "tau" else "scale" if port.scale is not None else "unit"
        unit = "" if port.scale is not None else port.unit or PORTS[name]
        is_plain = port.scale is None and port.torque_constant is None
        value = None if is_plain else abs(factor(name, port))
        ratio = abs(port.gear_ratio)
        where = f"ports.{name}.{key}"
        yield Finding(Kind.PORT, Severity.RESTS_ON, where, ratio, unit, value, about=name)


def of_size(view: LogView) -> Iterator[Finding]:
    """Yields the largest torque at the link and the largest deformation, for the user to compare.

    A torque in a wrong unit or on the wrong side of the gear multiplies inertia, friction and
    stiffness alike, so a motion agrees with any of them. Only the size of the joint tells.
    """
    if not view.pieces:
        return
    name = "tau_e_sensor" if view.has_sensor else "tau"
    torque = abs(view.gamma) * max(float(np.max(np.abs(piece.tau))) for piece in view.pieces)
    deformation = max(float(np.max(np.abs(piece.phi))) for piece in view.pieces)
    key = f"ports.{name}.{'unit' if view.has_sensor else 'gear_ratio'}"
    yield Finding(
        Kind.LARGEST_TORQUE, Severity.RESTS_ON, key, torque, "N.m", deformation, about=name
    )
