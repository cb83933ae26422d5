"""All joints on line: messages in, estimates out, and a recording of the messages.

A sender that starts again, or a pause of more than a second, ends the recording. The estimators
continue with another recording, as `sigmahat estimate --start-from` does.
"""

from __future__ import annotations

import copy
from datetime import datetime, timezone
from pathlib import Path

import tomlkit

from sigmahat.files.output import sha256, write_whole
from sigmahat.live.clock import Clock
from sigmahat.live.joint import Estimated, LiveJoint
from sigmahat.live.messages import Columns
from sigmahat.live.recording import Recording
from sigmahat.logs import joints as of_file
from sigmahat.logs.configuration import joints_of, read_configuration, read_document
from sigmahat.logs.learned import LEARNED, Learned, read_learned

ARRIVAL = "arrival"
"""Column of a recording for messages without a stamp: time of arrival [ns] since 1970."""


class Session:
    """The joints of a configuration, with their estimators and their recording."""

    def __init__(self, config: Path, out: Path, start_from: Path | None = None) -> None:
        """out  folder to write into, which exists

        Raises LogError for settings that do not fit, FmuError if the FMU refuses a value.
        """
        self._document, self._out = read_document(config), out
        self.clocks: dict[str, Clock] = {}
        """Clocks by time column; "" for the time of arrival."""
        self.joints = [
            LiveJoint(read_configuration(config, name), self.clocks, _learned(start_from, name))
            for name in joints_of(self._document, config)
        ]
        ports = [port.port.column for joint in self.joints for port in joint.ports.values()]
        self.columns = [name for name in dict.fromkeys([*self.clocks, *ports]) if name]
        """Columns of the messages that are used."""
        self.recordings: list[Path] = []
        """Complete files of recordings."""
        self._recording: Recording | None = None

    def take(self, columns: Columns, arrival: int) -> list[Estimated]:
        """The ticks that a message makes possible, in the order of the joints.

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
                ended = self._end_recording()
                for joint in self.joints:
                    joint.go_on()
                return ended + self.take(columns, arrival)
            else:
                kept.pop(name, None)
        if not times:
            return []
        if self._recording is None:
            self._recording = self._begin_recording()
        self._recording.add({**kept, ARRIVAL: arrival} if "" in times else kept)
        found = (joint.take(columns, times) for joint in self.joints)
        return [each for of_joint in found for each in of_joint]

    def _begin_recording(self) -> Recording:
        now = datetime.now(timezone.utc).strftime("%Y-%m-%dT%H-%M-%S-%f")
        kinds = {name or ARRIVAL: bool(clock.shift) for name, clock in self.clocks.items()}
        kinds |= {name: False for name in self.columns if name not in kinds}
        return Recording(self._out / f"{now}.parquet", kinds)

    def _end_recording(self) -> list[Estimated]:
        """Completes the recording, and writes what was learned. Returns the ticks that had to wait.

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
        found: list[Estimated] = []
        for joint in self.joints:
            found += joint.end(path, digest)
            folder = self._out / joint.configuration.joint
            folder.mkdir(exist_ok=True)
            joint.write(folder / LEARNED.file)
        for clock in self.clocks.values():
            clock.restart()
        return found

    def close(self) -> list[Estimated]:
        """Ends the recording and frees the estimators."""
        found = self._end_recording()
        for joint in self.joints:
            joint.slave.__exit__()
        return found

    def _configuration(self) -> tomlkit.TOMLDocument:
        """The configuration with which `estimate` repeats the estimates from the recording."""
        document = copy.deepcopy(self._document)
        for joint in self.joints:
            section = of_file.section(document, joint.configuration.joint)
            time: dict[str, float | str] = {"longest_gap": joint.longest_gap}
            if not joint.time_column(""):
                time |= {"column": ARRIVAL, "unit": "ns"}
            for key, value in time.items():
                of_file.set_item(section, ("time", key), tomlkit.item(value))
        return document


def _learned(start_from: Path | None, joint: str) -> Learned | None:
    if start_from is None:
        return None
    return read_learned(start_from / joint if start_from.is_dir() else start_from)
