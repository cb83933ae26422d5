"""The parameters of the estimator, from the configuration of a log."""

import math

from sigmahat.estimator.instances import start_values
from sigmahat.fmi.model import Value, installed_model
from sigmahat.recording.configuration import Configuration
from sigmahat.recording.log import LogError
from sigmahat.recording.units import counts_of_joint


def parameters(configuration: Configuration) -> dict[str, Value]:
    """Computes the parameters that differ from the start values of StiffnessEstimator.fmu.

    They are the configured parameters, the counts of the encoders, and start values that follow
    samplePeriod: filters are not faster than the samples. The steps of a measured deformation are
    those of the position that follows from it. If motor.gamma is 0 or missing, the gear ratio of
    theta is used.

    encoder.theta_c has no effect, but is set because the interface of the FMU contains it.

    Raises LogError for a name that the estimator does not have, or a value of another type.
    """
    model = installed_model("StiffnessEstimator")
    start = dict(configuration.parameters)
    for name, port in configuration.inputs.items():
        counts = counts_of_joint(name, port) if port.value is None else 0.0  # not rounded
        if counts is not None and f"encoder.{name}" in model.variables:
            start.setdefault(f"encoder.{name}", counts)
    theta = configuration.ports.get("theta")
    if theta is not None and theta.gear_ratio != 1 and not start.get("motor.gamma"):
        start["motor.gamma"] = abs(theta.gear_ratio)
    try:
        for name, value in start.items():
            model.variable(name, "parameter")
            model.number(name, value)
            if isinstance(value, float) and not math.isfinite(value):
                raise ValueError(f"parameters.{name}: expected a finite number, got {value}")
        if start.get("motor.gamma") == 0:
            raise ValueError("parameters.motor.gamma is 0; fill in the gear ratio of your joint")
        unset = model.parameters({})
        T = float(start.get("samplePeriod", unset["samplePeriod"]))
        if T == 0:
            raise ValueError("parameters.samplePeriod is 0; fill in the time between two rows [s]")
        follow = {name: v for name, v in start_values(T).items() if v != unset[name]}
        return {**follow, **start}
    except (ValueError, TypeError) as error:
        raise LogError(f"{configuration.path}: {error}") from error


def all_parameters(configuration: Configuration) -> dict[str, Value]:
    """Returns all parameters of the estimator, also parameters without a configured value."""
    return installed_model("StiffnessEstimator").parameters(parameters(configuration))
