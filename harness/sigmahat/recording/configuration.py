"""Reads the configuration of a log: columns for the ports, and parameters of the estimator.

docs/log-reference.md has an example, and several_joints.py describes the file for several joints.
The format TOML is easy to read, and tomlkit keeps the comments when identify writes the file.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field, fields
from pathlib import Path
from typing import Annotated, Any

import tomlkit
from pydantic import AfterValidator, AllowInfNan, ConfigDict, Strict, TypeAdapter, ValidationError
from pydantic_core import ErrorDetails, PydanticCustomError

from sigmahat.files import toml_file
from sigmahat.fmi.model import Value
from sigmahat.fmi.quoted import cause, quoted
from sigmahat.fmi.unknown_name import unknown
from sigmahat.recording import several_joints
from sigmahat.recording.deformation import missing_position
from sigmahat.recording.log import LogError

INPUTS = {"theta": "rad", "q": "rad", "theta_c": "rad", "tau": "N.m", "tau_e_sensor": "N.m"}
"""Inputs of StiffnessEstimator and their units."""
PORTS = {**INPUTS, "phi": "rad"}
"""What a column of a log may be, and its unit: an input, or the deformation phi = q - theta, which
takes the place of the position that is not measured."""

FILL_IN = "FILL IN"
"""Placeholder for an unknown column or unit, and first words of comments on missing values."""
_ANGLE_UNIT = "rad, mrad, deg or turn"
QUESTIONS = {
    **{("unit", port): _ANGLE_UNIT for port in ("theta", "q", "phi")},
    ("unit", "tau"): "N.m, mN.m or kN.m; A or mA if it is a current, with torque_constant; or "
    "scale in place of unit [N.m]",
    ("unit", "tau_e_sensor"): "N.m, mN.m or kN.m; or scale in place of unit [N.m]",
    ("gear_ratio", "tau"): "1 if tau is the torque of the motor, before the gear; the ratio of the "
    "gear if it is the torque of the joint, after the gear",
    ("gear_ratio", "theta"): "1 if theta is after the gear, else the ratio of the gear",
}
"""The choices for values that neither the names nor the samples of a log may show, by key of a port
and port. `init` asks for them, and every command refuses a file with an open one."""
AS = {port: f"as {port}" for port in ("theta", "q")}
"""Units of a position that is in the unit of another port: one answer of the user for both."""
_OF_THE_DATA_SHEET = "the value from the data sheet of your device"
NOT_YOURS = "not known: of another robot, until identify finds it or you set it"
"""Comment of a motor parameter that the user has not set."""
WIDE_PRIOR = "wide, because it is not known; make it smaller if you know better"
"""Comment of the prior of a motor parameter that the user has not set."""
ANOTHER_ROBOT = 1000.0
"""Prior of unknown motor data: small and large motors differ by this factor."""
ANY_COULOMB = 1.0
"""Value of prior.tau_coulomb for unknown friction [N.m]: a large value reduces accuracy little."""

_NEEDED = {"Residual": ("theta", "q", "tau"), "Sensor": ("q", "tau_e_sensor"), "Model": ("q",)}
"""Ports that a modality needs."""


def _not_zero(value: float) -> float:
    if value == 0:
        raise PydanticCustomError("zero", "not 0")
    return value


def _one(value: float) -> float:
    if abs(value) != 1:
        raise PydanticCustomError("expected", "1 or -1")
    return value


# Types of the values in a file; pydantic checks files, but not objects made by Python code.
Number = Annotated[float, Strict(), AllowInfNan(False)]
NotZero = Annotated[Number, AfterValidator(_not_zero)]
Sign = Annotated[Number, AfterValidator(_one)]
_NO_OTHER_KEYS = ConfigDict(extra="forbid")


@dataclass(frozen=True)
class Port:
    """A column of a log as an input of the estimator: sign (x - zero) / gear_ratio, in its unit."""

    __pydantic_config__ = _NO_OTHER_KEYS

    column: str = ""  #: Name of the column in the log.
    value: Number | None = None
    """Constant value of the port in its unit, instead of a column, as for a locked link."""
    time: str | None = None
    """Column with the times of this port, if they differ from [time]; in the unit of [time]."""
    unit: str | None = None  #: Unit of the column; by default, the unit of the port.
    sign: Sign = 1.0  #: 1 or -1.
    zero: Number = 0.0  #: Value of the column at the zero of the port, in the unit of the column.
    gear_ratio: NotZero = 1.0
    """For an encoder on the motor's shaft, or a torque measured after the gear."""
    counts_per_turn: NotZero | None = None  #: For the unit counts.
    torque_constant: NotZero | None = None  #: For a current [N.m/A].
    mm_per_turn: NotZero | None = None
    """For a length: travel per turn of the motor. If not given, the port takes the number of mm."""
    step: NotZero | None = None
    """Step in which the values change, in the unit of the column: of an encoder, or by rounding."""
    scale: NotZero | None = None
    """Instead of a unit: value of the port, in its unit, per 1 in the column."""
    wrap: NotZero | None = None
    """Period after which the values start again, in the unit of the column."""
    delay: Number = 0.0
    """Delay of the column relative to other columns [s]: samples are moved back by this time."""


