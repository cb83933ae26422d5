"""All joints on line: messages in, estimates out, and a recording of what was received.

A sender that starts again, or a pause of more than a second, ends the recording and begins
another one, with which the estimators go on: as `sigmahat estimate --start-from` does.
"""

from __future__ import annotations

import copy
from collections.abc import Mapping
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
from sigmahat.logs.units import seconds

ARRIVAL = "arrival"
"""Column of a recording for messages without a stamp: time of arrival [ns] since 1970."""


class Session:
    """From a configuration to the estimates of its joints."""

    def __init__(self, config: Path, out: Path, start_from: Path | None = None) -> None:
        """out  folder to write into, which exists

        Raises LogError for what does not fit, FmuError if the FMU refuses a value.
        """
        self._document, self._out = read_document(config), out
        names = joints_of(self._document, config)
        self.joints = [
            LiveJoint(read_configuration(config, name), _learned(start_from, name))
            for name in names
        ]
        self._units = {
            joint.time_column(port): _unit(joint)
            for joint in self.joints
            for port in ("", *joint.ports)
        }
        self.clocks = {name: Clock(seconds(unit)) for name, unit in self._units.items()}
        """Of each time column."""
        ports = [port.port.column for joint in self.joints for port in joint.ports.values()]
        used = dict.fromkeys([*self.clocks, *filter(None, ports)])
        self.columns = [name for name in used if name]
        """Columns of the messages that are used."""
        self.recordings: list[Path] = []
        """Files that are complete."""
        self._recording: Recording | None = None

    def take(self, columns: Columns, arrival: int) -> list[Estimated]:
        """The ticks that a message makes possible, in the order of the joints.

        columns  those of `columns` that are in the message
        arrival  of the message [ns] since 1970
        """
        stamped = {**columns, "": arrival} if "" in self.clocks else columns
        times: dict[str, float] = {}
        kept = dict(columns)
        for name, clock in self.clocks.items():
            if name not in stamped:
                continue
            t = clock.take(stamped[name])
            if t is None and clock.has_restarted:
                ended = self.end_recording()
                for joint in self.joints:
                    joint.go_on()
                return ended + self.take(columns, arrival)
            if t is None:
                kept.pop(name, None)
            else:
                times[name] = t
        if not times:
            return []
        self._record(kept, times, arrival)
        found = (joint.take(columns, times, self.clocks) for joint in self.joints)
        return [each for of_joint in found for each in of_joint]

    def columns_of_times(self) -> dict[str, tuple[float, list[str]]]:
        """Of each time column the seconds of its unit, and the columns whose times it has.

        Without a time column, messages are a period of the estimator apart.
        """
        found: dict[str, tuple[float, list[str]]] = {}
        for joint in self.joints:
            for name, port in joint.ports.items():
                column = joint.time_column(name)
                step = seconds(self._units[column]) if column else joint.T
                found.setdefault(column, (step, []))[1].extend(filter(None, [port.port.column]))
        return found

    def _record(self, columns: Columns, times: Mapping[str, float], arrival: int) -> None:
        if self._recording is None:
            now = datetime.now(timezone.utc).strftime("%Y-%m-%dT%H-%M-%S-%f")
            names = [name or ARRIVAL for name in [*self.clocks, *self.columns]]
            whole = [name or ARRIVAL for name, clock in self.clocks.items() if clock.is_whole]
            path = self._out / f"{now}.parquet"
            self._recording = Recording(path, list(dict.fromkeys(names)), whole)
        if "" in times:
            columns = {**columns, ARRIVAL: arrival}
        self._recording.add(columns)

    def end_recording(self) -> list[Estimated]:
        """Completes the recording, and writes what was learned: the ticks that had to wait.

        Raises OSError if it cannot be written.
        """
        if self._recording is None:
            return []
        recording, self._recording = self._recording, None
        recording.close()
        write_whole(tomlkit.dumps(self._configuration()), recording.path.with_suffix(".toml"))
        self.recordings.append(recording.path)
        digest = sha256(recording.path)
        found = []
        for joint in self.joints:
            found += list(joint.end(self.clocks, recording.path, digest))
            folder = self._out / joint.configuration.joint
            folder.mkdir(exist_ok=True)
            joint.write(folder / LEARNED.file)
        for clock in self.clocks.values():
            clock.restart()
        return found

    def close(self) -> list[Estimated]:
        """Ends the recording and frees the estimators."""
        found = self.end_recording()
        for joint in self.joints:
            joint.close()
        return found

    def _configuration(self) -> tomlkit.TOMLDocument:
        """With which `estimate` does the same with the recording."""
        document = copy.deepcopy(self._document)
        for joint in self.joints:
            section = of_file.section(document, joint.configuration.joint)
            time: dict[str, float | str] = {"longest_gap": joint.longest_gap}
            if not joint.time_column(""):
                time |= {"column": ARRIVAL, "unit": "ns"}
            for key, value in time.items():
                of_file.set_item(section, ("time", key), tomlkit.item(value))
        return document


def _unit(joint: LiveJoint) -> str:
    return joint.configuration.time.unit if joint.configuration.time.column else "ns"


def _learned(start_from: Path | None, joint: str) -> Learned | None:
    if start_from is None:
        return None
    return read_learned(start_from / joint if start_from.is_dir() else start_from)
