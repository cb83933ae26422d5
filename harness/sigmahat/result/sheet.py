"""Defines and writes the data sheet of a joint, `joint.json`: results of an estimation, and start
values with which the FMU continues from these results.

Numbers are written with all digits, so that a reader gets exactly the estimates.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from datetime import datetime
from typing import Annotated

import numpy as np
from numpy.typing import NDArray
from pydantic import AfterValidator, Field

from sigmahat.estimator.estimator import Estimator
from sigmahat.estimator.instances import QUANTITIES
from sigmahat.estimator.powers import powers_of_phi
from sigmahat.fmi.model import Value, installed_model
from sigmahat.fmi.unknown_name import unknown
from sigmahat.result.excitation import Excitation
from sigmahat.result.stored import (
    NO_OTHER_KEYS,
    Digest,
    FmuId,
    Format,
    LearnedLog,
    Name,
    Range,
    Text,
    Unit,
    Version,
    Word,
    form,
)

Array = NDArray[np.float64]

UNITS = {"phi": "rad", "set_point": "1", "sigma": "N.m/rad", "tau_e": "N.m", "misfit": "1"}
WORDS = {
    "gamma": "gear ratio",
    "B": "inertia of the motor",
    "D_theta": "viscous friction of the motor",
    "tau_coulomb": "Coulomb friction of the motor",
    "bias": "bias of the torque",
    "damping": "damping of the joint",
    "load_friction": "friction by load",
    "eccentric": "eccentricity of the encoders",
    "delay": "delay of the torque",
    "hysteresis": "hysteresis",
}
"""Descriptions of the parameters and the effects of the joint for users."""
_ROUNDING = 1e-6  # of a covariance, relative
_HIGHEST = 30  # power; those of the estimator are far below
_NEEDED = ("gamma", "B", "D_theta")  # parameters of every joint
_CURVE = "rls.eta_0["
_Source = Annotated[Text, form("identify|prior|exact", "identify, prior or exact")]


@dataclass(frozen=True)
class Source:
    """The configuration file from which the data sheet was created."""

    __pydantic_config__ = NO_OTHER_KEYS

    file: Text  # path of the file
    sha256: Digest | None  # of the bytes; None if the file does not exist


@dataclass(frozen=True)
class Stiffness:
    """The stiffness at one deformation and set-point, with its interval."""

    __pydantic_config__ = NO_OTHER_KEYS

    phi: float  # deformation [rad]
    set_point: float  # set-point [1]
    sigma: float  # stiffness at this point [N.m/rad]
    interval: Range | None  # 95 % interval [N.m/rad]; None: the method gives none


@dataclass(frozen=True)
class Polynomial:
    """Torque of the spring: sum of eta[i][j] set-point^powers_of_set_point[j] phi^powers_of_phi[i].

    The stiffness is the derivative of the torque with respect to phi.
    """

    __pydantic_config__ = NO_OTHER_KEYS

    powers_of_phi: list[int]
    powers_of_set_point: list[int]
    eta: list[list[float]]  #: [size: powers of phi x powers of the set-point]
    units: list[list[Unit]]  #: Units of eta; phi is in rad, the set-point has no unit.
    phi: Range | None
    """Range of the measured deformation [rad]; outside, the polynomial is extrapolated."""
    set_point: Range | None  #: Range of the set-point in the data [1].

    def __post_init__(self) -> None:
        """Raises ValueError for powers that do not fit the coefficients."""
        n, m = len(self.powers_of_phi), len(self.powers_of_set_point)
        if not n * m or [len(row) for row in self.eta] != [m] * n:
            raise ValueError(f"expected {n} x {m} coefficients eta, one or more")
        powers = *self.powers_of_phi, *self.powers_of_set_point
        if not all(0 <= power <= _HIGHEST for power in powers):
            raise ValueError(f"expected powers from 0 to {_HIGHEST}")

    def at(self, phi: Array, set_point: float | Array) -> tuple[Array, Array]:
        """Torque [N.m] and stiffness [N.m/rad] at deformations [rad].

        set_point  one for all deformations, or one for each [1]
        """
        powers = np.power.outer(np.asarray(set_point, dtype=float), self.powers_of_set_point)
        rows = np.array(self.eta) @ powers.T
        torque, stiffness = np.zeros_like(phi), np.zeros_like(phi)
        for coefficient, power in zip(rows, self.powers_of_phi, strict=True):
            torque += coefficient * phi**power
            if power:
                stiffness += coefficient * power * phi ** (power - 1)
        return torque, stiffness

    @property
    def is_of_set_point(self) -> bool:
        """Whether the torque depends on the set-point."""
        return any(any(row[1:]) for row in self.eta)


@dataclass(frozen=True)
class Parameter:
    """A parameter of the joint."""

    __pydantic_config__ = NO_OTHER_KEYS

    value: float
    unit: Unit
    interval: Range | None
    """95 % interval; None if the value is taken as exact, or the method gives no interval."""
    interval_from: _Source  # or that no interval is needed: exact


@dataclass(frozen=True)
class RestsOn:
    """Assumptions of the result that no data can verify."""

    __pydantic_config__ = NO_OTHER_KEYS

    torque_gain: float
    """Relative standard deviation of the gain of the torque [1]; the intervals include it."""
    sigma_per_gain: float  # relative change of the stiffness per relative change of the gain [1]
    exact: list[Name]  # parameters that are taken as exact
    absent: list[Word]  # effects that are taken as absent


@dataclass(frozen=True)
class Check:
    """Outputs of the FMU with the start values, before any sample, to verify these values."""

    __pydantic_config__ = NO_OTHER_KEYS

    sigma: float  # [N.m/rad]
    tau_e: float  # [N.m]


def _is_time(text: str) -> str:
    """Raises ValueError for a text that is no time with a zone."""
    time = datetime.fromisoformat(text)
    if time.tzinfo is None:
        raise ValueError("expected a time with its zone, such as 2026-03-02T08:15:00+00:00")
    return text


@dataclass(frozen=True)
class Recording:
    """The recording of the last log."""

    __pydantic_config__ = NO_OTHER_KEYS

    time: Annotated[Text, AfterValidator(_is_time)] | None
    """Of its first sample, by ISO 8601 with a zone; None if it is unknown."""
    source: Annotated[Text, form("given|log|name|unknown", "given, log, name or unknown")]
    """Where the time comes from: the user, the clock of the log, a date in the name of the file."""
    temperature: float | None  # of the motor, mean [degC]; None if it was not measured


@dataclass(frozen=True)
class Prior:
    """What the estimator was told of a quantity before the first log."""

    __pydantic_config__ = NO_OTHER_KEYS

    mean: float
    std: Annotated[float, Field(ge=0)]  # standard deviation; 0: the quantity is taken as exact


@dataclass(frozen=True)
class Together:
    """Estimates at the end with their covariance, which a comparison with other logs needs.

    The first values are the stiffness at the points; the quantities follow. The covariance does not
    contain the gain of the torque. A quantity with variance 0 is taken as exact or absent.
    """

    __pydantic_config__ = NO_OTHER_KEYS

    phi: list[float]  # deformations of the points, in the range of the data [rad]
    set_point: list[float]  # set-points of the points [1]
    quantities: list[Name]
    values: list[float]
    per_gain: list[float]  # change of each value per relative change of the gain of the torque
    covariance: list[list[float]]
    prior: dict[Name, Prior]  # of the quantities that have one mean and one standard deviation

    def __post_init__(self) -> None:
        """Raises ValueError for sizes that do not fit."""
        size = len(self.phi) + len(self.quantities)
        rows = [len(row) for row in self.covariance]
        if len(self.set_point) != len(self.phi) or rows != [size] * size:
            raise ValueError(f"expected a covariance of {size} x {size} numbers")
        if not len(self.values) == len(self.per_gain) == size:
            raise ValueError(f"expected {size} values, and as many changes per gain")


def consistent(together: Together) -> Together:
    """Returns estimates that an estimator can have written.

    Raises ValueError without a point, for other quantities than QUANTITIES, and for a covariance
    that is not symmetric and positive semi-definite.
    """
    if not together.phi or together.quantities != list(QUANTITIES):
        raise ValueError(f"expected one or more points, and the quantities {', '.join(QUANTITIES)}")
    P = np.array(together.covariance)
    variances = np.diag(P)
    scale = np.sqrt(np.where(variances > 0, variances, 1.0))
    correlation = P / np.outer(scale, scale)
    is_possible = float(np.min(variances)) >= 0 and np.abs(P - P.T).max() <= _ROUNDING * P.max()
    if not is_possible or np.linalg.eigvalsh(correlation)[0] < -_ROUNDING:
        raise ValueError(
            "expected a covariance that is symmetric and positive semi-definite, with variances of "
            f"0 or more; the least variance is {variances.min():.3g}"
        )
    return together


def _parameters_of_a_joint(parameters: dict[str, Parameter]) -> dict[str, Parameter]:
    """Raises ValueError for names that no joint has, and for missing ones."""
    for name in _NEEDED:
        if name not in parameters:
            raise ValueError(f"expected the parameter {name}")
    for name in parameters:
        if name not in WORDS:
            raise ValueError(unknown("parameter of a joint", name, WORDS))
    return parameters


def _of_an_estimator(start: dict[str, Value]) -> dict[str, Value]:
    """Raises ValueError unless there are a bandwidth and a full matrix of coefficients."""
    if not isinstance(start.get("regression.bandwidth"), (int, float)):
        raise ValueError("expected the number regression.bandwidth")
    places = {tuple(name[len(_CURVE) : -1].split(",")) for name in start if name.startswith(_CURVE)}
    n, m = (len({place[k] for place in places if len(place) == 2}) for k in (0, 1))
    if not places or places != {(str(i), str(j)) for i in range(n) for j in range(m)}:
        raise ValueError("expected a full matrix of coefficients rls.eta_0[i,j]")
    return start


@dataclass(frozen=True)
class Sheet:
    """The contents of the data sheet `joint.json`."""

    __pydantic_config__ = NO_OTHER_KEYS

    format: Text
    version: int
    sigmahat: Version  # version of the package that wrote the file
    units: dict[Word, Unit]
    """Units of the numbers with these keys in the file; an interval has the unit of its value."""
    fmu: FmuId
    joint: Text  # name of the joint in the configuration; "" if this is of one joint
    recorded: Recording
    logs: list[LearnedLog]  # logs that the estimator has processed, in this order
    configuration: Source
    method: Word
    modality: Word
    at_the_end: Stiffness  # the last estimate
    confident: bool  # whether the estimator was confident at the end
    doubt: Word  # why the estimator was not confident
    misfit: float  # misfit of the model; 1 if the model holds [1]
    polynomial: Polynomial
    curve: list[Stiffness] | None
    """The stiffness in the range of the data; None if the method gives no interval."""
    parameters: Annotated[dict[Text, Parameter], AfterValidator(_parameters_of_a_joint)]
    rests_on: RestsOn
    start_values: Annotated[dict[Name, bool | int | float | Text], AfterValidator(_of_an_estimator)]
    """Start values of the FMU by name, with which the FMU continues from the estimate."""
    check: Check
    together: Annotated[Together, AfterValidator(consistent)] | None
    """Estimates with their covariance, for `sigmahat health`; None if the method gives none."""
    excitation: Excitation  # how the last log moved the joint


FORMAT = Format("joint.json", "sigmahat joint data sheet", 2, Sheet)  # format of the file


def origin(sheet: Sheet) -> Iterator[str]:
    """Yields lines about the origin of the values, for comments in other files."""
    for log in sheet.logs:
        yield f"learned from {log.file}, SHA-256 {log.sha256}"
    yield f"written by sigmahat {sheet.sigmahat}"


def _units(powers: Sequence[int], m: int) -> list[list[str]]:
    """Returns the units of the coefficients, with m powers of the set-point."""
    return [[{0: "N.m", 1: "N.m/rad"}.get(power, f"N.m/rad{power}")] * m for power in powers]


def polynomial(
    start: Mapping[str, Value], phi: Range | None, set_point: Range | None
) -> Polynomial:
    """Creates the polynomial of start values; phi and set_point are the ranges of the data."""
    n, m = int(start["rls.n"]), int(start["rls.m"])
    powers = powers_of_phi(bool(start["rls.symmetric"]), n)
    return Polynomial(
        powers_of_phi=powers,
        powers_of_set_point=list(range(m)),
        eta=[[float(start[f"rls.eta_0[{i},{j}]"]) for j in range(m)] for i in range(n)],
        units=_units(powers, m),
        phi=phi,
        set_point=set_point,
    )


_MOST_POWERS = 8  # largest rls.n of the FMU
_MOST_COEFFICIENTS = 24  # limit, so that columns remain in the FMU for further effects
_SAME = 1e-6  # relative difference of two stiffnesses by rounding


def with_knees(
    curve: Polynomial, phi: Array, set_point: Array, tau_e: Array, sigma: Array
) -> Polynomial:
    """Fits a polynomial to the curve of an estimator, whose slope may change suddenly at knees.

    The given coefficients do not contain the knees. Without knees, the curve is unchanged.

    phi, set_point, tau_e, sigma   outputs of the estimator [rad, 1, N.m, N.m/rad], of one size
    """
    torque, stiffness = curve.at(phi, set_point)
    torque, beyond = tau_e - torque, sigma - stiffness
    if not np.any(np.abs(beyond) > _SAME * np.max(np.abs(sigma), initial=0.0)):
        return curve
    m = len(curve.powers_of_set_point)
    most = min(_MOST_POWERS, _MOST_COEFFICIENTS // m)
    powers = powers_of_phi(0 not in curve.powers_of_phi, max(most, len(curve.eta)))
    largest = float(np.max(np.abs(phi)))
    x = phi / largest
    rows = [np.concatenate([x**e, e * x ** max(e - 1, 0)]) for e in powers]
    wanted = np.concatenate([torque, beyond * largest])
    found = np.linalg.lstsq(np.transpose(rows), wanted, rcond=None)[0].tolist()
    eta = [*map(list, curve.eta), *([0.0] * m for _ in powers[len(curve.eta) :])]
    for row, coefficient, e in zip(eta, found, powers, strict=True):
        row[0] += coefficient / largest**e
    return replace(curve, powers_of_phi=powers, eta=eta, units=_units(powers, m))


def start_of(curve: Polynomial) -> dict[str, Value]:
    """Returns the start values with which an FMU has the given curve."""
    start: dict[str, Value] = {
        f"rls.eta_0[{i},{j}]": float(x) for (i, j), x in np.ndenumerate(curve.eta)
    }
    return {**start, "rls.n": len(curve.eta), "rls.m": len(curve.eta[0])}


_NOT_IN_A_RUN = (
    *("B", "load_friction", "eccentric", "eccentric_motor", "delay", "reversal", "power", "gap"),
    "hysteresis",
)
"""Names of the priors of effects that are equal in all recordings of a joint."""
_NONE = 1e-6  # uncertainty of a curve: so small that the curve does not change
_LARGEST = 1e12  # largest prior that the FMU accepts


def start_values(estimator: Estimator) -> dict[str, Value]:
    """Returns start values of the FMU from the present curve and motor data of an estimator.

    FilteredRegression may use higher powers than given by rls.n and rls.m; all powers are returned.
    Priors do not change: the FMU takes the curve as the mean of its prior. The uncertainty of the
    curve is lost.

    estimator  for one joint
    """
    model, (parameters,) = installed_model("StiffnessEstimator"), estimator.parameters
    eta = [name for name in model.variables if name.startswith("eta[")]
    values = {name: estimator.output(name) for name in eta}
    at = {name: tuple(map(int, name[4:-1].split(","))) for name in eta}
    used = [at[name] for name in eta if values[name]]
    n = max([int(parameters["rls.n"]), *(i + 1 for i, _ in used)])
    m = max([int(parameters["rls.m"]), *(j + 1 for _, j in used)])
    start = {name: value for name, value in parameters.items() if not name.startswith(_CURVE)}
    start |= {"rls.n": n, "rls.m": m}
    for name in ("B", "D_theta"):
        value = estimator.output(f"{name}_hat")
        least = float(model.variable(f"motor.{name}").min or 0.0)
        if value > 0 and value >= least:
            start[f"motor.{name}"] = value  # the FMU refuses others, and `doubt` reports them
    for name, (i, j) in at.items():
        if i < n and j < m:
            start[f"{_CURVE}{i},{j}]"] = values[name]
    kinds = {name: model.variable(name).type for name in start}
    return {n: bool(v) if kinds[n] == "Boolean" else v for n, v in start.items()}


def as_fixed_curve(start: Mapping[str, Value]) -> dict[str, Value]:
    """Returns start values with which the curve and the inertia are not estimated.

    Only effects are estimated that differ between recordings. These are bias of the torque or zero
    of the deformation, friction, and a time lag between the encoders (as a damping). Other effects
    would hide a wrong stiffness: a delay of the torque, for example, looks like a wrong stiffness
    in a motion of one frequency.

    start  from start_values, of the method FilteredRegression
    """
    fixed = {**start, **{f"prior.{name}": 0.0 for name in _NOT_IN_A_RUN}}
    fixed |= {"regression.memory": 0.0, "regression.drift": 0.0}
    tau_e = float(start["prior.tau_e"])
    if not tau_e:
        return {**fixed, "prior.nominal": _NONE}
    # Priors that are relative to prior.tau_e keep their absolute value.
    shares = ("bias", "damping")
    wider = {f"prior.{n}": min(float(start[f"prior.{n}"]) / _NONE, _LARGEST) for n in shares}
    return {**fixed, **wider, "prior.nominal": 0.0, "prior.tau_e": tau_e * _NONE}
