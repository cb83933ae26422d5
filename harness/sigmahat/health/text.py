"""What has become of a joint, in one line, and in a table."""

from collections.abc import Iterator, Sequence
from datetime import datetime

from sigmahat.estimator.doubts import DOUBTS
from sigmahat.health.change import Kind
from sigmahat.health.judge import (
    FEWEST,
    SILENT,
    Judged,
    State,
    Unjudged,
    UnjudgedLimit,
    Verdict,
    change_of_value,
)
from sigmahat.health.logs import LeftOut, Reason
from sigmahat.health.quantities import Agreed, Name, NoStiffness

_WORDS = {
    Name.MIDDLE: ("the middle is stiffer", "the middle is softer"),
    Name.BACKLASH: ("more backlash", "less backlash"),
    Name.HYSTERESIS: ("more hysteresis", "less hysteresis"),
    Name.COULOMB: ("more Coulomb friction", "less Coulomb friction"),
    Name.VISCOUS: ("more viscous friction", "less viscous friction"),
    Name.LOAD: ("more friction by load", "less friction by load"),
    Name.STIFFNESS: ("stiffer", "softer"),
}
"""Words for an increase and a decrease."""


def sentence(verdict: Verdict) -> str:
    """Returns the line about a joint."""
    return f"{verdict.logs.joint}: {_without_name(verdict)}"


def _without_name(verdict: Verdict) -> str:
    used = verdict.logs.used
    if not used:
        return "no results that count"
    if verdict.state is State.UNKNOWN:
        return f"too few logs to tell ({_level(verdict)}{_count(verdict)}; {FEWEST} are needed)"
    changed = [each for each in verdict.every if each.state is State.CHANGED]
    restored = [each for each in verdict.every if each.state is State.RESTORED]
    parts = [_change(each) for each in changed]
    parts += [f"{each.quantity.name.value} as before, {_dates(each)}" for each in restored]
    possible = [each for each in verdict.every if each.state is State.POSSIBLE]
    if possible:
        said = " and ".join(_possible(each) for each in possible)
        parts.append(f"perhaps {said}: more logs will tell")
    in_brackets = f"({_level(verdict)}{_count(verdict)})"
    since = f"since {day(used[0].time)}"
    stiffness = verdict.stiffness
    if verdict.state is State.UNCHANGED and stiffness is not None:
        parts = [f"unchanged {since} {in_brackets}, {_within(stiffness)}"]
    elif verdict.state is State.UNCLEAR:
        if any(each.state is State.UNCHANGED for each in verdict.every):
            parts = [f"what else the logs show is unchanged {since}"]
    elif verdict.state is State.POSSIBLE:
        parts[-1] += f" {in_brackets}"
    elif verdict.without_stiffness:
        parts[-1] += f" ({_count(verdict)})"
    if changed or restored:
        parts += _backlash(verdict)
    if verdict.is_unclear:
        parts.insert(0, f"the stiffness cannot be judged: {_unclear(verdict)}")
    if verdict.silent >= SILENT:
        parts.append(f"the last {verdict.silent} logs do not count for the stiffness")
    parts += [_limit(each) for each in verdict.every if each.passed is not None]
    parts += [_unjudged(each) for each in verdict.unjudged]
    if not verdict.gain_cancels:
        known = 100 * max(each.torque_gain for each in used)
        parts.append(
            f"no change of the gain of the torque is told apart (known to {known:.2g} %): the "
            "logs do not determine the inertia of the motor"
        )
    return "; ".join(parts)


def _count(verdict: Verdict) -> str:
    """How many logs count for the stiffness."""
    every = len(verdict.logs.used)
    logs = "1 log" if every == 1 else f"{every} logs"
    missing = len(verdict.without_stiffness)
    return f"{every - missing} of {logs}" if missing else logs


def _within(judged: Judged) -> str:
    """How well the change from the first to the last logs is known."""
    assert judged.difference is not None
    return f"within +- {100 * change_of_value(judged.quantity, judged.difference)[1]:.2g} %"


def _unclear(verdict: Verdict) -> str:
    """Why a change of the stiffness would not be seen."""
    stiffness = verdict.stiffness
    if stiffness is None:
        return f"none of {len(verdict.logs.used)} logs counts"
    said = f"{_count(verdict)} count ({_level(verdict).removesuffix(', ')}), "
    if stiffness.difference is None:
        return f"{said}{FEWEST} are needed"
    return f"{said}its change is known {_within(stiffness)}"


def _level(verdict: Verdict) -> str:
    stiffness = verdict.stiffness
    if stiffness is None:
        return ""
    value, half = stiffness.now
    return f"{value:.4g} +- {half:.2g} N.m/rad, "


def _backlash(verdict: Verdict) -> list[str]:
    """What has not happened to the backlash, of a joint that has changed."""
    shown = (each for each in verdict.every if each.quantity.name is Name.BACKLASH)
    backlash = next(shown, None)
    if backlash is None:
        return ["no backlash is seen"]
    return ["the backlash did not change"] if backlash.state is State.UNCHANGED else []


def _possible(judged: Judged) -> str:
    if judged.changes:
        return _change(judged)
    return f"{in_words(judged)} from the first to the last logs"


def _change(judged: Judged) -> str:
    change = judged.changes[-1]
    since = f"since about {day(change.after)}"
    if change.change.kind is Kind.TREND:
        since = f"slowly, since about {day(change.before)}"
    return f"{in_words(judged)} {since}"


