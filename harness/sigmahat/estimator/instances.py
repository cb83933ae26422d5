"""Estimators in memory that Python owns: harness/native/joints.h by ctypes."""

from __future__ import annotations

import ctypes
from collections.abc import Callable, Mapping, Sequence
from copy import copy
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sigmahat.fmi import native
from sigmahat.fmi.model import Value, installed_model

INPUTS = ("theta", "q", "theta_c", "tau", "tau_e_sensor")  # inputs in the order of the library

_CACHE_LINE = 64  # [bytes]
_POINT = 5  # members of sh_point
QUANTITIES = ("B", "D_theta", "tau_coulomb", "load_friction", "hysteresis", "lost_torque")
"""Quantities of sh_estimator_covariance behind the stiffness, in the order of the library."""
_PIECE = 1 << 16  # ticks between two moments at which Ctrl-C can end the run
_GROUP = 64  # joints at a time: 1024 ticks of each, so that its state stays in the cache


class _Violation(ctypes.Structure):
    """sh_violation."""

    _fields_ = (("name", ctypes.c_char_p), ("value", ctypes.c_double), ("range", ctypes.c_char_p))


class Output(ctypes.Structure):
    """sh_joint_output: number of a variable, address of its values."""

    _fields_ = (("variable", ctypes.c_uint), ("values", ctypes.c_void_p))


def start_values(samplePeriod: float) -> dict[str, Value]:
    """Returns all parameters of an estimator of which only samplePeriod [s] is set.

    Start values that depend on it follow it. The period may be out of its range.
    """
    joint = Joints([{}])
    joint.set_start_values(0, samplePeriod)
    return joint.parameters(0)


