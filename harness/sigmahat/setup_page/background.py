"""Slow jobs in a thread: previews, guess, checks, curve. The page stays responsive meanwhile."""

import logging
from collections.abc import Callable, Mapping
from functools import partial
from pathlib import Path
from queue import SimpleQueue
from threading import Thread

import numpy as np
import tomlkit

from sigmahat.fmi.model import FmuError
from sigmahat.guess import template
from sigmahat.guess.columns import read_columns
from sigmahat.guess.guess import guess, guess_chosen
from sigmahat.recording.log import Log, LogError
from sigmahat.result.replayed_log import Replay
from sigmahat.setup_page.setup import Chosen, Look, Setup

_BUCKETS = 80
_WIDTH, _HEIGHT = 160, 28  # size of the line in a preview


def look(log: Log, name: str) -> Look:
    """The range of a column, and a line through the least and the greatest value of each bucket."""
    try:
        values = log.read(name)
    except LogError:
        return Look("text", "")
    values = values[np.isfinite(values)]
    if not len(values):
        return Look("no number", "")
    low, high = float(values.min()), float(values.max())
    buckets = np.array_split(values, min(_BUCKETS, len(values)))
    ends = np.array([end for part in buckets for end in (part.min(), part.max())])
    x = np.linspace(0, _WIDTH, len(ends))
    y = (_HEIGHT - 2) * (high - ends) / ((high - low) or 1.0) + 1
    points = " ".join(f"{a:.1f},{b:.1f}" for a, b in zip(x, y, strict=True))
    return Look(f"{low:.5g} to {high:.5g}", points)


def guessed(log: Log) -> tuple[Mapping[str, str], Chosen]:
    """The configuration of each joint of a log as `init` writes it, and a function that guesses
    units, signs and gear of chosen columns.
    """
    columns = read_columns(log)
    joints = guess(columns)
    templates = {name: template.write(log, columns, {name: j}) for name, j in joints.items()}
    return templates, partial(guess_chosen, columns)


_REFUSED = (LogError, FmuError, OSError, ValueError)
Later = Callable[[Callable[[], object]], object]  # calls a function in the server's thread


class _OutdatedError(Exception):
    """The configuration was changed while a job for the earlier configuration was running."""


class Jobs:
    """Looks at the log of a setup, then checks each new configuration and computes its curve.

    Only the newest configuration counts; a computation for an older configuration is stopped.
    """

    def __init__(self, setup: Setup, later: Later) -> None:
        self._setup, self._later = setup, later
        self._version = 0
        self._waiting: SimpleQueue[tuple[int | None, Callable[[], object]]] = SimpleQueue()
        self._waiting.put((None, self._look))
        setup.changed = self.wanted
        # The thread must not keep the program alive.
        self._thread = Thread(target=self._run, daemon=True)

    def start(self) -> None:
        if self._thread.ident is None:
            self._thread.start()

    def wanted(self) -> None:
        setup = self._setup
        setup.busy = "Checking ..."
        self._version += 1
        if setup.is_ready:
            job = partial(self._check, self._version, setup.text)
            self._waiting.put((self._version, job))
        setup.show()

    def estimate(self) -> None:
        """Identifies and estimates with the configuration as it is now."""
        setup = self._setup
        setup.busy = "Identifying ..."
        text = setup.text

        def job() -> None:  # its messages are for the version at the time at which it begins
            version = self._version
            self._try(version, partial(self._identify_and_estimate, version, text))

        self._waiting.put((None, job))
        setup.show()

    def _run(self) -> None:
        while True:
            self._try(*self._waiting.get())

    def _try(self, version: int | None, job: Callable[[], object]) -> None:
        """Does a job for a version of the configuration; None: for the log, which can be read."""
        try:
            job()
        except _OutdatedError:
            return
        except Exception as error:  # any: without a message, the page would wait for ever
            problem = str(error).removeprefix(f"{self._setup.path}: ")
            if version is None or not isinstance(error, _REFUSED):
                logging.getLogger("sigmahat").exception("a job of the page failed")
                version, problem = None, f"a fault of sigmahat: {error!r}"
            found = {"problem": problem, "checked": None, "answer": None, "busy": ""}
            self._later(partial(self._show, version, **found))

    def _look(self) -> None:
        setup = self._setup
        looks = {name: look(setup.log, name) for name in setup.log.columns}
        self._later(partial(self._show, None, looks=looks, busy="Guessing ..."))
        found = guessed(setup.log)
        self._later(partial(setup.guessed, *found))

    def _check(self, version: int, text: str) -> None:
        from sigmahat.checks.check import check
        from sigmahat.recording.configuration import checked_configuration

        log, path = self._setup.log, self._setup.path
        done = 0

        def progress(thousandths: int) -> None:
            nonlocal done
            if version != self._version:
                raise _OutdatedError
            if (done + thousandths) // 100 > done // 100:
                percent = (done + thousandths) // 10
                self._later(partial(self._show, version, busy=f"The curve: {percent} % ..."))
            done += thousandths

        progress(0)
        configuration = checked_configuration(tomlkit.parse(text), path)
        checked = check(log, configuration)
        busy = "The curve ..."
        self._later(partial(self._show, version, checked=checked, problem="", busy=busy))
        replay = Replay(log, configuration)
        replay.run(progress=progress)  # an exception in progress ends it
        found = replay.answer()
        self._later(partial(self._show, version, answer=found, busy=""))

    def _identify_and_estimate(self, version: int, text: str) -> None:
        """Writes the results, and gives the setup the configuration with the identified values."""
        from sigmahat.checks.check import check
        from sigmahat.files.output import output_folder
        from sigmahat.motor.identify import identify
        from sigmahat.motor.write import update
        from sigmahat.recording.configuration import checked_configuration
        from sigmahat.result.estimate import estimate

        setup, document = self._setup, tomlkit.parse(text)
        out = Path("sigmahat-results", setup.log.path.stem, setup.joint)
        found = identify(setup.log, checked_configuration(document, setup.path))
        update(document, found)
        self._later(partial(self._show, version, busy="Estimating ..."))
        configuration = checked_configuration(document, setup.path)
        findings = [each.as_dict() for each in check(setup.log, configuration).findings]
        with output_folder(out) as folder:
            estimate(setup.log, configuration, folder, findings=findings)
        self._later(partial(setup.estimated, text, document, out))

    def _show(self, version: int | None, **found: object) -> None:
        """Gives results to the setup, if the results are for its present configuration."""
        if version not in (None, self._version):
            return
        for name, value in found.items():
            setattr(self._setup, name, value)
        self._setup.show()
