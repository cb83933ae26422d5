"""The pictures of a joint: each quantity over the days, with bands, changes and limits."""

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from sigmahat.health.change import Kind
from sigmahat.health.judge import Judged, State, Verdict
from sigmahat.health.quantities import Name, Quantity
from sigmahat.health.text import day, in_words
from sigmahat.result.curve import NORMAL_95
from sigmahat.show.panel import COLORS, TRUE, Panel, Trace, TraceKind
from sigmahat.show.style import plain_unit

Array = NDArray[np.float64]

_MANY = 12  # joints from which those that are unchanged are not drawn
_SHOWN = (State.CHANGED, State.POSSIBLE, State.RESTORED)


def shown(verdicts: Sequence[Verdict]) -> Sequence[Verdict]:
    """Returns the joints to draw: of many, only those that have changed."""
    if len(verdicts) <= _MANY:
        return verdicts
    return [each for each in verdicts if each.is_alarm or each.state is State.RESTORED]


def panels(verdict: Verdict) -> list[Panel]:
    """Panels of the stiffness, and of each other quantity that has changed or has a limit."""
    return [
        _panel(each, verdict)
        for each in verdict.every
        if each.quantity.name is Name.STIFFNESS or each.state in _SHOWN or each.passed is not None
    ]


def _panel(judged: Judged, verdict: Verdict) -> Panel:
    quantity = judged.quantity
    first = verdict.logs.used[0].time
    days = quantity.series.times - first.timestamp() / 86400.0
    scale, unit = (1e3, "mrad") if quantity.name is Name.BACKLASH else (1.0, quantity.unit)
    values = scale * _in_unit(quantity, quantity.series.values)
    changed = judged.state in _SHOWN
    name = quantity.name.value
    title = f"{verdict.logs.joint}: {name}"
    if quantity.name is Name.GAIN:
        name = "inertia by the torque"  # which is larger with a smaller torque constant
    return Panel(
        title=title,
        x_label=f"days since {day(first)}",
        y_label=f"{name} [{plain_unit(unit)}]" if unit != "1" else name,
        curves=[
            *_levels(judged, days, scale),
            Trace("logs", COLORS[0], days, values, TraceKind.POINTS),
            *_limit(judged, days, scale),
        ],
        linked=False,
        caption=in_words(judged) if changed else "",
    )


def _in_unit(quantity: Quantity, values: Array) -> Array:
    found: Array = quantity.level * (np.exp(values) if quantity.is_logarithm else values)
    return found


def _levels(judged: Judged, days: Array, scale: float) -> list[Trace]:
    """The level between two changes, with the band in which 95 % of the logs are; a new line begins
    at each change."""
    quantity, series = judged.quantity, judged.quantity.series
    begins = [0, *(each.change.at for each in judged.changes), len(days)]
    traces, level = [], 0.0
    for number, (first, last) in enumerate(pairwise(begins)):
        part = series.part(first, last)
        before, level = level, float(np.average(part.values, weights=part.stds**-2))
        values = np.full(2, level)
        if number and judged.changes[number - 1].change.kind is Kind.TREND:
            values = before + np.array([0.0, judged.changes[number - 1].change.size])
        half = NORMAL_95 * float(np.median(part.stds))
        low, high = (scale * _in_unit(quantity, values + side * half) for side in (-1, 1))
        label = "level" if number == 0 else f"after change {number}"
        color = COLORS[(1 + 2 * number) % len(COLORS)]
        at = np.array([days[first], days[last - 1]])
        y = scale * _in_unit(quantity, values)
        traces.append(Trace(label, color, at, y, band=(low, high)))
    return traces


def _limit(judged: Judged, days: Array, scale: float) -> Sequence[Trace]:
    if judged.passed is None or judged.difference is None:
        return []
    quantity, given = judged.quantity, judged.passed.limit
    first = _in_unit(quantity, np.array([judged.difference.first]))[0]
    value = first * (1 + given) if quantity.is_relative else first + given
    at = np.array([days[0], days[-1]])
    return [Trace("limit", TRUE, at, np.full(2, scale * value), dash=(6, 2))]
