"""Start values of the estimator FMU, with the curve that another estimator has learned."""

from collections.abc import Mapping

from sigmahat.fmi.instance import Slave, Value
from sigmahat.fmi.sample_loop import Recorder

_CURVE = "rls.eta_0["
_NOT_IN_A_RUN = (
    *("B", "load_friction", "eccentric", "eccentric_motor", "delay", "reversal", "power", "gap"),
    "hysteresis",
)
"""Priors of effects that do not differ from run to run."""
_NONE = 1e-6  # uncertainty of a curve: so small that the curve does not change
_LARGEST = 1e12  # largest prior that the FMU accepts


def start_values(slave: Slave, every: Mapping[str, Value]) -> dict[str, Value]:
    """Start values of an FMU with the present curve and motor data of a slave.

    The polynomial has all powers of the curve: FilteredRegression may use higher powers than rls.n
    and rls.m have. Priors do not change: the new FMU takes the curve as the mean of its prior, but
    the uncertainty of the curve is lost.

    every  parameters of the slave
    """
    eta = [name for name in slave.fmu.variables if name.startswith("eta[")]
    outputs = Recorder(slave, [*eta, "B_hat", "D_theta_hat"], 1)
    outputs.sample(0)
    found = {name: float(column[0]) for name, column in outputs.columns().items()}
    at = {name: tuple(map(int, name[4:-1].split(","))) for name in eta}
    used = [at[name] for name in eta if found[name]]
    n = max([int(every["rls.n"]), *(i + 1 for i, _ in used)])
    m = max([int(every["rls.m"]), *(j + 1 for _, j in used)])
    start = {name: value for name, value in every.items() if not name.startswith(_CURVE)}
    start |= {"rls.n": n, "rls.m": m}
    for name, value in (("motor.B", found["B_hat"]), ("motor.D_theta", found["D_theta_hat"])):
        if value > 0:  # the FMU refuses other values, and `doubt` reports such values
            start[name] = value
    for name, (i, j) in at.items():
        if i < n and j < m:
            start[f"{_CURVE}{i},{j}]"] = found[name]
    kinds = {name: slave.fmu.variable(name).type for name in start}
    return {n: bool(v) if kinds[n] == "Boolean" else v for n, v in start.items()}


def as_fixed_curve(start: Mapping[str, Value]) -> dict[str, Value]:
    """Start values with which the curve and the inertia do not change.

    A fit to all samples estimates only effects that differ from run to run. These are bias of the
    torque or zero of the deformation, friction, and the time between the encoders (as a damping).
    Other effects would hide a wrong stiffness: in a motion of one frequency, for example,
    a delay of the torque looks like a wrong stiffness.

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
