"""Estimates the stiffness of a joint from its log, like the tutorial, but in Python.

The log of the tutorial has the motor encoder in counts, the link position in degrees and the
current in amperes. For your own joint, pass its log and its configuration from `sigmahat init`.

Usage: python own_log.py [LOG CONFIGURATION]     The folder own_log will contain the results.
"""

import sys
from dataclasses import replace
from pathlib import Path

import sigmahat

TUTORIAL = Path(__file__).parent / "tutorial"


def main(log_file: Path, configuration_file: Path) -> None:
    """Identifies the motor, then estimates the stiffness."""
    log = sigmahat.open_log(log_file)
    configuration = sigmahat.read_configuration(configuration_file)
    motor = sigmahat.identify(log, configuration)
    # The ranges allow deformations and torques that are up to 20 % larger than in the log.
    ranges = {"range.phi": 1.2 * motor.phi, "prior.tau_e": 1.2 * motor.torque}
    orders = {"rls.n": motor.n, "rls.symmetric": motor.symmetric}
    parameters = {**configuration.parameters, **ranges, **orders}
    for name, parameter in (
        ("B", "motor.B"),
        ("D_theta", "motor.D_theta"),
        ("tau_coulomb", "prior.tau_coulomb"),
    ):
        found = motor.quantities[name]
        if found.determined:
            print(f"{name}: {found.value:.4g} +- {found.half_width:.1g}")
            parameters[parameter] = found.value
        else:
            print(f"{name}: cannot tell")
    folder = Path("own_log")
    folder.mkdir(exist_ok=True)
    result = sigmahat.estimate(log, replace(configuration, parameters=parameters), folder)
    low, high = result.sigma_range
    print(f"stiffness in the second half: {low:.1f} to {high:.1f} N.m/rad, see {folder}")


if __name__ == "__main__":
    main(*map(Path, sys.argv[1:] or (TUTORIAL / "knee.csv", TUTORIAL / "knee.toml")))
