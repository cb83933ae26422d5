"""The sink that prints events, and the last estimate of each joint, on stderr."""

import shutil
import sys
import time
from collections.abc import Sequence
from contextlib import suppress

import click

from sigmahat.files.tables import aligned
from sigmahat.live.events import Event
from sigmahat.live.live_joint import Estimated, News
from sigmahat.live.loop import Sink
from sigmahat.result.curve import NORMAL_95

_EVERY, _RARELY = 0.5, 10.0  # [s] between two updates in a terminal, and in other outputs


def terminal() -> Sink:
    """Creates a sink that prints each event in a line, and a line for each joint below them."""
    last: dict[str, Estimated] = {}
    is_terminal = sys.stderr.isatty()
    shown_at, shown = time.monotonic(), 0

    def show(news: Sequence[News]) -> None:
        nonlocal shown_at, shown
        events = [each.in_words for each in news if isinstance(each, Event)]
        last.update({each.joint: each for each in news if isinstance(each, Estimated)})
        now = time.monotonic()
        is_time = now - shown_at > (_EVERY if is_terminal else _RARELY)
        has_lines = bool(last) and (is_time or (is_terminal and bool(events)))
        if not events and not has_lines:
            return
        lines = list(events)
        if has_lines:
            shown_at = now
            rows = [line.rstrip() for line in aligned([_row(each) for each in last.values()])]
            width = shutil.get_terminal_size().columns - 1
            lines += [line[:width] for line in rows] if is_terminal else rows
        # In a terminal, the lines replace the last ones of the joints.
        above = f"\033[{shown}F\033[J" if is_terminal and shown else ""
        with suppress(OSError):  # the terminal is closed
            click.echo(above + "\n".join(lines), err=True)
        shown = len(last) if has_lines else 0

    return show


def _row(last: Estimated) -> tuple[str, ...]:
    """In a narrow terminal, the end of the line is cut off: the torque, which no estimate needs."""
    outputs = last.outputs
    torque = f"{outputs['tau_e']:.3g} N.m at {outputs['phi']:.3g} rad"
    return (
        last.joint,
        f"{last.t:.1f} s",
        f"{outputs['sigma']:.4g} +- {NORMAL_95 * outputs['sigma_std']:.2g} N.m/rad",
        last.in_words,
        "" if last.data_age else torque,
    )
