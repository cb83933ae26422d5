"""The stiffness of a joint from its log: the tutorial, in Python.

The log of the tutorial is in units of a robot: motor encoder in counts, link in degrees, current in
amperes. For a joint of your own, name its log and the configuration that `sigmahat init` made.

Usage: python own_log.py [LOG CONFIGURATION]     writes the results into the folder own_log
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
    # Room for deformations and torques that are larger than those of this log.
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
