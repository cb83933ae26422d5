"""Conditions of a comparison in words, for tables, files and figures."""

from __future__ import annotations

from sigmahat.compare.conditions import Case, Joint
from sigmahat.compare.job import Row

_SIDES = {"": "device", "_1": "side 1", "_2": "side 2"}


def group(row: Row) -> str:
    """The heading that a row stands under."""
    if not row.case.motor_errors:
        return "motor data exact, and known to be"
    if row.joint.lever_arm is None:
        return "antagonistic pair" if len(row.joint.parts) > 1 else "single transmission"
    friction = f", Coulomb friction {row.joint.coulomb:g} N.m" if row.joint.coulomb else ""
    return f"{lever_arm(row.joint)}{friction}"


def lever_arm(joint: Joint) -> str:
    """The lever arm of an AwAS, as text."""
    return f"r(0) = {1e3 * (joint.lever_arm or 0.0):g} mm"


def motion(joint: Joint) -> str:
    """The scenario of the paper, or the frequency."""
    return joint.scenario.name if joint.frequency is None else f"{joint.frequency:g} Hz"


def case(case: Case) -> str:
    """The errors of the data given to the estimators."""
    errors = [f"{name} {100 * error:+.0f} %" for name, error in case.motor_errors.items()]
    if case.nominal_error is not None:
        errors.append(f"nominal curve {100 * case.nominal_error:+.0f} %")
    return ", ".join(errors) or "stiffness unknown"


def case_and_part(row: Row) -> str:
    """The case and, for a device with several stiffnesses, the stiffness."""
    several = len(row.joint.parts) > 1
    return f"{case(row.case)}, {_SIDES[row.part]}" if several else case(row.case)
