"""Runs the estimators of all joints on line, and records the messages.

A sender that starts again, or a pause of more than a second, ends the recording. The estimators
continue with another recording, as `sigmahat estimate --start-from` does.
"""

import copy
from datetime import datetime, timezone
from pathlib import Path

import tomlkit

from sigmahat.live.clock import Clock
from sigmahat.live.events import NotWritten, SenderRestarted
from sigmahat.live.limits import Limits
from sigmahat.live.live_joint import LiveJoint, News
from sigmahat.live.messages import Columns
from sigmahat.live.recording import Recording
from sigmahat.recording import several_joints as of_file
from sigmahat.recording.configuration import joints_of, read_configuration, read_document
from sigmahat.result.learned import LEARNED, read_learned, state_of

ARRIVAL = "arrival"  # column for messages without a stamp: time of arrival [ns] since 1970
_MOST = 100  # recordings; a sender can start again as often as it likes


class Session:
    """The joints of a configuration, with their estimators and their recording."""

    def __init__(
        self,
        config: Path,
        out: Path,
        start_from: Path | None = None,
        limits: Limits | None = None,
    ) -> None:
        """out  folder to write into, which exists

        Raises LogError for settings that do not fit.
        """
        self._document, self._out = read_document(config), out
        self.clocks: dict[str, Clock] = {}  # clocks by time column; "" for the time of arrival
        self.joints: list[LiveJoint] = []
        for name in joints_of(self._document, config):
            learned = read_learned(state_of(start_from, name)) if start_from else None
            configuration = read_configuration(config, name)
            self.joints.append(LiveJoint(configuration, self.clocks, learned, limits))
        ports = [port.port.column for joint in self.joints for port in joint.ports.values()]
        self.columns = [name for name in dict.fromkeys([*self.clocks, *ports]) if name]
        """Columns of the messages that are used."""
        self.recordings: list[Path] = []  # files of recordings that have ended
        self.not_written: dict[str, str] = {}  # files that are incomplete, and why
        self._is_running = False  # whether samples have arrived since the last restart
        self._recording: Recording | None = None

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
        told = [] if self._is_running else self._begin_recording()
        if self._recording is not None:
            self._recording.add({**kept, ARRIVAL: arrival} if "" in times else kept)
        told += self.save()
        return [*told, *(each for joint in self.joints for each in joint.take(columns, times))]

    def save(self) -> list[News]:
        """Writes the messages of the last second to the recording, if it is over.

        To be called also while no message arrives. Returns an event if the recording has to end.
        """
        if self._recording is None:
            return []
        try:
            self._recording.save()
        except OSError as error:
            return [self._failed(self._recording.path, error)]
        return []

    def close(self) -> list[News]:
        return self._end_recording()

    def _begin_recording(self) -> list[News]:
        self._is_running = True
        if len(self.recordings) == _MOST:
            what, reason = "further recordings", f"the sender has started again {_MOST} times"
            return [] if what in self.not_written else [self._not_written(what, reason)]
        now = datetime.now(timezone.utc).strftime("%Y-%m-%dT%H-%M-%S-%f")
        kinds = {name or ARRIVAL: bool(clock.shift) for name, clock in self.clocks.items()}
        kinds |= {name: False for name in self.columns if name not in kinds}
        configuration = tomlkit.dumps(self._configuration())
        self._recording = Recording(self._out / f"{now}.csv", kinds, configuration)
        return []

    def _end_recording(self) -> list[News]:
        """Completes the recording, writes estimator states, and returns the remaining news."""
        if not self._is_running:
            return []
        self._is_running = False
        found: list[News] = []
        recording, self._recording = self._recording, None
        recorded = None
        if recording is not None:
            try:
                recording.close()
            except OSError as error:
                found.append(self._failed(recording.path, error))
            self.recordings.append(recording.path)
            recorded = recording.path, recording.digest
        for joint in self.joints:
            found += joint.end(recorded)
            file = self._out / joint.configuration.joint / LEARNED.file
            try:
                file.parent.mkdir(exist_ok=True)
                joint.write_learned(file)
            except OSError as error:
                found.append(self._failed(file, error))
        for clock in self.clocks.values():
            clock.restart()
        return found

    def _failed(self, file: Path, error: OSError) -> NotWritten:
        return self._not_written(str(file), error.strerror or str(error))

    def _not_written(self, what: str, reason: str) -> NotWritten:
        self.not_written[what] = reason
        t = max(clock.last for clock in self.clocks.values())
        return NotWritten(t=t, what=what, reason=reason)

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
