"""Creates a page from the judgement of many logs."""

from collections.abc import Sequence

from sigmahat.health.judge import State, Verdict
from sigmahat.health.panels import panels, shown
from sigmahat.health.text import HEAD, left_out_in_words, rows, sentence
from sigmahat.report.contents import Contents, TextTable


def from_health(verdicts: Sequence[Verdict], notes: Sequence[str]) -> Contents:
    """A line for each joint, those with an alarm first; the pictures; the table of all quantities.

    notes  about results that were not read
    """
    ordered = sorted(verdicts, key=lambda each: not each.is_alarm)
    alarms = sum(each.is_alarm for each in verdicts)
    changed = sum(each.state is State.CHANGED for each in verdicts)
    every = len(verdicts)
    possible = sum(each.state is State.POSSIBLE for each in verdicts)
    if alarms:
        head = f"{alarms} of {every} joints changed"
        head += ", or likely passed a limit" if changed < alarms else ""
    elif possible:
        head = f"perhaps a change in {possible} of {every} joints"
    else:
        head = f"no change in {every} joint(s)"
    if unwatched := sum(not each.is_watched for each in verdicts):
        head += f"; {unwatched} of {every} cannot be judged, or not by the last logs"
    left_out = [line for each in ordered for line in left_out_in_words(each)]
    words = tuple(range(len(HEAD) - 1))
    return Contents(
        "Health",
        [sentence(each) for each in ordered],
        [TextTable("All quantities", HEAD, list(rows(ordered)), words)],
        [],
        headline=head,
        answer=[panel for each in shown(ordered) for panel in panels(each)],
        notes=[*notes, *left_out],
    )
