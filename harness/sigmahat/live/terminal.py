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
"""Seconds between two pictures in a terminal,"""
_RARELY = 10.0
"""and elsewhere."""


class Terminal:
    """Lines that replace each other, on stderr."""

    def __init__(self) -> None:
        self._last: dict[str, Estimated] = {}
        self._is_terminal = sys.stderr.isatty()
        self._shown_at, self._lines = time.monotonic(), 0

    def __call__(self, ticks: Sequence[Estimated]) -> None:
        """Keeps the ticks, and shows them now and then."""
        for each in ticks:
            self._last[each.joint] = each
        now = time.monotonic()
        if now - self._shown_at > (_EVERY if self._is_terminal else _RARELY):
            self._shown_at = now
            self.show()

    def show(self) -> None:
        """Shows the last estimate of each joint."""
        lines = [line.rstrip() for line in aligned([_row(each) for each in self._last.values()])]
        if self._is_terminal:
            up, clear = f"\033[{self._lines}F" if self._lines else "", "\033[K"
            lines = [f"{line[: shutil.get_terminal_size().columns - 1]}{clear}" for line in lines]
            click.echo(up + "\n".join(lines), err=True)
        else:
            click.echo("\n".join(lines), err=True)
        self._lines = len(lines)

    def clear(self) -> None:
        """The next lines come below what is printed now."""
        self._lines = 0


def _row(last: Estimated) -> tuple[str, ...]:
    outputs = last.outputs
    doubt = outputs["doubt"]
    return (
        last.name,
        f"{last.t:.1f} s",
        f"{outputs['sigma']:.4g} +- {NORMAL_95 * outputs['sigma_std']:.2g} N.m/rad",
        f"{outputs['tau_e']:.3g} N.m at {outputs['phi']:.3g} rad",
        "confident" if doubt == "None" else f"not confident ({doubt})",
    )
