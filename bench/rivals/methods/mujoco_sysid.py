"""The system identification toolbox of MuJoCo, `mujoco.sysid`, for a spring without a motor.

Part of the package mujoco (extra `sysid`), as documented there: nonlinear least squares of
simulated against measured sensors, parameters within bounds, intervals from the Jacobian and the
residual (`calculate_intervals`). As in its examples a model is written and its parameters are
fitted: a hinge with armature, damping, frictionloss and an offset, which the measured motor torque
drives, and which a position actuator, whose gain is the stiffness, pulls to the measured link
position. The only sensor is the motor position, and the whole log is one sequence. So nothing is
assumed of the load, as with the other methods. Bounds are from the data sheet: three standard
deviations. The fit ends after 30 steps at the latest: what comes later is slow, because the motor
sticks or slips, which its numeric derivatives do not see. The gain of an actuator is constant:
hardening is not in the model, and the method is not applicable where a motor changes the
stiffness.
"""

from __future__ import annotations

import contextlib
import io
import time
from typing import Any

import numpy as np

from rivals.answer import answer, no_answer
from rivals.records import Estimate, JointLog, Known

_XML = """
<mujoco>
  <option timestep="{T!r}" integrator="implicitfast" gravity="0 0 0">
    <flag contact="disable"/>
  </option>
  <worldbody>
    <body name="rotor">
      <inertial pos="0 0 0" mass="1e-6" diaginertia="1e-9 1e-9 1e-9"/>
      <joint name="motor" type="hinge" axis="0 0 1"/>
    </body>
  </worldbody>
  <actuator>
    <motor name="torque" joint="motor"/>
    <position name="spring" joint="motor" kp="1"/>
    <motor name="offset" joint="motor"/>
  </actuator>
  <sensor><jointpos name="theta" joint="motor"/></sensor>
</mujoco>
"""
RANGE = 10.0
"""The stiffness is sought from its scale over this to its scale times this; the scale is the
largest torque over the largest deformation."""
STEPS = 30
_SPEED = 0.05  # [s] in which the velocity at the start is measured


def estimate(log: JointLog) -> Estimate:
    """The estimate of the whole log, the same at every sample."""
    begin = time.perf_counter()
    if log.theta_c.any():
        return no_answer(log, 0.0, "its models have no stiffness that a motor changes")
    import mujoco
    from mujoco import sysid

    T, g = log.sample_period, log.known.gamma
    spec = mujoco.MjSpec.from_string(_XML.format(T=T))
    model = spec.compile()
    first = min(round(_SPEED / T), len(log.theta) - 1)
    velocity = (log.theta[first] - log.theta[0]) / (first * T)
    initial = sysid.create_initial_state(model, log.theta[:1], np.array([velocity]))
    times = T * np.arange(len(log.theta))
    # A control is held for a step: its mean over the step.
    control = np.column_stack([g * log.tau, log.q, np.ones(len(times))])
    control[:-1] = (control[:-1] + control[1:]) / 2
    sequence = sysid.ModelSequences(
        "joint",
        spec,
        "log",
        initial,
        sysid.TimeSeries(times, control),
        sysid.TimeSeries.from_names(times, log.theta[:, None], model),
    )
    residual = sysid.build_residual_fn(
        models_sequences=[sequence], resample_true=False, n_threads=1
    )
    with contextlib.redirect_stdout(io.StringIO()):  # each iteration is printed
        fitted, result = sysid.optimize(
            _parameters(log.known),
            residual,
            optimizer="mujoco",
            verbose=False,
            x_scale="jac",
            max_iters=STEPS,
        )
    residuals, _, _ = residual(result.x, fitted)
    _, half = sysid.calculate_intervals(residuals, result.jac)
    every = np.ones(len(times))
    stiffness = float(fitted["stiffness"].value[0])
    std = float(half[0]) / 1.96
    return answer(log, stiffness * every, std * every, time.perf_counter() - begin)


def _parameters(known: Known) -> Any:
    """Parameters of the model, the stiffness first."""
    from mujoco import sysid

    g = abs(known.gamma)
    scale = known.range_tau_e / known.range_phi
    friction = g * known.tau_coulomb
    every = sysid.ParameterDict()

    def add(name: str, nominal: float, low: float, high: float, modifier: Any) -> None:
        every.add(sysid.Parameter(name, nominal, low, high, modifier=modifier))

    def relative(name: str, value: float, std: float) -> None:
        low, high = max(1 - 3 * std, 0.01) * value, (1 + 3 * std) * value
        add(name, value, low, high, lambda s, p: _set_joint(s, name, p))

    add("stiffness", scale, scale / RANGE, scale * RANGE, _set_stiffness)
    relative("armature", g**2 * known.B, known.relative_std_B)
    relative("damping", g**2 * known.D_theta, known.relative_std_D_theta)
    add("frictionloss", friction, 0.0, 3 * friction, lambda s, p: _set_joint(s, "frictionloss", p))
    add("offset", 0.0, -3 * friction, 3 * friction, _set_offset)
    return every


def _set_joint(spec: Any, name: str, parameter: Any) -> None:
    """Sets an attribute of the joint; damping is a polynomial in newer versions."""
    value = float(parameter.value[0])
    old = getattr(spec.joint("motor"), name)
    if isinstance(old, np.ndarray):
        old[:] = 0.0
        old[0] = value
    else:
        setattr(spec.joint("motor"), name, value)


def _set_stiffness(spec: Any, parameter: Any) -> None:
    from mujoco import sysid

    sysid.apply_pgain(spec, "spring", float(parameter.value[0]))


def _set_offset(spec: Any, parameter: Any) -> None:
    spec.actuator("offset").gainprm[0] = -float(parameter.value[0])
