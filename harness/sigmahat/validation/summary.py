"""The result of a validation as text, for people."""

from __future__ import annotations

from collections.abc import Iterator

from sigmahat.validation.torque import TorqueError
from sigmahat.validation.validate import Validation


def summary(result: Validation) -> str:
    """One screen."""
    both = result.stiffness
    lines = [f"{result.log}", *(f"  {note}" for note in result.notes), ""]
    lines += [
        f"learned before from {', '.join(result.learned_from)} ({result.start_from})",
        "",
        "torque at the stiffness that was learned, in motion; friction and bias are of this log:",
        f"  error RMS         {_error(result.torque)}",
        f"  below 2 Hz        {_error(result.torque_below)}",
        "stiffness at the end, median over the instants of this log, with 95 % interval:",
        f"  learned before    {_value(both.before)}",
        f"  this log alone    {_value(both.alone)}",
        f"  this log is within the interval of before at {100 * both.alone_in_before:.3g} % of the "
        f"instants, the other way round {100 * both.before_in_alone:.3g} %",
        f"  intervals overlap at {100 * both.overlap:.3g} %; difference over its standard "
        f"deviation {both.z:.3g} (RMS)",
        "",
        *_verdict(result),
    ]
    return "\n".join(lines)


def _error(error: TorqueError | None) -> str:
    if error is None:
        return "  cannot tell: too few samples in motion"
    return (
        f"{error.rms:10.4g} N.m, {100 * error.relative:.3g} % of its standard deviation "
        f"(at {100 * error.share:.3g} % of the instants)"
    )


def _value(value: tuple[float, float]) -> str:
    return f"{value[0]:10.5g} +- {value[1]:.2g} N.m/rad"


def _verdict(result: Validation) -> Iterator[str]:
    if result.repeated:
        yield "cannot tell: this log is one of those that were learned from"
    elif result.agree is None:
        yield "cannot tell: an interval is wider than the stiffness itself"
    elif result.agree:
        yield "the logs agree"
    else:
        yield "the logs do not agree: the stiffness differs by more than its intervals explain"