@dataclass(frozen=True)
class Time:
    """The times of the samples in a log."""

    __pydantic_config__ = _NO_OTHER_KEYS

    column: str | None = None
    """Name of the column in the log; if not given, rows are samplePeriod apart."""
    unit: str = "s"  #: Unit of the column.
    longest_gap: NotZero | None = None
    """Longest time between two samples over which values are interpolated [s]."""


@dataclass(frozen=True)
class Temperature:
    """The temperature of the motor, for `sigmahat health`."""

    __pydantic_config__ = _NO_OTHER_KEYS

    column: str  #: Name of the column in the log, in degC.


@dataclass(frozen=True)
class Configuration:
    """The contents of a configuration file."""

    path: Path  #: The file.
    time: Time  #: When the samples were taken.
    ports: Mapping[str, Port]  #: Ports by input of `StiffnessEstimator`.
    parameters: Mapping[str, Value]  #: Start values of `StiffnessEstimator`, by its names.
    joint: str = ""  #: Name of the joint in a file of several joints.
    temperature: str | None = None  #: Column with the temperature of the motor [degC].

    @property
    def inputs(self) -> Mapping[str, Port]:
        """The ports by input of the estimator; that of phi gives the position that follows."""
        follows = missing_position(self.ports)
        return {follows if name == "phi" and follows else name: p for name, p in self.ports.items()}

    @property
    def columns(self) -> list[str]:
        """Names of the columns of the log that are used, each once."""
        ports = self.ports.values()
        named = [self.time.column, *(p.column for p in ports), *(p.time for p in ports)]
        named.append(self.temperature)
        return [*dict.fromkeys(name for name in named if name)]

    def need_ports(self, modality: str) -> None:
        """Raises LogError if a port is missing that the modality needs."""
        for name in _NEEDED.get(modality, ()):
            if name not in self.inputs:
                raise LogError(
                    f"{self.path}: modality {modality} needs [ports.{name}]; add it, "
                    "or choose another modality in [parameters]"
                )


def _port_name(name: str) -> str:
    if name not in PORTS:
        raise PydanticCustomError("unknown", "{text}", {"text": unknown("port", name, PORTS)})
    return name


@dataclass(frozen=True)
class _ConfigurationFile:
    """The sections of a configuration file."""

    __pydantic_config__ = _NO_OTHER_KEYS

    ports: dict[Annotated[str, AfterValidator(_port_name)], Port]
    time: Time = field(default_factory=Time)
    parameters: dict[str, Any] = field(default_factory=dict)
    identified: Any = None  # results of identify, for people to read
    temperature: Temperature | None = None


def read_configuration(path: str | Path, joint: str = "") -> Configuration:
    """Reads and checks a file; from a file of several joints, the configuration of one joint.

    Raises LogError, which names the place of the error in the file.
    """
    path = Path(path)
    return checked_configuration(read_document(path), path, joint)


def checked_configuration(
    document: tomlkit.TOMLDocument, path: Path, joint: str = ""
) -> Configuration:
    """Checks the configuration in a document, which need not be written to the file yet.

    Raises LogError, which names the place of the error in the document.
    """
    known = joints_of(document, path)
    if joint not in known:
        what = f"expected the name of one of its joints ({', '.join(known)})"
        if joint:
            one = f"it is the configuration of one joint, expected no name, got {quoted(joint)}"
            what = one if known == [""] else unknown("joint", joint, known)
        raise LogError(f"{path}: {what}")
    values = several_joints.of_joint(document, joint).unwrap()
    values["ports"] = with_units(values.get("ports", {}))
    _refuse_open(values, path)
    try:
        file = TypeAdapter(_ConfigurationFile).validate_python(values)
    except ValidationError as error:
        # A misspelt key is the reason why another key is missing.
        errors = sorted(error.errors(), key=lambda each: each["type"] != _MISSPELT)
        raise LogError(f"{path}: {_explain(errors[0])}") from error
    if not file.ports:
        raise LogError(f"{path}: {_NO_PORTS}")
    for name, port in file.ports.items():
        if (port.value is None) == (not port.column):
            what = "has no column" if port.value is None else "has a column and a value"
            raise LogError(
                f"{path}: [ports.{name}] {what}; name a column of the log, or set value "
                "if the signal is constant"
            )
    _refuse_repeated(file, path)
    if "phi" in file.ports and len(file.ports.keys() & {"theta", "q"}) != 1:
        raise LogError(
            f"{path}: phi is q - theta, expected one of [ports.theta] and [ports.q] with "
            f"[ports.phi], got {'both' if 'q' in file.ports else 'none'}; "
            f"{'remove' if 'q' in file.ports else 'add'} one of them"
        )
    parameters = dict(toml_file.dotted(file.parameters))
    column = file.temperature.column if file.temperature else None
    return Configuration(path, file.time, file.ports, parameters, joint, column)


