"""The files and the JSON of `sigmahat health`."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from sigmahat.files.tables import write_csv
from sigmahat.health.judge import Judged, Verdict, change_of_value
from sigmahat.health.panels import panels, shown
from sigmahat.health.quantities import Name
from sigmahat.health.text import HEAD, left_out_in_words, rows, sentence, why_unjudged

CSV = "health.csv"  # name of the table of all quantities


def write(verdicts: Sequence[Verdict], folder: Path) -> None:
    """Writes the table of all quantities, and a picture of each joint that is shown."""
    write_csv(folder / CSV, HEAD, rows(verdicts))
    if drawn := shown(verdicts):
        from sigmahat.show.figure import save, stacked  # loaded only if something is drawn

        for verdict in drawn:
            if of_joint := panels(verdict):
                save(stacked, of_joint, folder / verdict.logs.joint)


def values(verdicts: Sequence[Verdict]) -> dict[str, Any]:
    """Returns everything for JSON. Times are those of ISO 8601; units are in `units`."""
    return {
        "alarm": any(each.is_alarm for each in verdicts),
        "units": _UNITS,
        "joints": {each.logs.joint: _joint(each) for each in verdicts},
    }


_UNITS = {Name.STIFFNESS.name.lower(): "N.m/rad", "backlash": "rad", "z": "1", "probability": "1"}


def _joint(verdict: Verdict) -> Mapping[str, Any]:
    used = verdict.logs.used
    return {
        "answer": sentence(verdict),
        "state": verdict.state.value,
        "alarm": verdict.is_alarm,
        "watched": verdict.is_watched,
        "last_logs_not_counted": verdict.silent,
        "logs": len(used),
        "from": used[0].time.isoformat() if used else None,
        "to": used[-1].time.isoformat() if used else None,
        "gain_cancels": verdict.gain_cancels,
        "deformations": verdict.agreed.phi if verdict.agreed else None,
        "set_point": verdict.agreed.set_point if verdict.agreed else None,
        "z_limit": verdict.limit,
        "left_out": list(left_out_in_words(verdict)),
        "limits_not_judged": {
            each.name.name.lower(): why_unjudged(each) for each in verdict.unjudged
        },
        "quantities": {each.quantity.name.name.lower(): _quantity(each) for each in verdict.every},
    }


def _quantity(judged: Judged) -> Mapping[str, Any]:
    quantity, difference = judged.quantity, judged.difference
    value, half = judged.now
    change = None if difference is None else change_of_value(quantity, difference)
    return {
        "state": judged.state.value,
        "unit": quantity.unit,
        "value": value,
        "interval": (value - half, value + half),
        "logs": len(quantity.logs),
        "relative": quantity.is_relative,
        "change": change and change[0],
        "change_interval": change and (change[0] - change[1], change[0] + change[1]),
        "changes": [
            {
                "kind": each.change.kind.value,
                "before": each.before.isoformat(),
                "after": each.after.isoformat(),
                "z": each.change.z,
            }
            for each in judged.changes
        ],
        "limit": judged.passed and judged.passed.limit,
        "probability": judged.passed and judged.passed.probability,
    }
