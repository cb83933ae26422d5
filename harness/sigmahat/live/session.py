"""Runs the estimators of all joints on line, and records the messages.

A sender that starts again, or a pause of more than a second, ends the recording. The estimators
continue with another recording, as `sigmahat estimate --start-from` does.
"""

import copy
import math
from collections.abc import Mapping
from concurrent.futures import Future, ThreadPoolExecutor
from datetime import datetime, timezone
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import tomlkit
from numpy.typing import NDArray

from sigmahat.files.output import sha256, write_whole
from sigmahat.live.clock import Clock
from sigmahat.live.events import SenderRestarted
from sigmahat.live.live_joint import LiveJoint, News
from sigmahat.live.messages import Columns
from sigmahat.recording import several_joints as of_file
from sigmahat.recording.configuration import joints_of, read_configuration, read_document
from sigmahat.result.learned import LEARNED, read_learned

ARRIVAL = "arrival"  # column for messages without a stamp: time of arrival [ns] since 1970
_ROWS = 1 << 16  # rows of a row group; each group needs 20 kB of memory until the file ends
_MISSING = -(2**63)

# With the first array, pyarrow imports an installed pandas. No sample should wait for this import.
pa.array(np.empty(0))


class _Recording:
    """A Parquet file with a row for each message; missing values are empty."""

    def __init__(self, path: Path, columns: Mapping[str, bool]) -> None:
        """Makes the file, which is complete after close(). Raises OSError if it cannot be written.

        columns  for each column, whether it has integers that a float64 does not hold
        """
        self.path = path
        self._missing = {n: _MISSING if whole else math.nan for n, whole in columns.items()}
        self._kinds = np.dtype([(n, "i8" if whole else "f8") for n, whole in columns.items()])
        kinds = [(n, pa.int64() if whole else pa.float64()) for n, whole in columns.items()]
        self._writer = pq.ParquetWriter(path, pa.schema(kinds))
        self._thread = ThreadPoolExecutor(1)  # so that no sample waits for the disk
        self._written: Future[Any] = self._thread.submit(dict)  # the last job, done at once
        self._rows, self._table = 0, np.empty(_ROWS, self._kinds)

    def add(self, row: Columns) -> None:
        """Adds the next message. Raises OSError if an earlier message could not be written."""
        self._table[self._rows] = tuple(row.get(n, none) for n, none in self._missing.items())
        self._rows += 1
        if self._rows == _ROWS:
            self._flush()

    def close(self) -> None:
        self._flush()
        self._thread.shutdown()
        self._written.result()
        self._writer.close()

    def _flush(self) -> None:
        self._written.result()
        self._written = self._thread.submit(self._write, self._table[: self._rows])
        self._rows, self._table = 0, np.empty(_ROWS, self._kinds)

    def _write(self, table: NDArray[Any]) -> None:
        columns = {n: np.ascontiguousarray(table[n]) for n in self._missing}
        arrays = [pa.array(each, mask=each == self._missing[n]) for n, each in columns.items()]
        self._writer.write_table(pa.Table.from_arrays(arrays, schema=self._writer.schema))


class Session:
    """The joints of a configuration, with their estimators and their recording."""

    def __init__(self, config: Path, out: Path, start_from: Path | None = None) -> None:
        """out  folder to write into, which exists

        Raises LogError for settings that do not fit.
        """
        self._document, self._out = read_document(config), out
        self.clocks: dict[str, Clock] = {}  # clocks by time column; "" for the time of arrival
        self.joints: list[LiveJoint] = []
        for name in joints_of(self._document, config):
            state = start_from / name if start_from and start_from.is_dir() else start_from
            learned = read_learned(state) if state else None
            self.joints.append(LiveJoint(read_configuration(config, name), self.clocks, learned))
        ports = [port.port.column for joint in self.joints for port in joint.ports.values()]
        self.columns = [name for name in dict.fromkeys([*self.clocks, *ports]) if name]
        """Columns of the messages that are used."""
        self.recordings: list[Path] = []  # complete files of recordings
        self._recording: _Recording | None = None

    def take(self, columns: Columns, arrival: int) -> list[News]:
        """Computes the estimates at all ticks that a message allows, in the order of the joints.

        Also returns what happened: a restart of the sender, changes of the stiffness.

        columns  values of the message, by the names in self.columns
        arrival  time of arrival of the message [ns] since 1970
        """
        stamped, kept = {**columns, "": arrival}, dict(columns)
        times: dict[str, float] = {}
        for name, clock in self.clocks.items():
            if name not in stamped:
                continue
            t = clock.take(stamped[name])
            if t is not None:
                times[name] = t
            elif clock.has_restarted:
                restarted = SenderRestarted(t=clock.newest, jump=clock.jump)
                ended = self._end_recording()
                for joint in self.joints:
                    joint.go_on()
                return [restarted, *ended, *self.take(columns, arrival)]
            else:
                kept.pop(name, None)
        if not times:
            return []
        if self._recording is None:
            now = datetime.now(timezone.utc).strftime("%Y-%m-%dT%H-%M-%S-%f")
            kinds = {name or ARRIVAL: bool(clock.shift) for name, clock in self.clocks.items()}
            kinds |= {name: False for name in self.columns if name not in kinds}
            self._recording = _Recording(self._out / f"{now}.parquet", kinds)
        self._recording.add({**kept, ARRIVAL: arrival} if "" in times else kept)
        return [each for joint in self.joints for each in joint.take(columns, times)]

    def _end_recording(self) -> list[News]:
        """Completes the recording, writes estimator states, and returns the remaining news.

        Raises OSError if a file cannot be written.
        """
        if self._recording is None:
            return []
        path = self._recording.path
        self._recording.close()
        self._recording = None
        write_whole(tomlkit.dumps(self._configuration()), path.with_suffix(".toml"))
        self.recordings.append(path)
        digest = sha256(path)
        found: list[News] = []
        for joint in self.joints:
            folder = self._out / joint.configuration.joint
            folder.mkdir(exist_ok=True)
            found += joint.end(path, digest, folder / LEARNED.file)
        for clock in self.clocks.values():
            clock.restart()
        return found

    def close(self) -> list[News]:
        return self._end_recording()

    def _configuration(self) -> tomlkit.TOMLDocument:
        """Creates a configuration with which `estimate` repeats the estimates of a recording."""
        document = copy.deepcopy(self._document)
        for joint in self.joints:
            section = of_file.section(document, joint.configuration.joint)
            time: dict[str, float | str] = {"longest_gap": joint.longest_gap}
            if not joint.time_column(""):
                time |= {"column": ARRIVAL, "unit": "ns"}
            for key, value in time.items():
                of_file.set_item(section, ("time", key), tomlkit.item(value))
        return document
