"""Data types for the findings of a check; text.py converts findings to sentences."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from enum import Enum
from typing import Annotated, Any

from pydantic import BeforeValidator, TypeAdapter

from sigmahat.motor.hypotheses.hypothesis import Setting


def _of_json(others: object) -> object:
    return list(others.items()) if isinstance(others, Mapping) else others


# pydantic reads these from JSON, which has null for nan, and an object for pairs.
_Measured = Annotated[float, BeforeValidator(lambda value: math.nan if value is None else value)]
_Others = Annotated[Sequence[tuple[str, Setting | None]], BeforeValidator(_of_json)]


class Severity(str, Enum):
    """Severity of a finding."""

    WRONG = "wrong"  #: The configuration contradicts the log.
    RESTS_ON = "rests on"
    """The result depends on an assumption, and no log can show whether this assumption is right."""
    NOTE = "note"  #: Worth knowing; the configuration may be right.


class Kind(str, Enum):
    """The property of log or configuration that was checked."""

    AT_REST = "positions that do not change"
    SLOPE = "slope of q on theta"
    GEAR = "motor.gamma and the gear ratio"
    SIGN = "sign of the torque"
    STIFFNESS_SIGN = "sign of the stiffness"
    ZERO = "zero of the deformation"
    ASYMMETRY = "symmetry of the spring"
    TORQUE_LAG = "lag of the torque"
    ENCODER_LAG = "lag between the encoders"
    INERTIA = "inertia of the motor"
    TORQUE_SCALE = "scale of the torque"
    OTHER_ROBOT = "motor data of another robot"
    PORT = "unit and side of the gear of a port"
    LARGEST_TORQUE = "largest torque at the link"
    SIZE = "size of the joint"
    STEP = "step of the encoder"
    JUMP = "jumps of the encoder"
    SPIKE = "single samples far off"
    PLACEHOLDER = "values in place of samples"
    HELD = "samples that repeat an earlier one"
    FROZEN = "a position that stops changing"
    SATURATION = "saturation of the torque"
    NO_TORQUE = "torque that is only noise"
    NOISE = "prediction error and noise"
    UNEXPLAINED = "torque that the motion does not explain"
    MISFIT = "misfit of the model"
    DOUBT = "reasons of doubt"
    RANGE = "range of the deformation"
    LEARNED = "share of ticks that learned"
    TORQUE_GAIN = "gain of the torque"
    EXACT = "motor data taken as exact"
    ABSENT = "effects taken as absent"


@dataclass(frozen=True)
class Finding:
    """One finding of a check, such as an error of the configuration."""

    kind: Kind  #: What was checked.
    severity: Severity  #: How much the finding matters.
    key: str
    """The key of the configuration to look at first, as "ports.tau.sign" or "motor.gamma"."""
    measured: _Measured  #: What the log shows, in `unit`.
    unit: str  #: Unit of `measured` and `expected`; "" for a number without a unit.
    expected: float | None = None
    """The configured or the usual value, in `unit`; None if no such value exists."""
    proposed: Setting | None = None
    """A value of the key that agrees with the log; None if the log shows no such value."""
    others: _Others = ()
    """Other keys that would explain the finding, each key with the value required."""
    about: str = ""
    """Detail of the kind: a port, a parameter of the FMU, or an item of the FMU's output doubt."""
    row: int | None = None  #: First row of the log that shows the finding, from 1 on, if one does.

    def as_dict(self) -> dict[str, Any]:
        """Returns the finding for JSON."""
        return asdict(self) | {"others": dict(self.others)}

    @property
    def keys(self) -> Sequence[str]:
        """All keys that explain the finding, the most likely key first."""
        return (self.key, *(key for key, _ in self.others))


_NO_FIT = (Kind.UNEXPLAINED, Kind.MISFIT, Kind.FROZEN)


@dataclass(frozen=True)
class Checked:
    """The result of all checks."""

    findings: Sequence[Finding]
    """Errors first, then assumptions that no log can verify, then notes."""
    ticks: int  #: Number of ticks of the estimator that were checked.
    T: float  #: Time between ticks [s].

    def of(self, severity: Severity) -> Sequence[Finding]:
        return [each for each in self.findings if each.severity is severity]

    @property
    def is_wrong(self) -> bool:
        """Whether the configuration contradicts the log."""
        return bool(self.of(Severity.WRONG))

    @property
    def fits(self) -> bool:
        """Whether nothing found says that the log does not fit the model, for whatever reason."""
        return not any(each.kind in _NO_FIT or each.about == "Misfit" for each in self.findings)


def as_dict(checked: Checked) -> dict[str, Any]:
    return {
        "wrong": checked.is_wrong,
        "ticks": checked.ticks,
        "samplePeriod": checked.T,
        "units": {"samplePeriod": "s"},
        "findings": [each.as_dict() for each in checked.findings],
    }


def findings_of(values: Sequence[Mapping[str, Any]]) -> list[Finding]:
    """Reads findings from as_dict(). Raises ValidationError for values that are no findings."""
    return TypeAdapter(list[Finding]).validate_python(values)
