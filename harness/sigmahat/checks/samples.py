"""Findings from the recorded columns: steps of an encoder, jumps, saturation of the torque."""

from collections.abc import Iterator

import numpy as np

from sigmahat.checks.contradictions import finding
from sigmahat.checks.findings import Finding, Kind, Severity
from sigmahat.motor.hypotheses.encoder import known_step, other_step
from sigmahat.motor.hypotheses.positions import still
from sigmahat.motor.log_view import LogView
from sigmahat.motor.noise import is_only_noise
from sigmahat.recording.column import RARE, frozen_from, restart, share_at_ends, spikes
from sigmahat.recording.configuration import Port
from sigmahat.recording.counters import Unwrapping
from sigmahat.recording.false_samples import false_samples
from sigmahat.recording.log import Array
from sigmahat.recording.notes import CounterReturned, HeldLeftOut, PlaceholderLeftOut


def of_columns(view: LogView) -> Iterator[Finding]:
    """Finds what single columns show, and what the resampling found in them."""
    yield from _of_notes(view)
    yield from _of_frozen(view)
    for name, port in view.configuration.ports.items():
        if port.value is not None:
            continue
        values = view.log.read(port.column)
        is_position = name in ("theta", "q")
        values = false_samples(values, is_position, port.wrap).left_out(values)
        finite = np.isfinite(values)
        values = values if finite.all() else values[finite]  # avoids a copy of a long log
        if name in ("theta", "q", "phi"):
            step = known_step(values)
            yield from list(_of_spikes(name, port, values, step)) or _of_jump(view, name, values)
            if is_position:
                yield from _of_step(view, name, step)
        if name == "tau" and is_only_noise(values):
            key, size = f"ports.{name}.column", float(np.std(values))
            yield Finding(Kind.NO_TORQUE, Severity.NOTE, key, size, port.unit or "N.m")
        elif name == "tau":
            yield from _of_saturation(values)


def at_rest(view: LogView) -> Iterator[Finding]:
    """Finds positions that do not change: such a log has no information on the joint."""
    names = still(view)
    if names and view.parameters["modality"] != "Sensor":
        is_joint = names == [name for name in ("theta", "q") if name in view.samples.names]
        measured = float(len(view.samples.values)) * view.T
        key = f"ports.{names[-1]}.column"
        about = "joint" if is_joint else names[0]
        yield Finding(Kind.AT_REST, Severity.WRONG, key, measured, "s", about=about)


def _of_notes(view: LogView) -> Iterator[Finding]:
    """Converts notes on samples that were left out to findings."""
    for note in view.samples.notes:
        if isinstance(note, PlaceholderLeftOut):
            yield Finding(
                Kind.PLACEHOLDER,
                Severity.NOTE,
                f"ports.{note.port}.column",
                note.share,
                "",
                note.value,
                about=note.port,
                row=note.row,
            )
        elif isinstance(note, HeldLeftOut):
            key = f"ports.{note.port}.column"
            share, row = note.share, note.row
            yield Finding(Kind.HELD, Severity.NOTE, key, share, "", about=note.port, row=row)


def _of_frozen(view: LogView) -> Iterator[Finding]:
    """Finds a position that stops changing before the other one does: a dead encoder."""
    ports = view.configuration.ports
    for name, other in (("q", "theta"), ("theta", "q")):
        if not {name, other} <= ports.keys() or not (ports[name].column and ports[other].column):
            continue
        values = view.log.read(ports[name].column)
        row = frozen_from(values, view.log.read(ports[other].column))
        if row is not None:
            key, share = f"ports.{name}.column", 1 - row / len(values)
            yield Finding(Kind.FROZEN, Severity.NOTE, key, share, "", about=name, row=row + 1)


def _of_jump(view: LogView, name: str, values: Array) -> Iterator[Finding]:
    """Finds a counter that jumps, although the port has no wrap."""
    port = view.configuration.ports[name]
    if port.wrap is not None:
        return
    key, unit = f"ports.{name}.wrap", port.unit or "rad"
    counter = restart(values)
    if counter is not None:
        jump, period = counter.jump, counter.period
        yield Finding(Kind.JUMP, Severity.WRONG, key, jump, unit, None, period, about=name)
        return
    for note in view.samples.notes:
        if isinstance(note, CounterReturned) and note.port == name:
            severity = Severity.NOTE if note.period is None else Severity.WRONG
            jump, period, row = note.largest, note.period, note.row
            yield Finding(Kind.JUMP, severity, key, jump, unit, None, period, about=name, row=row)


def _of_spikes(name: str, port: Port, values: Array, step: float) -> Iterator[Finding]:
    if port.wrap is not None:
        values = Unwrapping(port.wrap).unwrap(values)
    lost = spikes(values, step)
    if lost is not None:
        key, unit, number = f"ports.{name}.column", port.unit or "rad", float(lost.number)
        yield Finding(Kind.SPIKE, Severity.WRONG, key, lost.largest, unit, number, about=name)


def _of_step(view: LogView, name: str, step: float) -> Iterator[Finding]:
    evidence = other_step(view, name, step)
    if evidence is not None:
        is_coarser = evidence.measured > evidence.expected
        severity = Severity.WRONG if is_coarser else Severity.NOTE
        yield finding(Kind.STEP, severity, evidence, "rad", evidence.expected, name)


def _of_saturation(values: Array) -> Iterator[Finding]:
    """Finds saturation: the drive limited the torque, or the sensor was at the end of its range."""
    share = share_at_ends(values)
    if share > RARE:
        yield Finding(Kind.SATURATION, Severity.NOTE, "ports.tau.column", share, "", 0.0)
