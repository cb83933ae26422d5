"""What the configuration shows without the log: keys that contradict each other, and what the
answer rests on."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from sigmahat.checks.findings import Finding, Kind, Severity
from sigmahat.fmi.instance import Value
from sigmahat.logs.assumptions import absent, exact
from sigmahat.logs.configuration import Configuration

_AWAS = ("motor.B", "motor.D_theta", "motor.gamma")
_SAME = 0.01
"""Two gear ratios are the same up to this."""


def gears(configuration: Configuration, every: Mapping[str, Value]) -> Iterator[Finding]:
    """motor.gamma beside the gear of the encoder and of the torque."""
    gamma = abs(float(every["motor.gamma"]))
    for name in ("theta", "tau"):
        port = configuration.ports.get(name)
        gear = abs(port.gear_ratio) if port else 1.0
        if gear == 1 or abs(gamma / gear - 1) < _SAME:
            continue
        own = (f"ports.{name}.gear_ratio", gamma)
        keys = [("motor.gamma", gear), own] if name == "theta" else [own, ("motor.gamma", gear)]
        (key, proposed), other = keys
        measured, expected = (gamma, gear) if name == "theta" else (gear, gamma)
        yield Finding(
            Kind.GEAR, Severity.WRONG, key, measured, "", expected, proposed, [other], name
        )


def rests_on(
    configuration: Configuration,
    every: Mapping[str, Value],
    start: Mapping[str, Value],
    per_gain: float,
) -> Iterator[Finding]:
    """What no log shows.

    start     start values of the FMU
    per_gain  relative change of the stiffness with a relative change of the gain of the torque
    """
    tau = configuration.ports.get("tau")
    is_current = tau is not None and tau.torque_constant is not None
    key = "ports.tau.torque_constant" if is_current else "prior.torque_gain"
    gain = float(every["prior.torque_gain"])
    yield Finding(Kind.TORQUE_GAIN, Severity.RESTS_ON, key, per_gain, "", gain)
    if every["modality"] == "Residual" and all(every[name] == start[name] for name in _AWAS):
        gamma = float(every["motor.gamma"])
        yield Finding(Kind.OTHER_ROBOT, Severity.RESTS_ON, "motor.gamma", gamma, "")
    if every["method"] != "FilteredRegression":
        return
    for name in exact(every):
        value = float(every[f"motor.{name}"])
        yield Finding(Kind.EXACT, Severity.RESTS_ON, f"prior.{name}", value, "", about=name)
    for name in absent(every):
        yield Finding(Kind.ABSENT, Severity.RESTS_ON, f"prior.{name}", 0.0, "", about=name)
