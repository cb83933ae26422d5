"""All scenarios of `sigmahat reproduce`, by name."""

from __future__ import annotations

from sigmahat.fmi.instance import Value
from sigmahat.fmi.master import EstimatorFmu, Plant
from sigmahat.fmi.unknown_name import unknown
from sigmahat.paper.awas import OUTPUTS, against_the_plant, experiment, simulation
from sigmahat.runs.scenario import Comparison, Scenario, Sine, Sines, T


def single(k_3: float, frequency: float) -> Scenario:
    """Section III: one flexible transmission, linear or hardening [N.m/rad3]."""
    spring = "hardening" if k_3 else "linear"
    name = f"single-{spring}" + ("" if frequency == 0.5 else f"-{frequency:g}hz")
    # The regressors are powers of phi, about 0.01 rad; for the AwAS they go up to r^2 phi, about
    # 100 mm2 rad. So the paper's ridge 1/(c P_0) = 1 suits the AwAS, but is far too strong here.
    start: dict[str, Value] = {"rls.m": 1}
    estimators = {
        "RESIDUAL": {**start, "rls.P_0": 1e24},
        "RESIDUAL-paper-prior": start,
    }
    return Scenario(
        name=name,
        description=f"one flexible transmission, {spring} spring, {frequency:g} Hz for 15 s",
        duration=15.0,
        plant=Plant(
            fmu="FlexibleJointPlant",
            start={"spring.k_1": 150.0, "spring.k_3": k_3},
            inputs={"tau": Sine(0.3, frequency)},
            record=(
                "q_measured",
                "theta_measured",
                "tau_measured",
                "tau_e_measured",
                "theta_dot",
                "phi",
                "tau_e",
                "sigma",
            ),
        ),
        estimators={
            modality: EstimatorFmu(
                fmu="StiffnessEstimator",
                start={"samplePeriod": T, "modality": "Residual", **values},
                connections={"theta": "theta_measured", "q": "q_measured", "tau": "tau_measured"},
                record=OUTPUTS,
            )
            for modality, values in estimators.items()
        },
        comparisons=against_the_plant(estimators),
        figures=("transmission",),
    )


def antagonistic() -> Scenario:
    """Sections II and III: two motors, each with a spring, pull at one link."""
    sides = (1, 2)
    pull = Sine(0.025, 0.1)  # co-contraction, added to its mean of 0.04 N.m
    move = Sine(0.012, 0.25)  # of the link
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
                *(
                    f"{output}_{i}"
                    for i in sides
                    for output in (
                        "theta_measured",
                        "tau_measured",
                        "tau_e_measured",
                        "phi",
                        "tau_e",
                        "sigma",
                    )
                ),
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
"""All scenarios by name."""


def scenario(name: str) -> Scenario:
    """Returns the scenario of that name. Raises ValueError for an unknown name."""
    if name not in SCENARIOS:
        raise ValueError(unknown("scenario", name, SCENARIOS))
    return SCENARIOS[name]