def in_words(judged: Judged) -> str:
    """Returns the change of a quantity since the first logs, with half of its 95 % interval."""
    quantity, difference = judged.quantity, judged.difference
    if difference is None:
        return "-"
    size, half = change_of_value(quantity, difference)
    if quantity.name is Name.GAIN:
        # A smaller torque constant makes inertia, and all torques, look larger.
        gain = 1 / (1 + size) - 1
        of_gain = f"torque constant or current sensor: {100 * gain:+.2g} +- {100 * half:.2g} %"
        before = {State.CHANGED: "not the spring, but ", State.POSSIBLE: "another "}
        return f"{before.get(judged.state, '')}{of_gain}"
    word = _WORDS[quantity.name][0 if size > 0 else 1]
    if quantity.name is Name.BACKLASH:
        return f"{word}, {1e3 * size:+.2g} +- {1e3 * half:.1g} mrad (half width)"
    return f"{word} by {100 * abs(size):.2g} +- {100 * half:.2g} %"


def _dates(judged: Judged) -> str:
    first, last = judged.changes[0], judged.changes[-1]
    return f"after a change from {day(first.after)} to {day(last.after)}"


def limit_in_words(name: Name, limit: float) -> str:
    """Returns the limit of the user for a quantity, as for judge()."""
    return f"{1e3 * limit:+g} mrad" if name is Name.BACKLASH else f"{100 * limit:+g} %"


def _limit(judged: Judged) -> str:
    assert judged.passed is not None
    name, passed = judged.quantity.name, judged.passed
    return (
        f"the limit of {name.value}, {limit_in_words(name, passed.limit)}, is passed with a "
        f"probability of {percent(passed.probability)}"
    )


def _unjudged(each: UnjudgedLimit) -> str:
    return (
        f"the limit of {each.name.value}, {limit_in_words(each.name, each.limit)}, cannot be "
        f"judged: {why_unjudged(each)}"
    )


def why_unjudged(each: UnjudgedLimit) -> str:
    """Returns why a limit of the user says nothing about a joint."""
    if each.reason is Unjudged.FEW:
        return f"only {each.logs} of the {FEWEST} logs that are needed show this quantity"
    if each.name is Name.BACKLASH:
        return "no log shows any backlash"
    return "the logs do not show this quantity, or not well enough"


def percent(probability: float) -> str:
    """Returns a probability in words: no model is right to the last per mille."""
    if probability < 0.01:
        return "less than 1 %"
    return "more than 99 %" if probability > 0.99 else f"{100 * probability:.2g} %"


def left_out_in_words(verdict: Verdict) -> Iterator[str]:
    """Yields a sentence for each result that does not count, and for those without a stiffness."""
    yield from doubts_in_words(verdict.logs.left_out)
    if verdict.agreed is not None:
        yield from _comparison(verdict.logs.joint, verdict.agreed)
    for reason in NoStiffness:
        logs = [i for i, each in verdict.without_stiffness.items() if each is reason]
        if not logs:
            continue
        at = ""
        agreed = verdict.agreed.phi if verdict.agreed else None
        if agreed is not None and reason is NoStiffness.DEFORMATION:
            low, _, high = agreed
            at = f" ({1e3 * low:.3g} to {1e3 * high:.3g} mrad)"
        used = verdict.logs.used
        also = f" and {len(logs) - 1} more" if len(logs) > 1 else ""
        yield (
            f"{verdict.logs.joint}: {len(logs)} of {len(used)} logs do not count for the "
            f"stiffness: {used[logs[0]].place}{also}, which {reason.value}{at}"
        )


def _comparison(joint: str, agreed: Agreed) -> Iterator[str]:
    """Yields how the stiffnesses are compared, if not at common deformations."""
    if agreed.phi is not None:
        return
    what = "deformations" if agreed.set_point is not None else "a set-point"
    yield (
        f"{joint}: fewer than nine of ten logs have {what} in common, so each stiffness is that at "
        "the deformation where its log knows it best; a change that came together with other "
        "deformations (another payload, for example) is not called one of the spring"
    )


def doubts_in_words(left_out: Sequence[LeftOut]) -> Iterator[str]:
    """Yields a sentence for each result that is no evidence."""
    for each in left_out:
        place, other = each.result.place, each.other
        if each.reason is Reason.SAME_LOG:
            yield f"{place}: the same log as {other}; it counts once"
        elif each.reason is Reason.CONTINUED:
            of = f" of {other}" if other else " of another log"
            yield (
                f"{place}: continued from the state{of}, so it is no evidence of its own; estimate "
                "this log without --start-from"
            )
        else:
            doubt = each.result.doubt
            why = f": {DOUBTS[doubt][1]}" if doubt in DOUBTS else ""
            yield f"{place}: left out, {doubt}{why}"


def day(time: datetime) -> str:
    return time.strftime("%Y-%m-%d")


HEAD = ("joint", "quantity", "state", "now", "change", "limit", "logs")


def rows(verdicts: Sequence[Verdict]) -> Iterator[tuple[str, ...]]:
    """Yields a row of HEAD for each quantity of each joint."""
    for verdict in verdicts:
        for each in verdict.every:
            quantity = each.quantity
            value, half = each.now
            scale, unit = (1e3, "mrad") if quantity.name is Name.BACKLASH else (1, quantity.unit)
            limit = ""
            if each.passed is not None:
                given = limit_in_words(quantity.name, each.passed.limit)
                limit = f"{given}: {percent(each.passed.probability)}"
            yield (
                verdict.logs.joint,
                quantity.name.value,
                each.state.value,
                f"{scale * value:.4g} +- {scale * half:.2g} {unit}".removesuffix(" 1"),
                in_words(each),
                limit,
                str(len(quantity.logs)),
            )
