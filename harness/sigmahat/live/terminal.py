"""The last estimates in the terminal, a line for each joint."""

from __future__ import annotations

import shutil
import sys
import time
from collections.abc import Sequence

import click

from sigmahat.files.tables import aligned
from sigmahat.joint.curve import NORMAL_95
from sigmahat.live.joint import Estimated

_EVERY = 0.5
"""Seconds between two updates in a terminal."""
_RARELY = 10.0
"""Seconds between two updates in other outputs."""


class Terminal:
    """Lines that replace each other, on stderr."""

    def __init__(self) -> None:
        self._last: dict[str, Estimated] = {}
        self._is_terminal = sys.stderr.isatty()
        self._shown_at, self._lines = time.monotonic(), 0

    def __call__(self, ticks: Sequence[Estimated]) -> None:
        """Keeps the ticks, and shows the last tick of each joint now and then."""
        for each in ticks:
            self._last[each.joint] = each
        now = time.monotonic()
        every = _EVERY if self._is_terminal else _RARELY
        if not self._last or now - self._shown_at <= every:
            return
        self._shown_at = now
        lines = [line.rstrip() for line in aligned([_row(each) for each in self._last.values()])]
        if self._is_terminal:
            width = shutil.get_terminal_size().columns - 1
            up = f"\033[{self._lines}F" if self._lines else ""
            lines = [f"{line[:width]}\033[K" for line in lines]
            lines[0] = up + lines[0]
        click.echo("\n".join(lines), err=True)
        self._lines = len(lines)


def _row(last: Estimated) -> tuple[str, ...]:
    outputs = last.outputs
    doubt = outputs["doubt"]
    return (
        last.joint,
        f"{last.t:.1f} s",
        f"{outputs['sigma']:.4g} +- {NORMAL_95 * outputs['sigma_std']:.2g} N.m/rad",
        f"{outputs['tau_e']:.3g} N.m at {outputs['phi']:.3g} rad",
        "confident" if doubt == "None" else f"not confident ({doubt})",
    )
