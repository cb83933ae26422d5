"""Tables of parameters from the data sheet of a joint."""

from __future__ import annotations

from sigmahat.joint.sheet import Sheet
from sigmahat.plotting.symbols import plain_unit
from sigmahat.report.contents import TextTable, number

_WORDS = {
    "gamma": "gear ratio",
    "B": "inertia of the motor",
    "D_theta": "viscous friction of the motor",
    "tau_coulomb": "Coulomb friction of the motor",
    "bias": "bias of the torque",
    "damping": "damping of the joint",
    "load_friction": "friction by load",
    "eccentric": "eccentricity of the encoders",
    "delay": "delay of the torque",
    "hysteresis": "hysteresis",
}
_FROM = {"prior": "the configuration (prior)", "identify": "identify", "exact": "taken as exact"}


def found_table(sheet: Sheet) -> TextTable:
    """Motor data and what else was estimated, with intervals."""
    rows = []
    for name, each in sheet.parameters.items():
        interval = "-" if each.interval is None else " to ".join(map(number, each.interval))
        unit = "" if each.unit == "1" else plain_unit(each.unit)
        source = _FROM.get(each.interval_from, each.interval_from)
        rows.append([_WORDS.get(name, name), name, number(each.value), unit, interval, source])
    return TextTable(
        "Joint and motor",
        ["", "name", "value", "unit", "95 % interval", "interval from"],
        rows,
        [True, True, False, True, False, True],
    )


def estimator_table(sheet: Sheet) -> TextTable:
    """All parameters of the estimator but the coefficients of its curve; folded."""
    rows = [
        [name, str(value).lower() if isinstance(value, bool) else number(value)]
        for name, value in sheet.start_values.items()
        if not name.startswith("rls.eta_0")
    ]
    note = "motor.B and motor.D_theta as they were found"
    title = "Parameters of the estimator"
    return TextTable(title, ["parameter", "value"], rows, [True, False], note=note, folded=True)
