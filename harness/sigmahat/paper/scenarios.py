"""All scenarios of `sigmahat reproduce`: the AwAS, single transmissions, an antagonistic pair."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import replace

from sigmahat.experiments.scenario import Comparison, Scenario, Sine, Sines, T
from sigmahat.fmi.master import EstimatorFmu, Plant
from sigmahat.fmi.model import Value
from sigmahat.fmi.unknown_name import unknown

OUTPUTS = (
    "sigma", "tau_e", "tau_e_residual", "theta_dot", "phi", "setPoint", "a", "rho", "epsilon",
    "valid",
)  # fmt: skip
"""Outputs of StiffnessEstimator."""


def against_the_plant(estimators: Iterable[str]) -> list[Comparison]:
    """Creates comparisons of each estimator with the true stiffness of the plant."""
    return [Comparison(name, f"{name}.sigma", "plant.sigma") for name in estimators]


SECTION_VI_B = Sine(0.3, 0.1)  # torque of the principal motor in section VI.B [N.m, Hz]
R_0 = 0.1  # lever arm without retraction, (30) [m]
_B = 0.0025 / (2 * math.pi)  # b of (30) [m/rad]

_AWAS_OUTPUTS = (
    "q_measured", "theta_measured", "theta_c_measured", "tau_measured", "tau_e_measured",
    "theta_dot", "phi", "r", "tau_e", "sigma",
)  # fmt: skip
_FIGURES_3_TO_8 = (
    "fig3-deformation", "fig4-velocity", "fig5-flexibility-torque", "fig6-stiffness",
    "fig7-stability-factor", "fig8-constant-factors", "summary",
)  # fmt: skip
_FIGURES_9_TO_12 = (
    "fig9-deformation", "fig10-lever-arm", "fig11-flexibility-torque", "fig12-stiffness",
    "experiment",
)  # fmt: skip


def awas(retraction: float, tau: Sine = SECTION_VI_B) -> Plant:
    """Creates the AwAS plant with torques of section VI.B, or another principal motor torque.

    At first, the lever arm is shortened by retraction [m].
    """
    return Plant(
        fmu="AwasPlant",
        start={"initial.theta_c": retraction / _B},
        inputs={"tau": tau, "tau_c": Sine(8.0, 0.1)},
        record=_AWAS_OUTPUTS,
    )


def lever_arm(plant: Plant) -> float:
    """Computes the lever arm r(0) of an AwAS, (30) [m]."""
    return R_0 - _B * float(plant.start["initial.theta_c"])


_ONE_MOTOR, _TWO_MOTORS = (
    {name: f"{name}_measured" for name in names}
    for names in (("theta", "q", "tau"), ("theta", "q", "theta_c", "tau"))
)
_AWAS = {**_TWO_MOTORS, "tau_e_sensor": "tau_e_measured"}
"""Outputs of a plant, by the estimator input to which each output is connected."""


def estimator(start: Mapping[str, Value], connections: Mapping[str, str] = _AWAS) -> EstimatorFmu:
    """Creates an estimator with the given start values; others are values of the FMU."""
    start = {"samplePeriod": T, **start}
    return EstimatorFmu("StiffnessEstimator", start, connections, record=OUTPUTS)


def simulation(
    name: str, description: str, duration: float, retraction: float, start: Mapping[str, Value]
) -> Scenario:
    """Creates the scenario of section VI.B of the paper."""
    # The MODEL of the paper is fed with (28) at the actual deformation (its footnote 1), like a
    # sensor without noise. The modality Model of the FMU has only the measured positions.
    estimators = {
        "MODEL": estimator({"modality": "Sensor", **start}, {**_AWAS, "tau_e_sensor": "tau_e"}),
        "SENSOR": estimator({"modality": "Sensor", **start}),
        "RESIDUAL": estimator({"modality": "Residual", **start}),
        "MODEL-measured": estimator({"modality": "Model", **start}),
    }
    constant = {"modality": "Residual", "rls.kind": "ConstantFactor", **start}
    return Scenario(
        name=name,
        description=description,
        duration=duration,
        plant=awas(retraction),
        estimators=estimators,
        comparisons=against_the_plant(estimators),
        figures=_FIGURES_3_TO_8,
        # Constant stability factors, one too small and one too large, for figure 8.
        variants={
            f"RESIDUAL, a = {a:g}": estimator({**constant, "rls.a": a}) for a in (1e-4, 1e-2)
        },
        paper={"MODEL": (24.1365, 0.12), "SENSOR": (24.3630, 0.12), "RESIDUAL": (128.1614, 0.58)},
    )


def experiment() -> Scenario:
    """Creates the scenario of section VI.C: the plant differs from the nominal data."""
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
    names = ("MODEL", "SENSOR", "RESIDUAL")
    against_sensor = Comparison("RESIDUAL against SENSOR", "RESIDUAL.sigma", "SENSOR.sigma")
    return Scenario(
        name="experiment",
        description="AwAS that is not as its data say, for 60 s: the experiment of section VI.C",
        duration=60.0,
        plant=plant,
        estimators={name: estimator({"modality": name.capitalize()}) for name in names},
        comparisons=[
            Comparison("MODEL against nominal", "MODEL.sigma", "nominal.sigma"),
            against_sensor,
            # SENSOR is 0 until the joint deforms, and a reference of 0 gives no relative error.
            replace(
                against_sensor,
                name=f"{against_sensor.name}, relative to true",
                relative_to="plant.sigma",
            ),
            *(replace(each, name=f"{each.name} against true") for each in against_the_plant(names)),
        ],
        figures=_FIGURES_9_TO_12,
        paper={"MODEL against nominal": (9.36, 0.034), "RESIDUAL against SENSOR": (63.02, 1.55)},
        tables=(("mse_settled", "msrep_settled", "error_settled"), ("mse", "msrep", "error")),
    )


def single(k_3: float, frequency: float) -> Scenario:
    """Section III: one flexible transmission, linear or hardening [N.m/rad3]."""
    spring = "hardening" if k_3 else "linear"
    name = f"single-{spring}" + ("" if frequency == 0.5 else f"-{frequency:g}hz")
    # The regressors are powers of phi, about 0.01 rad; for the AwAS they go up to r^2 phi, about
    # 100 mm2 rad. So the paper's ridge 1/(c P_0) = 1 suits the AwAS, but is far too strong here.
    start: dict[str, Value] = {"modality": "Residual", "rls.m": 1}
    estimators = {
        "RESIDUAL": estimator({**start, "rls.P_0": 1e24}, _ONE_MOTOR),
        "RESIDUAL-paper-prior": estimator(start, _ONE_MOTOR),
    }
    return Scenario(
        name=name,
        description=f"one flexible transmission, {spring} spring, {frequency:g} Hz for 15 s",
        duration=15.0,
        plant=Plant(
            fmu="FlexibleJointPlant",
            start={"spring.k_1": 150.0, "spring.k_3": k_3},
            inputs={"tau": Sine(0.3, frequency)},
            record=[name for name in _AWAS_OUTPUTS if name not in ("theta_c_measured", "r")],
        ),
        estimators=estimators,
        comparisons=against_the_plant(estimators),
        figures=("transmission",),
    )


def antagonistic() -> Scenario:
    """Sections II and III: two motors, each with a spring, pull at one link."""
    sides = (1, 2)
    pull = Sine(0.025, 0.1)  # co-contraction, added to its mean of 0.04 N.m
    move = Sine(0.012, 0.25)  # of the link
    own = ("theta_measured", "tau_measured", "tau_e_measured", "phi", "tau_e", "sigma")
    return Scenario(
        name="antagonistic",
        description="two antagonistic transmissions, slow co-contraction under a moving link, 30 s",
        duration=30.0,
        plant=Plant(
            fmu="AntagonisticVsaPlant",
            # At rest, with the transmissions stretched by the mean co-contraction.
            start={"initial.theta_1": -0.81543848, "initial.theta_2": 0.91108241},
            inputs={
                "tau_1": Sines(-0.04, (Sine(-pull.amplitude, pull.frequency), move)),
                "tau_2": Sines(+0.04, (pull, move)),
            },
            record=(
                "q",
                "q_measured",
                *(f"{output}_{i}" for i in sides for output in own),
                "sigma",
            ),
        ),
        estimators={
            "RESIDUAL": EstimatorFmu(
                fmu="AntagonisticStiffnessEstimator",
                start={"samplePeriod": T, "modality": "Residual", "rls.P_0": 1e24, "rls.m": 1},
                connections={
                    "q": "q_measured",
                    **{f"theta_{i}": f"theta_measured_{i}" for i in sides},
                    **{f"tau_{i}": f"tau_measured_{i}" for i in sides},
                },
                record=("sigma", *(f"{output}_{i}" for i in sides for output in OUTPUTS)),
            )
        },
        comparisons=[
            Comparison("device", "RESIDUAL.sigma", "plant.sigma"),
            *(Comparison(f"side {i}", f"RESIDUAL.sigma_{i}", f"plant.sigma_{i}") for i in sides),
        ],
        figures=("antagonistic",),
        settled=10.0,
    )


SCENARIOS = {
    s.name: s
    for s in (
        simulation(
            "table1",
            "AwAS from r(0) = 70 mm for 15 s: the conditions that give Table I",
            duration=15.0,
            retraction=0.030,
            start={},
        ),
        simulation(
            "as-printed",
            "AwAS from r(0) = 130 mm for 20 s, velocity weighting as printed in (11)",
            duration=20.0,
            retraction=-0.030,
            start={"filter.weighting": "AsPrinted"},
        ),
        experiment(),
        *(single(k_3, frequency) for frequency in (0.5, 2.0, 4.0) for k_3 in (0.0, 3000.0)),
        antagonistic(),
    )
}
"""All scenarios of `sigmahat reproduce`, by name."""


def scenario(name: str) -> Scenario:
    """Returns the scenario of that name. Raises ValueError for an unknown name."""
    if name not in SCENARIOS:
        raise ValueError(unknown("scenario", name, SCENARIOS))
    return SCENARIOS[name]