class Joints:
    """One estimator per joint, in the order of the parameters."""

    def __init__(self, parameters: Sequence[Mapping[str, Value]]) -> None:
        """Starts the estimators. Raises ValueError for a name or value that does not fit,
        RuntimeError if this installation has no library.
        """
        self.model = installed_model("StiffnessEstimator")
        self._library = _library(self.model.description.guid)
        size = int(self._library.sh_joint_size())
        self.stride = -(-size // _CACHE_LINE) * _CACHE_LINE
        self.memory = np.zeros((len(parameters), self.stride), np.uint8)
        for joint, each in enumerate(parameters):
            period = each.get("samplePeriod", float(self.model.variable("samplePeriod").start))
            self.set_start_values(joint, self.model.number("samplePeriod", period))
            self.set(joint, each)
        self.start()

    def repeated(self, joints: int) -> None:
        """Copies a single estimator to this number of joints."""
        self.memory = np.repeat(self.memory, joints, axis=0)

    def start(self) -> None:
        """Forgets all that was learned."""
        for joint in range(len(self.memory)):
            self._library.sh_joint_start(self._address(joint))

    def set_start_values(self, joint: int, samplePeriod: float) -> None:
        """Sets all variables of a joint to their start values for samplePeriod [s]."""
        self._library.sh_joint_default(self._address(joint), samplePeriod)

    def set(self, joint: int, parameters: Mapping[str, Value]) -> None:
        """Sets parameters of a joint: all, or none if one of them does not fit (ValueError)."""
        changed = self.memory[joint].copy()
        for name, value in parameters.items():
            variable = self.model.variable(name, "parameter")
            number = self.model.number(name, value)
            self._library.sh_joint_set(changed.ctypes.data, variable.valueReference, number)
        violation = _Violation()
        if self._library.sh_joint_check(changed.ctypes.data, ctypes.byref(violation)):
            name, expected = violation.name.decode(), violation.range.decode()
            raise ValueError(f"{name}: expected {expected}, got {violation.value:.9g}")
        self.memory[joint] = changed

    def evaluated(
        self, joint: int, phi: NDArray[np.float64], set_point: NDArray[np.float64]
    ) -> NDArray[np.float64]:
        """The members of sh_point at each point [size: 5 x points]."""
        points: NDArray[np.float64] = np.empty((phi.size, _POINT))
        arrays = (phi.ctypes.data, set_point.ctypes.data, points.ctypes.data)
        self._library.sh_joint_evaluate(self._address(joint), phi.size, *arrays)
        return np.transpose(points)

    def covariance(
        self, joint: int, phi: NDArray[np.float64], set_point: NDArray[np.float64]
    ) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]] | None:
        """Stiffness at each point and QUANTITIES: values, change per gain, and covariance, as in
        sh_estimator_covariance; None for a method without them."""
        size = phi.size + len(QUANTITIES)
        values, per_gain, covariance = np.empty(size), np.empty(size), np.empty((size, size))
        arrays = (each.ctypes.data for each in (phi, set_point, values, per_gain, covariance))
        if self._library.sh_joint_covariance(self._address(joint), phi.size, *arrays):
            return None
        return values, per_gain, covariance

    def copied(self) -> Joints:
        other = copy(self)
        other.memory = self.memory.copy()
        return other

    def saved(self) -> bytes:
        """Parameters, estimates and outputs of all joints as bytes."""
        joints = len(self.memory)
        saved = ctypes.create_string_buffer(self._library.sh_joints_saved_size(joints))
        self._library.sh_joints_save(self._address(0), joints, self.stride, saved)
        return saved.raw

    def restore(self, saved: bytes) -> None:
        """Takes what saved() gave. Raises ValueError, and changes nothing, for other bytes."""
        of_joints = (self._address(0), len(self.memory), self.stride)
        defect = self._library.sh_joints_restore(*of_joints, saved, len(saved))
        if defect is not None:
            raise ValueError(f"the state ({len(saved)} bytes) {defect.decode()}")

    def parameters(self, joint: int) -> dict[str, Value]:
        """All parameters of a joint now."""
        variables = self.model.variables.items()
        names = [name for name, v in variables if v.causality == "parameter"]
        return self.model.parameters({name: self.value(name)[joint].item() for name in names})

    def value(self, name: str) -> NDArray[Any]:
        """The value of a variable now, [size: joints]."""
        dtype = self._dtype(name)
        first = int(self._library.sh_joint_place(self.model.variable(name).valueReference))
        place = self.memory[:, first : first + np.dtype(dtype).itemsize]
        values = np.ascontiguousarray(place).view(dtype)[:, 0]
        return self.named(name, values)

    def named(self, name: str, values: NDArray[Any]) -> NDArray[Any]:
        """Values of the library as values of Python: an enumeration as the names of its items."""
        kind = self.model.variable(name).type
        if kind == "Enumeration":
            return self.model.item_names(name, values)
        return values.astype(bool) if kind == "Boolean" else values

    def names(self, name: str) -> Mapping[int, Any] | None:
        """Values of Python by the numbers of a Boolean or an Enumeration; None for a Real."""
        kind = self.model.variable(name).type
        if kind == "Boolean":
            return {0: False, 1: True}
        return self.model.items(name) if kind == "Enumeration" else None

    def run(
        self, inputs: Sequence[NDArray[np.float64] | None], outputs: Mapping[str, NDArray[Any]]
    ) -> None:
        """A tick for each sample of each joint.

        inputs   INPUTS [size: joints x samples], C-contiguous; None: all 0
        outputs  arrays of empty() by name, of the same size, that are filled
        """
        joints, samples = next(each.shape for each in inputs if each is not None)
        for joint in range(0, joints, _GROUP):
            of_group = slice(joint, joint + _GROUP)
            call = self.prepared(
                [None if each is None else each[of_group] for each in inputs],
                {name: each[of_group] for name, each in outputs.items()},
                joint,
            )
            piece = _PIECE // min(_GROUP, joints)
            for first in range(0, samples, piece):
                call(first, min(first + piece, samples))

    def prepared(
        self,
        inputs: Sequence[NDArray[np.float64] | None],
        outputs: Mapping[str, NDArray[Any]],
        joint: int = 0,
    ) -> Callable[[int, int], None]:
        """A function that runs the ticks of samples first to end - 1.

        The arrays, as for run(), have one row for each joint from `joint` on. The arrays must
        exist as long as the function is called.
        """
        joints, samples = next(each.shape for each in inputs if each is not None)
        each_output = ((self.model.variable(n).valueReference, v) for n, v in outputs.items())
        places = (Output * len(outputs))(*(Output(n, v.ctypes.data) for n, v in each_output))
        of_joints = (self._address(joint), joints, self.stride, samples)
        arrays = (*(None if each is None else each.ctypes.data for each in inputs), places)
        run, count = self._library.sh_joints_run, len(places)

        def call(first: int, end: int) -> None:
            run(*of_joints, first, end, *arrays, count)

        return call

    def empty(self, name: str, joints: int, samples: int) -> NDArray[Any]:
        return np.empty((joints, samples), self._dtype(name))

    def _dtype(self, name: str) -> type[np.float64] | type[np.int32]:
        return np.float64 if self.model.variable(name).type == "Real" else np.int32

    def _address(self, joint: int) -> int:
        return int(self.memory.ctypes.data) + joint * self.stride


def _library(guid: str) -> ctypes.CDLL:
    library = native.library()
    if library.sh_joint_guid().decode() != guid:
        raise RuntimeError("StiffnessEstimator.fmu and library are of two builds; build both again")
    return library