def with_units(ports: Any) -> Any:
    """Returns the section [ports] with the unit, or the scale, of the port that `as` names.

    A section without the named port is unchanged; its unit is refused when it is used.
    """
    if not isinstance(ports, dict) or not all(isinstance(each, dict) for each in ports.values()):
        return ports  # a wrong file, to be explained by its reader
    whole = dict(ports)
    for name, port in ports.items():
        other = next((each for each, unit in AS.items() if unit == port.get("unit")), None)
        if other in ports and other != name:
            shared = {key: ports[other][key] for key in ("unit", "scale") if key in ports[other]}
            whole[name] = {key: port[key] for key in port if key != "unit"} | shared
    return whole


def _refuse_open(values: Mapping[str, Any], path: Path) -> None:
    """Raises LogError for a question of `init` without an answer; log.py refuses the columns."""
    for key, value in toml_file.dotted(values):
        if value == FILL_IN and not key.endswith(".column"):
            raise LogError(f"{path}: {key} is {FILL_IN}; fill in {choices(key)}")


def choices(key: str) -> str:
    """Describes the values that a key such as "ports.tau.gear_ratio" may have."""
    _, port, name = f"..{key}".rsplit(".", 2)
    return QUESTIONS.get((name, port), _OF_THE_DATA_SHEET)


def _refuse_repeated(file: _ConfigurationFile, path: Path) -> None:
    """Raises LogError if a column is used for two ports, or for a port and for the time.

    Only the port tau_e_sensor may share a column, as for the motor of a compliant test bench.
    """
    used = {file.time.column: "time"}
    for name, port in file.ports.items():
        if port.column in ("", FILL_IN) or name == "tau_e_sensor":
            continue
        if port.column in used:
            raise LogError(
                f"{path}: [{used[port.column]}] and [ports.{name}] both use the column "
                f"{quoted(port.column)}; name another column for one of them. A table in "
                "long form, with rows of motor and link in turn, needs a column for each first"
            )
        used[port.column] = f"ports.{name}"


def joints_of(document: tomlkit.TOMLDocument, path: Path) -> list[str]:
    """Returns the names of the joints, [""] for one joint. Raises LogError for a wrong name."""
    try:
        return several_joints.names(document)
    except ValueError as error:
        raise LogError(f"{path}: {error}") from error


def read_document(path: Path) -> tomlkit.TOMLDocument:
    """Reads a TOML file with its comments. Raises LogError if the file is missing or not TOML."""
    try:
        return toml_file.read(path)
    except OSError as error:
        hint = "write one with `sigmahat init LOG`, or name another file"
        raise LogError(f"{path}: {error.strerror}; {hint}") from error
    except ValueError as error:
        raise LogError(f"{path}: not TOML ({cause(error)})") from error


_SECTIONS: Mapping[str, type] = {"time": Time, "temperature": Temperature}
_NO_PORTS = "no [ports.*]; `sigmahat init LOG` writes a file to start from"
_MISSPELT = "unexpected_keyword_argument"
_KINDS = {"string_type": "text", "float_type": "a number", "finite_number": "a finite number"}


def _explain(error: ErrorDetails) -> str:
    """Describes an error in a configuration file: its place and the expected value."""
    what, where = error["type"], ".".join(map(str, error["loc"]))
    section, _, key = where.rpartition(".")
    if what == _MISSPELT:
        kind = Port if "." in section else _SECTIONS.get(section, _ConfigurationFile)
        place = f"key in [{section}]" if section else "section"
        return unknown(place, key, [each.name for each in fields(kind)])
    if what == "missing":
        return f"[{section}] has no {key}; name a column of the log" if section else _NO_PORTS
    if what == "unknown":
        return error["msg"]
    if what == "zero":
        return f"{where} is 0; fill in {choices(where)}"
    table = f"a table [{where}]"
    expected = _KINDS.get(what, table if what in ("dict_type", "dataclass_type") else error["msg"])
    return f"{where}: expected {expected}, got {quoted(error['input'])}"
