"""The estimator as an object: over arrays of samples, or tick by tick in a loop of Python."""

from __future__ import annotations

import logging
import math
from collections.abc import Callable, Container, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sigmahat.estimator.instances import INPUTS, Joints
from sigmahat.fmi.model import Value
from sigmahat.fmi.series import Series

Array = NDArray[np.float64]

RECORD = ("sigma", "sigma_std", "tau_e", "phi", "misfit", "confident", "valid")
"""Outputs that are recorded by default."""

POINT = ("tau_e", "tau_e_std", "sigma", "sigma_std", "sigma_per_gain")
"""Results of evaluate(), as in sh_point."""

_LONG = 1.0  # [s] a motion that is compared with range.phi
_FAR, _WIDE = 1.2, 8.0  # ratio of the largest deformation to range.phi, and inverse ratio
_MOST_MISSING = 1_000_000  # samples that restart_filters() leaves out
_NEEDED = {
    "Residual": ("theta", "q", "tau"), "Sensor": ("theta", "q", "tau_e_sensor"),
    "Model": ("theta", "q"),
}  # fmt: skip
"""Inputs without which a modality has no torque."""


@dataclass(frozen=True)
class Covariance:
    """Estimates of one joint that were made together, with their covariance.

    The first are the stiffness at points [N.m/rad]. Behind them are the QUANTITIES: B [kg.m2],
    D_theta [N.m.s/rad], tau_coulomb [N.m], load_friction [1], hysteresis [N.m], and lost_torque
    [N.m], by which a dead zone reduces the torque of the spring beyond it. A quantity that is taken
    as exact or absent has the variance 0.
    """

    values: Array  #: [size: points + 6]
    per_gain: Array  #: Change with a relative change of the gain of the torque, of the same size.
    covariance: Array  #: Without the gain of the torque [size: (points + 6) x (points + 6)].


def _missing(parameters: Mapping[str, Value]) -> int:
    """Number of missing samples after which the filters start again."""
    if parameters["method"] != "Paper2011":
        return 1
    constant = float(parameters["residual.K_I"]) * float(parameters["samplePeriod"])
    return math.ceil(min(2 / constant, _MOST_MISSING))


