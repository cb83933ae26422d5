"""The state of the page: a configuration that is being edited, and results for it.

All windows share one state, so that they show the same, and a closed window loses nothing. Only
the thread of the server may use the state; jobs send their results to this thread.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import tomlkit

from sigmahat.files.output import write_whole
from sigmahat.recording.configuration import FILL_IN, PORTS, joints_of
from sigmahat.recording.log import Log
from sigmahat.recording.several_joints import of_joint, together
from sigmahat.setup_page import edits
from sigmahat.setup_page.edits import BY_SCALE, OF_PORT

if TYPE_CHECKING:
    from sigmahat.checks.findings import Checked
    from sigmahat.guess.ports import PortGuess
    from sigmahat.result.curve_of_log import Answer

Chosen = Callable[[Mapping[str, str | None]], "Mapping[str, PortGuess]"]
"""Guesses units, signs and gear of columns by port."""


@dataclass(frozen=True)
class Look:
    span: str  # least and greatest value, or why the column has no values
    line: str  # points of SVG in a box of 160 x 28, from its upper left corner


class Setup:
    def __init__(self, log: Log, path: Path) -> None:
        """Starts without a configuration, until start_from() or guessed() is called."""
        self.log = log
        self.path = path  # the file to write
        self.document: tomlkit.TOMLDocument = tomlkit.document()
        self.is_edited = False  # whether edits are not written yet
        self.looks: Mapping[str, Look] = {}  # previews of the columns by name; empty at first
        self.joint = ""  # name of the joint that is shown
        self.busy = "Looking at the columns ..."  # the running computation, in words; else empty
        self.problem = ""  # why the configuration cannot be checked; else empty
        self.checked: Checked | None = None
        self.answer: Answer | None = None
        self.message = ""  # about the last click on a button, or the last value
        self.changed: Callable[[], object] = lambda: None  # called after changes of the document
        self.asks_to_overwrite = False  # whether a question to overwrite the file is open
        self._then: Callable[[], object] | None = None
        self.windows: set[Callable[[], object]] = set()  # functions to call after every change
        self._chosen: Chosen = lambda names: {}
        self.joints: dict[str, tomlkit.TOMLDocument] = {}  # documents by joint; empty at first

    def show(self) -> None:
        for each in list(self.windows):
            each()

    # The configuration

    @property
    def text(self) -> str:
        """The configuration of the joint that the page shows."""
        return tomlkit.dumps(self.document)

    @property
    def text_of_file(self) -> str:
        """The configuration of all joints, in the form for the file."""
        return tomlkit.dumps(together(self.joints, FILL_IN)) if len(self.joints) > 1 else self.text

    @property
    def is_ready(self) -> bool:
        """Whether the state has a configuration to edit."""
        return bool(self.document)

    def start_from(self, document: tomlkit.TOMLDocument) -> None:
        """Takes the contents of the file. Raises LogError for an impossible name of a joint."""
        self._start({name: of_joint(document, name) for name in joints_of(document, self.path)})

    def _start(self, joints: dict[str, tomlkit.TOMLDocument]) -> None:
        self.joints = joints
        self.set_joint(next(iter(joints)))

    def get(self, key: str) -> Any:
        """The value of a key; None if the key is missing, or has to be filled in with a column.

        The unit of a port with a scale is BY_SCALE.
        """
        value = edits.value_of(self.document, key)
        if value is None and key.endswith(".unit") and self.get(f"{key[:-4]}scale") is not None:
            return BY_SCALE
        return None if value == FILL_IN else value

    def set(self, key: str, value: edits.Value | None) -> None:
        """Sets a key; None removes it. The column and the unit of a port also set other keys."""
        if value == self.get(key):
            return
        match key.split("."), value:
            case ["ports", port, "column"], (str() | None):
                self._set_column(port, value)
            case ["ports", port, "unit"], str():
                self._set_unit(port, value)
            case _, None:
                edits.remove_value(self.document, key)
            case _:
                edits.set_value(self.document, key, value)
        self.is_edited, self.message, self.asks_to_overwrite = True, "", False
        self.changed()

    def _set_column(self, port: str, column: str | None) -> None:
        """Gives a port another column, or none; unit, sign, zero and gear are guessed anew."""
        if column is None:
            edits.set_port(self.document, port, None)
        else:
            names = {each: self.get(f"ports.{each}.column") for each in PORTS}
            guessed = self._chosen({**names, port: column}).get(port)
            if guessed is not None:
                from sigmahat.guess.template import port_table

                edits.set_port(self.document, port, port_table(port, guessed))
                self._set_encoder(port, guessed)
            else:
                edits.set_value(self.document, f"ports.{port}.column", column)

    def _set_encoder(self, port: str, guessed: "PortGuess") -> None:
        """Says that a position without counts and steps is exact, as `init` does."""
        if port not in ("theta", "q"):
            return
        if guessed.unit == "counts" or guessed.step is not None:
            edits.remove_value(self.document, f"encoder.{port}")
        else:
            edits.set_value(self.document, f"encoder.{port}", 0)

    def _set_unit(self, port: str, unit: str) -> None:
        """Sets a unit, adds the keys that it needs, and removes keys of the unit before."""
        where = f"ports.{port}"
        before = self.get(f"{where}.unit")
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
        # With the unit counts, the port gives the counts of its encoder; other units do not.
        if unit == "counts":
            edits.remove_value(self.document, f"encoder.{port}")
            edits.remove_value(self.document, f"{where}.step")
        elif before == "counts" and port in ("theta", "q"):
            edits.set_value(self.document, f"encoder.{port}", 0)

    # Results of the jobs

    def guessed(self, templates: Mapping[str, str], chosen: Chosen) -> None:
        """Takes the guesses: the configuration of each joint as `init` writes it."""
        self._chosen = chosen
        if not self.joints:
            self._start({name: tomlkit.parse(text) for name, text in templates.items()})

    def set_joint(self, name: str) -> None:
        if self.document is self.joints[name]:
            return
        self.joint, self.document = name, self.joints[name]
        # Present results and questions belong to the joint before.
        self.message, self.problem, self.asks_to_overwrite = "", "", False
        self.checked = self.answer = None
        self.changed()

    # Files

    @property
    def open_keys(self) -> list[str]:
        return edits.to_fill_in(self.document)

    @property
    def is_on_disk(self) -> bool:
        """Whether the file exists and has the configuration that the page shows."""
        try:
            return self.path.read_text(encoding="utf-8") == self.text_of_file
        except (OSError, ValueError):
            return False

    def write(self, overwrite: bool, then: Callable[[], object] | None = None) -> None:
        """Writes the file; an existing file is overwritten only after a question to the user.

        then  is called when the file is written, also after the question
        """
        if not overwrite:
            self._then = then
        elif not self.asks_to_overwrite:
            return
        self.asks_to_overwrite = self.path.exists() and not (overwrite or self.is_on_disk)
        if self.asks_to_overwrite:
            self.message = f"{self.path} exists, and differs from what is shown here."
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

    def estimated(self, before: str, document: tomlkit.TOMLDocument, folder: Path) -> None:
        """Takes the configuration with which results were written into a folder, and writes it.

        before  the configuration at the start of the job; later edits stay
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
        """Writes unsaved edits into a file of a new name. Returns this file; None without edits."""
        if not self.is_edited:
            return None
        draft, count = self.path.with_suffix(".draft.toml"), 2
        while draft.exists():
            draft, count = self.path.with_suffix(f".draft-{count}.toml"), count + 1
        write_whole(self.text_of_file, draft)
        return draft
