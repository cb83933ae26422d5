"""The scenarios of section VI: the AwAS, simulated and as the device of the experiment."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import replace

from sigmahat.fmi.instance import Value
from sigmahat.fmi.master import EstimatorFmu, Plant
from sigmahat.runs.scenario import Comparison, Scenario, Sine, T

OUTPUTS = (
    "sigma",
    "tau_e",
    "tau_e_residual",
    "theta_dot",
    "phi",
    "setPoint",
    "a",
    "rho",
    "epsilon",
    "valid",
)
"""Outputs of StiffnessEstimator."""


def against_the_plant(estimators: Iterable[str]) -> list[Comparison]:
    """Each estimator compared with the true stiffness of the plant."""
    return [Comparison(name, f"{name}.sigma", "plant.sigma") for name in estimators]


SECTION_VI_B = Sine(0.3, 0.1)
"""Torque of the principal motor in section VI.B [N.m, Hz]."""
R_0 = 0.1
"""Lever arm without retraction, (30) [m]."""
_B = 0.0025 / (2 * math.pi)  # b of (30) [m/rad]

_AWAS_OUTPUTS = (
    "q_measured",
    "theta_measured",
    "theta_c_measured",
    "tau_measured",
    "tau_e_measured",
    "theta_dot",
    "phi",
    "r",
    "tau_e",
    "sigma",
)


def awas(retraction: float, tau: Sine = SECTION_VI_B) -> Plant:
    """The AwAS with the torques of section VI.B, or with another torque of the principal motor.

    At first, the lever arm is shortened by retraction [m].
    """
    return Plant(
        fmu="AwasPlant",
        start={"initial.theta_c": retraction / _B},
        inputs={"tau": tau, "tau_c": Sine(8.0, 0.1)},
        record=_AWAS_OUTPUTS,
    )


def lever_arm(plant: Plant) -> float:
    """r(0) of an AwAS, (30) [m]."""
    return R_0 - _B * float(plant.start["initial.theta_c"])


def estimator(start: Mapping[str, Value], sensor: str = "tau_e_measured") -> EstimatorFmu:
    """The estimator of the AwAS, with the given start values, else the values of the FMU."""
    return EstimatorFmu(
        fmu="StiffnessEstimator",
        start={"samplePeriod": T, **start},
        connections={
            "theta": "theta_measured",
            "q": "q_measured",
            "theta_c": "theta_c_measured",
            "tau": "tau_measured",
            "tau_e_sensor": sensor,
        },
        record=OUTPUTS,
    )


def _modalities(start: Mapping[str, Value]) -> dict[str, EstimatorFmu]:
    """The three modalities of section VI.B, and the modality Model of the FMU.

    The MODEL of the paper is fed with (28) at the actual deformation (its footnote 1), like a
    sensor without noise. The modality Model of the FMU has only the measured positions.
    """
    return {
        "MODEL": estimator({"modality": "Sensor", **start}, sensor="tau_e"),
        "SENSOR": estimator({"modality": "Sensor", **start}),
        "RESIDUAL": estimator({"modality": "Residual", **start}),
        "MODEL-measured": estimator({"modality": "Model", **start}),
    }


def _constant_factors(start: Mapping[str, Value]) -> dict[str, EstimatorFmu]:
    """RESIDUAL with constant stability factors, one too small and one too large, for figure 8."""
    return {
        f"RESIDUAL, a = {a:g}": estimator(
            {"modality": "Residual", "rls.kind": "ConstantFactor", "rls.a": a, **start}
        )
        for a in (1e-4, 1e-2)
    }


def simulation(
    name: str, description: str, duration: float, retraction: float, start: Mapping[str, Value]
) -> Scenario:
    """Section VI.B."""
    estimators = _modalities(start)
    return Scenario(
        name=name,
        description=description,
        duration=duration,
        plant=awas(retraction),
        estimators=estimators,
        comparisons=against_the_plant(estimators),
        figures=(
            "fig3-deformation",
            "fig4-velocity",
            "fig5-flexibility-torque",
            "fig6-stiffness",
            "fig7-stability-factor",
            "fig8-constant-factors",
            "summary",
        ),
        variants=_constant_factors(start),
        paper={"MODEL": (24.1365, 0.12), "SENSOR": (24.3630, 0.12), "RESIDUAL": (128.1614, 0.58)},
    )


def experiment() -> Scenario:
    """Section VI.C: the plant differs from the nominal data as a real device does."""
    plant = Plant(
        fmu="AwasPlant",
        start={
            "spring.k_s": 0.85 * 14220,
            "spring.r_0": 0.102,
            "link.D_q": 1.5 * 0.15,
            "link.tau_coulomb": 0.05,
            "sensor.gain": 1.03,
            "initial.theta_c": 0.0,
            # The link swings between two turning points at equal distances from 0.
            "initial.q": -1.75,
            "initial.theta": -1.75,
        },
        inputs={"tau": Sine(0.3, 0.5), "tau_c": Sine(8.0, 0.05)},
        record=(*_AWAS_OUTPUTS, "theta_c"),
    )
    against_sensor = Comparison("RESIDUAL against SENSOR", "RESIDUAL.sigma", "SENSOR.sigma")
    return Scenario(
        name="experiment",
        description="AwAS that is not as its data say, for 60 s: the experiment of section VI.C",
        duration=60.0,
        plant=plant,
        estimators={
            "MODEL": estimator({"modality": "Model"}),
            "SENSOR": estimator({"modality": "Sensor"}),
            "RESIDUAL": estimator({"modality": "Residual"}),
        },
        comparisons=[
            Comparison("MODEL against nominal", "MODEL.sigma", "nominal.sigma"),
            against_sensor,
            # SENSOR is 0 until the joint deforms, and a reference of 0 gives no relative error.
            replace(
                against_sensor,
                name=f"{against_sensor.name}, relative to true",
                relative_to="plant.sigma",
            ),
            Comparison("MODEL against true", "MODEL.sigma", "plant.sigma"),
            Comparison("SENSOR against true", "SENSOR.sigma", "plant.sigma"),
            Comparison("RESIDUAL against true", "RESIDUAL.sigma", "plant.sigma"),
        ],
        figures=(
            "fig9-deformation",
            "fig10-lever-arm",
            "fig11-flexibility-torque",
            "fig12-stiffness",
            "experiment",
        ),
        paper={"MODEL against nominal": (9.36, 0.034), "RESIDUAL against SENSOR": (63.02, 1.55)},
        tables=(
            ("mse_settled", "msrep_settled", "error_settled"),
            ("mse", "msrep", "error"),
        ),
    )