class Estimator:
    """The estimator of StiffnessEstimator.fmu, without the FMU, for one joint or many.

    The results equal the results of the FMU, to the last bit. Messages of the FMU are missing, but
    the outputs valid and doubt report the same. `run` logs a warning if range.phi does not fit.
    The estimated curve stays from call to call, until reset(). A copy, by `copy.copy`, is
    independent. Other threads of Python run during a call. An object may be used by one thread at a
    time, and cannot be pickled. Memory: 133 kB a joint.

    >>> import numpy as np, sigmahat
    >>> estimator = sigmahat.Estimator({"method": "FilteredRegression", "motor.gamma": 100})
    >>> found = estimator.run(theta=np.zeros(1000), q=np.zeros(1000), tau=np.zeros(1000))
    >>> found["sigma"].shape, found.units["sigma"]
    ((1000,), 'N.m/rad')
    """

    def __init__(
        self,
        parameters: Mapping[str, Value] | Sequence[Mapping[str, Value]] = {},
        record: Sequence[str] = RECORD,
        warn_of_range: bool = True,
    ) -> None:
        """Starts the estimator.

        The parameters have their names in the FMU, and enumerations take an item name. Missing
        parameters have the start values of the FMU. A sequence has a mapping for each joint. A
        single mapping is for all joints, and the first samples give the number of joints. `record`
        names the outputs that run() and tick() return. `warn_of_range` is False in a program that
        compares range.phi with the motion itself, as `sigmahat check` does.

        Raises ValueError for an unknown name, and for a value that does not fit or is out of its
        range. Raises RuntimeError if the installation has no library for this platform.
        """
        several = not isinstance(parameters, Mapping)
        given = list(parameters) if not isinstance(parameters, Mapping) else [parameters]
        if not given or not all(isinstance(each, Mapping) for each in given):
            raise ValueError(f"expected the parameters of one joint or more, got {parameters!r}")
        if isinstance(record, str):
            raise ValueError(f"record: expected a list of names, got {record!r}")
        self._joints = Joints(given)
        self._shape: tuple[int, ...] | None = (len(given),) if several else None
        self._record = tuple(record)
        for name in self._record:
            self._joints.model.variable(name, "output")
        self.parameters = [self._joints.parameters(joint) for joint in range(len(given))]
        """All present parameters of each joint: given values, else values of the FMU."""
        self._tick: Callable[[Sequence[ArrayLike | None]], dict[str, Any]] | None = None
        self._may_warn = warn_of_range

    def run(
        self,
        theta: ArrayLike,
        q: ArrayLike,
        tau: ArrayLike | None = None,
        theta_c: ArrayLike | None = None,
        tau_e_sensor: ArrayLike | None = None,
    ) -> Series:
        """A tick for each sample, samplePeriod apart; sample k gives output k.

        All arrays have the shape (N,) for one joint, or (joints, N). A sample that is not finite,
        or masked, is skipped: the estimate is kept, and "valid" is False at this sample.

        `theta` and `q` are the positions of motor (at the gear output) and link [rad]. `tau`
        is the torque of the motor on its axis [N.m], for the modality Residual. `theta_c` is
        the position of the motor that adjusts the stiffness [rad]. `tau_e_sensor` is the
        flexibility torque of a sensor [N.m], for the modality Sensor. None stands for 0.

        Returns the recorded outputs, by name, in arrays of the same shape: Booleans as such,
        enumerations as names of items. Also returns the parameters of the first joint. Raises
        ValueError for other shapes or if an array is missing.
        """
        given = dict(zip(INPUTS, (theta, q, theta_c, tau, tau_e_sensor), strict=True))
        self._need(given)
        # For C; masked samples are nan.
        arrays: dict[str, Array] = {
            name: np.asarray(np.ma.filled(np.ma.asarray(each, np.float64), np.nan), order="C")
            for name, each in given.items()
            if each is not None
        }
        shape = arrays["theta"].shape
        if len(shape) not in (1, 2) or any(each.shape != shape for each in arrays.values()):
            shapes = ", ".join(f"{name} {each.shape}" for name, each in arrays.items())
            raise ValueError(f"expected equal shapes, (N,) or (joints, N), got {shapes}")
        self._take_shape(shape[:-1])
        joints, samples = len(self._joints.memory), shape[-1]
        outputs = {name: self._joints.empty(name, joints, samples) for name in self._record}
        rows = [arrays[n].reshape(joints, samples) if n in arrays else None for n in INPUTS]
        self._joints.run(rows, outputs)
        self._compare_with_range(*(arrays[n].reshape(joints, samples) for n in ("theta", "q")))
        named = {name: self._joints.named(name, v).reshape(shape) for name, v in outputs.items()}
        t = float(self.parameters[0]["samplePeriod"]) * np.arange(samples, dtype=np.float64)
        return Series.of(self._joints.model, named, self.parameters[0], t)

    def tick(
        self,
        theta: ArrayLike,
        q: ArrayLike,
        tau: ArrayLike | None = None,
        theta_c: ArrayLike | None = None,
        tau_e_sensor: ArrayLike | None = None,
    ) -> dict[str, Any]:
        """One tick, for a loop; arguments and results as those of run(), without the axis of time.

        Numbers for one joint, arrays of shape (joints,) for many; a number then is for every
        joint. Raises ValueError for another number of joints, or if an input is missing.
        """
        values = (theta, q, theta_c, tau, tau_e_sensor)
        if self._tick is None:
            needed = self._need(dict(zip(INPUTS, values, strict=True)))
            shapes = {np.shape(each) for each in values if each is not None} - {()}
            if len(shapes) > 1 or any(len(shape) > 1 for shape in shapes):
                raise ValueError(f"expected numbers, or arrays of shape (joints,), got {shapes}")
            self._take_shape(shapes.pop() if shapes else self._shape or ())
            self._tick = self._prepared(needed)
        return self._tick(values)

    def evaluate(self, phi: ArrayLike, set_point: ArrayLike | None = None) -> dict[str, Array]:
        """Torque and stiffness at any deformation, (21) and (23), by the present estimate.

        Nothing is learned. `phi` [rad] and `set_point` [1] are numbers or arrays, which are
        broadcast. None stands for the set-point at theta_c = 0.

        Returns "tau_e" and "tau_e_std" [N.m], "sigma" and "sigma_std" [N.m/rad], and
        "sigma_per_gain" [1], the relative change of the stiffness with a relative change of the
        gain of the torque. Each is an array of the shape of the points; of (joints, ...) for many
        joints. Where a number overflows, or a point is not finite, all five are infinite.
        """
        found = []
        for joint, parameters in enumerate(self.parameters):
            at = parameters["setPoint.offset"] if set_point is None else set_point
            both = np.broadcast_arrays(np.asarray(phi, np.float64), np.asarray(at, np.float64))
            points = (np.ascontiguousarray(each).ravel() for each in both)
            found.append(self._joints.evaluated(joint, *points).reshape(-1, *both[0].shape))
        values = np.stack(found, axis=1) if self._shape else found[0]
        return dict(zip(POINT, values, strict=True))

    def covariance(self, phi: ArrayLike, set_point: ArrayLike) -> Covariance | None:
        """The stiffness at points, and motor data and effects, with their covariance.

        phi        deformations [rad] [size: points]
        set_point  one for all points, or one for each [1]

        Returns None for a method that claims no uncertainty, and for a number that overflows.
        Nothing is learned. Raises ValueError for an estimator of several joints.
        """
        if len(self._joints.memory) != 1:
            raise ValueError(f"expected one joint, got {len(self._joints.memory)}")
        both = np.broadcast_arrays(np.asarray(phi, np.float64), np.asarray(set_point, np.float64))
        points = (np.ascontiguousarray(each).ravel() for each in both)
        found = self._joints.covariance(0, *points)
        if found is None or not all(np.all(np.isfinite(each)) for each in found):
            return None
        return Covariance(*found)

    def output(self, name: str) -> Any:
        """The present value of any output: a number, or an array of shape (joints,).

        A Boolean output is a bool, and an enumeration is the name of its item.
        """
        self._joints.model.variable(name, "output")
        values = self._joints.value(name)
        return values if self._shape else values[0].item()

    @property
    def eta(self) -> Array:
        """Coefficients of the torque now, (21) [size: n x m, or joints x n x m]."""
        n = max(int(each["rls.n"]) for each in self.parameters)
        m = max(int(each["rls.m"]) for each in self.parameters)
        values = [[self._joints.value(f"eta[{i},{j}]") for j in range(m)] for i in range(n)]
        eta = np.moveaxis(np.array(values), -1, 0)
        return eta if self._shape else eta[0]

    @property
    def size(self) -> int:
        """Memory of a joint [bytes]."""
        return self._joints.stride

    def tune(self, parameters: Mapping[str, Value]) -> None:
        """Changes tunable parameters of all joints; the estimate stays.

        Raises ValueError, and changes nothing, for a name or value that does not fit, and for a
        parameter that is fixed.
        """
        for name in parameters:
            if self._joints.model.variable(name, "parameter").variability != "tunable":
                raise ValueError(f"{name} cannot be changed: make a new Estimator with it")
        before = self._joints.memory.copy()
        try:
            for joint in range(len(before)):
                self._joints.set(joint, parameters)
        except ValueError:
            self._joints.memory[:] = before
            raise
        now = self._joints.model.parameters(parameters)
        self.parameters = [{**each, **{n: now[n] for n in parameters}} for each in self.parameters]
        self._tick = None

    def reset(self) -> None:
        """Deletes the estimate; parameters do not change."""
        self._joints.start()

    def restart_filters(self) -> None:
        """Samples are missing here, as between two recordings, and the filters have to forget.

        The estimate stays. The missing samples are so many that no filter continues from the last
        sample: one with the method FilteredRegression; with Paper2011 those of the time 2 / K_I,
        after which the integral of the residual is discarded (sigmahat.h), but at most a million.
        """
        for joint, parameters in enumerate(self.parameters):
            theta = np.full((1, _missing(parameters)), np.nan)
            ticks = self._joints.prepared([theta, *[None] * (len(INPUTS) - 1)], {}, joint)
            ticks(0, theta.size)

    def save(self) -> bytes:
        """Parameters and estimates of all joints, for restore() in another process.

        The bytes are valid for the same version of this package on the same kind of platform.
        """
        return self._joints.saved()

    def restore(self, saved: bytes) -> None:
        """Continues from what save() gave: its parameters and estimates replace the present ones.

        The next sample follows the last one before save(); after a break, call restart_filters().
        Raises ValueError, and changes nothing, for bytes that are damaged, of another version of
        the estimator, of another number of joints, or that save() never gives.
        """
        self._joints.restore(saved)
        count = len(self._joints.memory)
        self.parameters = [self._joints.parameters(joint) for joint in range(count)]
        self._tick = None

    def __copy__(self) -> Estimator:
        other = Estimator.__new__(Estimator)
        other.__dict__.update(self.__dict__)
        other._joints, other._tick = self._joints.copied(), None
        return other

    def __deepcopy__(self, _memo: object) -> Estimator:
        return self.__copy__()

    def __reduce__(self) -> str:
        raise TypeError("an Estimator cannot be pickled; make one in each process")

    def _compare_with_range(self, thetas: Array, qs: Array) -> None:
        """Logs a warning, once, if the motion is far from range.phi, by which priors are scaled."""
        for theta, q, every in zip(thetas, qs, self.parameters, strict=True):
            is_long = len(theta) * float(every["samplePeriod"]) > _LONG
            if every["method"] != "FilteredRegression" or not is_long or not self._may_warn:
                continue
            phi = np.abs(q - theta)
            most = float(np.max(phi, initial=0.0, where=np.isfinite(phi)))
            given = float(every["range.phi"])
            if most > _FAR * given or 0 < _WIDE * most < given:
                self._may_warn = False
                logging.getLogger("sigmahat").warning(
                    "the deformation is up to %.3g rad, but range.phi is %.3g rad: set it to about "
                    "the largest deformation, or the stiffness may be wrong", most, given,
                )  # fmt: skip

    def _need(self, given: Mapping[str, ArrayLike | None]) -> set[str]:
        """Returns the inputs that the modalities need. Raises ValueError if one is missing."""
        needed = {str(each["modality"]): _NEEDED[str(each["modality"])] for each in self.parameters}
        for modality, names in needed.items():
            for name in names:
                if given[name] is None:
                    raise ValueError(f"modality {modality} needs {name}, got None")
        return {name for names in needed.values() for name in names}

    def _take_shape(self, shape: tuple[int, ...]) -> None:
        """Checks the shape of samples without time; the first shape gives the number of joints."""
        if 0 in shape:
            raise ValueError("expected samples of one joint or more, got none")
        if self._shape is None:
            if shape:
                self._joints.repeated(*shape)
                self.parameters = self.parameters * shape[0]
            self._shape = shape
        if self._shape != shape:
            raise ValueError(
                f"expected samples of {self._shape[0] if self._shape else 'one'} joint(s), got "
                f"{shape[0] if shape else 'one'}"
            )

    def _prepared(
        self, needed: Container[str]
    ) -> Callable[[Sequence[ArrayLike | None]], dict[str, Any]]:
        """A tick that allocates nothing, for many calls."""
        joints = self._joints
        count, single = len(joints.memory), not self._shape
        inputs = np.zeros((len(INPUTS), count, 1))
        outputs = {name: joints.empty(name, count, 1) for name in self._record}
        run = joints.prepared(list(inputs), outputs)
        places = [(name, each, joints.names(name)) for name, each in outputs.items()]
        must_be_given = [name in needed for name in INPUTS]

        def tick(values: Sequence[ArrayLike | None]) -> dict[str, Any]:
            for row, value, must in zip(inputs, values, must_be_given, strict=True):
                try:
                    if must and value is None:
                        raise TypeError
                    row[:, 0] = 0.0 if value is None else value
                except (ValueError, TypeError) as error:
                    expected = "a number" if single else f"a number or shape ({count},)"
                    raise ValueError(f"expected {expected}, got {value!r}") from error
            run(0, 1)
            if single:
                return {
                    name: each.item() if named is None else named[each.item()]
                    for name, each, named in places
                }
            return {
                name: each[:, 0].copy() if named is None else joints.named(name, each[:, 0])
                for name, each, named in places
            }

        return tick
