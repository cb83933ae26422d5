"""How often the 95 % intervals of `sigmahat identify` hold the true motor data.

    python tests/studies/identification.py RUNS

Joints of the three kinds of `sigmahat compare --misfits`, drawn at random. In every second run
friction is not of the form of the equation: it is larger at low speed, grows with the load, and
differs between the directions. Prints, for each quantity, how often a value is given, and how
often its interval holds the true one. Coulomb friction has a true value only where the form is
right.
"""

from __future__ import annotations

import sys
import tempfile
from collections import Counter
from functools import partial
from pathlib import Path

import numpy as np
import tomlkit

from sigmahat.compare.misfits.conditions import other_joint
from sigmahat.compare.misfits.experiment import Experiment, draw
from sigmahat.compare.misfits.job import settings
from sigmahat.compare.misfits.joints import JOINTS
from sigmahat.compare.misfits.motion import run
from sigmahat.identification.identify import identify
from sigmahat.identification.quantities import Quantity
from sigmahat.logs.configuration import read_configuration
from sigmahat.logs.log import LogInMemory
from sigmahat.runs.engine import run_all

FIRST_SEED = 3001
TRUE = {"B": "motor.B", "D_theta": "motor.D_theta", "tau_coulomb": "motor.tau_coulomb"}


def other_friction(experiment: Experiment) -> Experiment:
    """Friction that the equation of identify does not have."""
    rng = np.random.default_rng([experiment.seed, 3])
    return experiment.with_plant(
        {
            "motor.stribeck": float(rng.uniform(0.0, 0.5)),
            "motor.load_friction": float(rng.uniform(0.0, 0.15)),
            "motor.uneven": 0.1 * float(rng.standard_normal()),
        }
    )


def identified(number: int) -> tuple[dict[str, Quantity], Experiment]:
    """What identify finds in a run, and the run."""
    experiment = other_joint(draw(JOINTS[number % 3], FIRST_SEED + number))
    if number % 2:
        experiment = other_friction(experiment)
    measured = run(experiment).measured
    keys = (
        "motor.B",
        "motor.D_theta",
        "motor.gamma",
        "encoder.theta",
        "encoder.q",
        "rls.symmetric",
    )
    given = {key: value for key, value in settings(experiment, 0.0).items() if key in keys}
    document = {
        "ports": {name: {"column": name} for name in measured},
        "parameters": {**given, "samplePeriod": experiment.T},
    }
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "log.toml"
        path.write_text(tomlkit.dumps(document))
        found = identify(LogInMemory(Path("log"), dict(measured)), read_configuration(path))
    return dict(found.quantities), experiment


def judged(number: int) -> dict[str, tuple[bool, bool]]:
    """For each quantity of a run: whether a value is given, and whether the interval is right."""
    quantities, experiment = identified(number)
    names = [name for name in TRUE if name != "tau_coulomb" or number % 2 == 0]
    result = {}
    for name in names:
        low, high = quantities[name].interval
        result[name] = quantities[name].determined, low <= experiment.plant[TRUE[name]] <= high
    return result


def main(runs: int) -> None:
    """Prints the shares, apart for friction of the right and of another form."""
    results = run_all([partial(judged, number) for number in range(runs)])
    for form, friction in enumerate(("Coulomb and viscous friction", "other friction")):
        count: Counter[tuple[str, bool, bool]] = Counter()
        for result in results[form::2]:
            count.update((name, *each) for name, each in result.items())
        print(friction)
        for name in sorted({key[0] for key in count}):
            given = count[name, True, True] + count[name, True, False]
            other = count[name, False, True] + count[name, False, False]
            print(
                f"  {name:12} given in {given} of {given + other}, "
                f"the interval holds it in {count[name, True, True]}; "
                f"where none is given in {count[name, False, True]} of {other}"
            )


if __name__ == "__main__":
    main(int(sys.argv[1]))
