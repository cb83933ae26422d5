"""Records of the runs that are done, in an SQLite file: an interrupted study goes on from them."""

import json
import sqlite3
from pathlib import Path

from sigmahat.experiments.job import Job, Outcome

NAME = "runs.sqlite"
_TABLE = """
PRAGMA locking_mode = EXCLUSIVE;
BEGIN EXCLUSIVE;
CREATE TABLE IF NOT EXISTS runs (run TEXT PRIMARY KEY, rows TEXT);
COMMIT;
"""


class Records:
    """An SQLite file with the rows of all completed runs in a folder.

    A later study with the same run does not repeat it, whatever else its plan has.
    """

    def __init__(self, path: Path) -> None:
        """Opens or creates the file, for one process at a time. Raises sqlite3.DatabaseError."""
        self._path = path
        self._file = sqlite3.connect(path, timeout=0, isolation_level=None)
        try:
            self._file.executescript(_TABLE)
            self._rows = dict(self._file.execute("SELECT * FROM runs"))
        except sqlite3.DatabaseError:
            self._file.close()
            raise

    def outcome(self, job: Job) -> Outcome | None:
        """Returns the outcome of a run; None for a run without a recorded outcome."""
        text = self._rows.get(job.identity)
        return None if text is None else Outcome(json.loads(text))

    def add(self, job: Job, outcome: Outcome) -> None:
        """Writes the outcome of a run immediately, to keep the outcome after an interruption."""
        record = job.identity, json.dumps(outcome.rows)
        self._file.execute("INSERT INTO runs VALUES (?, ?)", record)
        self._rows.update([record])

    def close(self) -> None:
        """Closes the file, and removes it if it has no run."""
        self._file.close()
        if not self._rows:
            self._path.unlink()
