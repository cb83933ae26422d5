"""The state of the page: a configuration that is being edited, and what is known about it.

There is one for all windows, so that they show the same, and a window that is closed loses
nothing. It belongs to the thread of the server; the jobs tell it what they have found.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from time import monotonic
from typing import TYPE_CHECKING, Any

import tomlkit

from sigmahat.files.output import write_whole
from sigmahat.logs.configuration import PORTS, joints_of
from sigmahat.logs.joints import of_joint, together
from sigmahat.logs.log import Log
from sigmahat.page import edits
from sigmahat.page.edits import BY_SCALE, OF_PORT
from sigmahat.page.look import Look

if TYPE_CHECKING:
    from sigmahat.checks.findings import Checked
    from sigmahat.guessing.ports import PortGuess
    from sigmahat.logs.curve import Answer

Chosen = Callable[[Mapping[str, str | None]], "Mapping[str, PortGuess]"]
"""Guesses units, signs and gear of columns by port."""

_DOUBLE_CLICK = 0.5  # [s] the second click of one is no answer to a question


class Setup:
    """A log that is being set up."""

    def __init__(self, log: Log, path: Path) -> None:
        """Starts from the file, if there is one. Raises LogError if it is not TOML."""
        self.log = log
        self.path = path
        """The file to write."""
        self.document: tomlkit.TOMLDocument = tomlkit.document()
        self.is_edited = False
        """Whether somebody has changed something that is not written yet."""
        self.looks: Mapping[str, Look] = {}
        """What the columns look like, by name; empty until it is known."""
        self.joint = ""
        """Which joint of the log is shown."""
        self.busy = "Looking at the columns ..."
        """What is being computed; empty if nothing is."""
        self.problem = ""
        """Why the configuration cannot be checked; empty if it can."""
        self.checked: Checked | None = None
        self.answer: Answer | None = None
        self.message = ""
        """What the last press of a button or the last value led to."""
        self.changed: Callable[[], object] = lambda: None
        """Is called after every change of the configuration."""
        self.asks_to_overwrite = False
        """Whether the file exists, and was not overwritten."""
        self._asked = 0.0
        self._then: Callable[[], object] | None = None
        self._shown: set[Callable[[], object]] = set()
        self._chosen: Chosen = lambda names: {}
        self.joints: dict[str, tomlkit.TOMLDocument] = {}
        """The configurations of the joints by name; empty until they are known."""

    # Windows

    def subscribe(self, show: Callable[[], object]) -> None:
        """Calls show after every change, until it is unsubscribed."""
        self._shown.add(show)

    def unsubscribe(self, show: Callable[[], object]) -> None:
        """Does not call it any more."""
        self._shown.discard(show)

    def show(self) -> None:
        """All windows show what there is."""
        for each in list(self._shown):
            each()

    # The configuration

    @property
    def text(self) -> str:
        """The configuration of the joint that is shown."""
        return tomlkit.dumps(self.document)

    @property
    def text_of_file(self) -> str:
        """The configuration of all joints, as it would be written."""
        return tomlkit.dumps(together(self.joints)) if len(self.joints) > 1 else self.text

    @property
    def is_ready(self) -> bool:
        """Whether there is a configuration to edit."""
        return bool(self.document)

    def start_from(self, document: tomlkit.TOMLDocument) -> None:
        """Takes the contents of the file. Raises LogError for a joint that has no possible name."""
        self._start({name: of_joint(document, name) for name in joints_of(document, self.path)})

    def _start(self, joints: dict[str, tomlkit.TOMLDocument]) -> None:
        self.joints = joints
        self.set_joint(next(iter(joints)))

    def get(self, key: str) -> Any:
        """The value of a key; None if it is not there."""
        return edits.value_of(self.document, key)

    def set(self, key: str, value: edits.Value | None) -> None:
        """Sets a key; None removes it."""
        if value == self.get(key):
            self.show()  # what was typed looks other than it is written
            return
        if key.startswith("ports.") and key.endswith(".unit") and value is not None:
            self._set_unit(key.split(".")[1], str(value))
        elif value is None:
            edits.remove_value(self.document, key)
        else:
            edits.set_value(self.document, key, value)
        self._edited()

    def set_column(self, port: str, column: str | None) -> None:
        """Gives a port another column, or none; unit, sign, zero and gear are guessed anew."""
        if column == self.get(f"ports.{port}.column"):
            return
        if column is None:
            edits.set_port(self.document, port, None)
        else:
            names = {each: self.get(f"ports.{each}.column") for each in PORTS}
            guessed = self._chosen({**names, port: column}).get(port)
            if guessed is not None:
                from sigmahat.guessing.template import port_table

                edits.set_port(self.document, port, port_table(port, guessed))
            else:
                edits.set_value(self.document, f"ports.{port}.column", column)
        self._edited()

    def _set_unit(self, port: str, unit: str) -> None:
        """With a unit come the keys that it needs, and those of the unit before go."""
        where = f"ports.{port}"
        before = self.get(f"{where}.unit") or BY_SCALE
        for field in OF_PORT:
            key = f"{where}.{field.key}"
            if unit in field.units and self.get(key) is None and field.key != "mm_per_turn":
                edits.set_value(self.document, key, 0)
            if before in field.units and unit not in field.units:
                edits.remove_value(self.document, key)
        if unit == BY_SCALE:
            edits.remove_value(self.document, f"{where}.unit")
        else:
            edits.set_value(self.document, f"{where}.unit", unit)
        # Counts of a port are those of its encoder; another unit hides them.
        if unit == "counts":
            edits.remove_value(self.document, f"encoder.{port}")
        elif before == "counts" and port in ("theta", "q"):
            edits.set_value(self.document, f"encoder.{port}", 0)

    def _edited(self) -> None:
        self.is_edited, self.message, self.asks_to_overwrite = True, "", False
        self.changed()

    # What the jobs have found

    def guessed(self, templates: Mapping[str, str], chosen: Chosen) -> None:
        """Takes what was guessed: the configuration of each joint as `init` writes it."""
        self._chosen = chosen
        if not self.joints:
            self._start({name: tomlkit.parse(text) for name, text in templates.items()})

    def set_joint(self, name: str) -> None:
        """Shows another joint of the log."""
        self.joint, self.document = name, self.joints[name]
        # All that was found and asked is of the joint before.
        self.message, self.problem, self.asks_to_overwrite = "", "", False
        self.checked = self.answer = None
        self.changed()

    # Files

    @property
    def open_keys(self) -> list[str]:
        """Keys that have to be filled in."""
        return edits.to_fill_in(self.document)

    @property
    def is_on_disk(self) -> bool:
        """Whether the file exists, and is as the page shows it."""
        try:
            return self.path.read_text(encoding="utf-8") == self.text_of_file
        except (OSError, ValueError):
            return False

    def write(self, overwrite: bool, then: Callable[[], object] | None = None) -> None:
        """Writes the file; one that exists only if it is to be overwritten, after the question.

        then  is called when the file is written, also after the question
        """
        if not overwrite:
            self._then = then
        elif not (self.asks_to_overwrite and monotonic() > self._asked + _DOUBLE_CLICK):
            return
        self.asks_to_overwrite = self.path.exists() and not (overwrite or self.is_on_disk)
        if self.asks_to_overwrite:
            self._asked = monotonic()
            self.message = f"{self.path} exists, and is other than what is shown here."
        elif self._is_written():
            log, default = self.log.path, Path(f"{self.log.path.stem}.toml")
            option = "" if self.path == default else f" --config {self.path}"
            self.message += f" Next: sigmahat identify {log}{option}, then sigmahat estimate {log}"
            self.message += option
            if self._then is not None:
                self._then()
        self.show()

    def _is_written(self) -> bool:
        """Writes the file; the message says where it is, or why it cannot be written."""
        try:
            write_whole(self.text_of_file, self.path)
        except OSError as error:
            self.message = f"Cannot write {self.path}: {error.strerror}."
            return False
        self.message = f"Written: {self.path.resolve()}."
        self.is_edited = False
        return True

    @property
    def is_by_sensor(self) -> bool:
        """Whether the torque is that of a sensor: then there is no motor to identify."""
        return bool(self.get("modality") == "Sensor")

    def estimated(self, before: str, document: tomlkit.TOMLDocument, folder: Path) -> None:
        """Takes the configuration with which results were written into a folder, and writes it.

        before  the configuration from which this began; if it was edited since, the edits stay
        """
        results = f"Results: {folder.resolve()}."
        if self.text != before:
            self.message = f"{results} They are of the configuration before your last edit."
            self.changed()
            return
        self.document = self.joints[self.joint] = document
        following = f" Next: sigmahat report {folder}" if self._is_written() else ""
        results += f" {self.message}{following}"
        self.changed()
        self.message = results
        self.show()

    def write_draft(self) -> Path | None:
        """Writes edits that are not written into a file of a new name. Returns it, if there are."""
        if not self.is_edited:
            return None
        draft, count = self.path.with_suffix(".draft.toml"), 2
        while draft.exists():
            draft, count = self.path.with_suffix(f".draft-{count}.toml"), count + 1
        write_whole(self.text_of_file, draft)
        return draft
