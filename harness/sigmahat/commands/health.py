"""The command that compares the results of many logs."""

from __future__ import annotations

import logging
from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from datetime import datetime, timezone
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

import click

from sigmahat.commands import common

if TYPE_CHECKING:
    from sigmahat.health.logs import JointLogs
    from sigmahat.health.quantities import Name
    from sigmahat.health.read import Results

PAGE = "health.html"
_QUANTITIES = ("stiffness", "backlash", "hysteresis", "coulomb", "viscous", "load")
_CHANGED = 1  # exit status


@common.command("health sigmahat-results --limit stiffness=-10%")
@click.argument("folders", metavar="FOLDER...", nargs=-1, required=True, type=common.PATH)
@click.option(
    "--config",
    type=common.FILE,
    help="Estimate the logs in the folders first, with this configuration.",
)
@click.option(
    "--limit",
    "limits",
    multiple=True,
    type=common.ChangeLimit(*_QUANTITIES),
    help="A change since the first logs that is too much, such as stiffness=-10% or "
    "backlash=+0.5mrad.",
)
@click.option(
    "--since",
    type=click.DateTime(["%Y-%m-%d"]),
    help="Leave out the logs before this day, for example before a repair.",
)
@common.option(
    "--false-alarms",
    type=click.FloatRange(1e-6, 1),
    default=1e-3,
    help="Accepted in 365 logs of a joint.",
)
@common.out_option("Folder for pages, pictures and tables.", "health")
@common.answer_options
def health(
    folders: Sequence[Path],
    config: Path | None,
    limits: Sequence[tuple[str, float]],
    since: datetime | None,
    false_alarms: float,
    out: Path,
) -> int:
    """Say whether joints have changed, from the results of many logs.

    FOLDER has results of `sigmahat estimate`, at any depth, or a table results.jsonl; with
    --config, logs. The command prints a line for each joint. It writes a page (health.html), a
    picture of each joint, a table (health.csv), and all results in one file (results.jsonl). Of
    many joints, it draws those that have changed.

    Exit status: 0 no change was found; 1 a joint changed, or a limit is likely passed; 2 error. A
    warning names joints of which a change of the stiffness would not be seen: it cannot be judged,
    or the last three logs or more do not count.
    """
    from sigmahat.files.output import output_folder, write_whole
    from sigmahat.health import output
    from sigmahat.health.judge import judge
    from sigmahat.health.logs import by_joint
    from sigmahat.health.quantities import Name
    from sigmahat.health.read import TABLE, write_table
    from sigmahat.health.text import left_out_in_words, sentence
    from sigmahat.report.from_health import from_health
    from sigmahat.report.page import page

    with common.errors_in_one_line(out):
        _one_for_each(limits)
        found, failures, notes = _results(folders, config, out)
        since = since and since.replace(tzinfo=timezone.utc)
        kept = [each for each in found.results if since is None or each.time >= since]
        of_quantity: dict[Name, float] = {Name[name.upper()]: x for name, x in limits}
        joints = by_joint(kept, _times(failures, config, since))
        if not any(each.used for each in joints):
            raise ValueError(_nothing_left(found, since, joints, notes))
        verdicts = [judge(each, false_alarms, of_quantity) for each in joints]
        with output_folder(out) as folder:
            output.write(verdicts, folder)
            write_table(kept, folder / TABLE)
            write_whole(page(from_health(verdicts, notes), out / PAGE), folder / PAGE)
    lines = [sentence(each) for each in verdicts]
    lines += notes
    lines += [each for v in verdicts for each in left_out_in_words(v)]
    lines.append(f"{PAGE}, pictures and tables are in {out.resolve()}")
    common.answer("\n".join(lines), {**output.values(verdicts), "notes": notes})
    if blind := [each.logs.joint for each in verdicts if not each.is_watched]:
        message = "a change of the stiffness would not be seen: %s"
        logging.getLogger("sigmahat").warning(message, ", ".join(blind))
    return _CHANGED if any(each.is_alarm for each in verdicts) else 0


def _one_for_each(limits: Sequence[tuple[str, float]]) -> None:
    """Raises ValueError for two limits of one quantity."""
    names = [name for name, _ in limits]
    for name in names:
        if names.count(name) > 1:
            raise ValueError(
                f"--limit: expected one limit for {name}, got {names.count(name)}; run `sigmahat "
                "health` again for another one"
            )


@dataclass(frozen=True)
class _Failure:
    """A log that cannot be estimated."""

    log: Path
    joints: Sequence[str]  # of which; "" is the one without a name
    is_whole: bool  # whether these are all joints of the configuration
    reason: str

    def __str__(self) -> str:
        where = "" if self.is_whole else f"joint {', '.join(self.joints)} of "
        reason = self.reason if str(self.log) in self.reason else f"{self.log}: {self.reason}"
        return f"left out: {where}{reason}"


def _times(
    failures: Sequence[_Failure], config: Path | None, since: datetime | None
) -> Mapping[str, Sequence[datetime]]:
    """Returns the times of logs that cannot be estimated, by joint, as far as names say them."""
    from sigmahat.recording.recorded import in_name

    times: dict[str, list[datetime]] = {}
    for each in failures:
        time = in_name(each.log.stem)
        if config is not None and time is not None and (since is None or time >= since):
            for joint in each.joints:
                times.setdefault(joint or config.stem, []).append(time)
    return times


def _results(
    folders: Sequence[Path], config: Path | None, out: Path
) -> tuple[Results, Sequence[_Failure], list[str]]:
    """Reads the results in folders, with a configuration those of their logs. Returns them, the
    logs that cannot be estimated, and notes on all that is left out."""
    from sigmahat.health.read import read_results

    failures, notes = list[_Failure](), list[str]()
    if config is not None:
        folders = [_estimated(folder, config, out, failures, notes) for folder in folders]
        folders = [each for each in folders if each.is_dir()]
        notes = [*map(str, failures), *notes]
        if not folders:
            raise ValueError("no log can be estimated: " + "; ".join(notes))
    found = read_results(folders)
    return found, failures, [*notes, *_not_read(found)]


def _estimated(
    folder: Path, config: Path, out: Path, failures: list[_Failure], notes: list[str]
) -> Path:
    """Estimates each log of a folder that has no result of this configuration yet. Returns the
    folder of the results; adds logs that cannot be estimated, and notes on others."""
    from sigmahat.files.output import sha256
    from sigmahat.health.read import Estimated, estimated
    from sigmahat.recording.configuration import joints_of, read_configuration, read_document

    results = out / "logs" / folder.resolve().name
    logs = [each for each in sorted(folder.iterdir()) if each.suffix in _LOGS]
    if not logs:
        raise ValueError(f"{folder}: expected logs ({', '.join(_LOGS)}), got none")
    joints, configuration = joints_of(read_document(config), config), sha256(config)
    for joint in joints:
        read_configuration(config, joint)  # an error in it is one of all logs
    known = estimated(results)
    with common.progress("Estimating", len(logs)) as bar:
        for log in logs:
            own = sha256(log)
            new = [each for each in joints if Estimated(each, own, configuration) not in known]
            if new:
                failures += _estimate(log, config, results / log.stem, new, joints)
            bar.update(1)
    if all(each.configuration == configuration for each in known):
        return results
    # Some of them may have been estimated again.
    if others := sum(each.configuration != configuration for each in estimated(results)):
        notes.append(
            f"{others} results in {results} are of another configuration than {config}, and their "
            "logs are gone; they count, but what changed may be the configuration: move them away "
            "to leave them out"
        )
    return results


def _estimate(
    log: Path, config: Path, into: Path, new: Sequence[str], joints: Sequence[str]
) -> Iterator[_Failure]:
    """Estimates the joints that are new of a log. Yields which of them are left out, and why."""
    from sigmahat.commands.results import estimated_into

    job = partial(estimated_into, into)
    if len(new) > 1 and list(new) == list(joints):
        with suppress(ValueError):  # then each joint by itself: another one may be as it should be
            common.for_each_joint(log, config, "", job)
            return
    reasons: dict[str, list[str]] = {}
    for joint in new:
        try:
            common.for_each_joint(log, config, joint, job)
        except ValueError as error:
            reasons.setdefault(str(error), []).append(joint)
    for reason, of in reasons.items():
        yield _Failure(log, of, of == list(joints), reason)


def _nothing_left(
    found: Results, since: datetime | None, joints: Sequence[JointLogs], notes: Sequence[str]
) -> str:
    """Says why no result is left to judge."""
    from sigmahat.health.text import doubts_in_words

    if joints:
        return f"no result counts: {next(doubts_in_words(joints[0].left_out))}"
    if since is not None and found.results:
        last = max(each.time for each in found.results)
        return (
            f"--since {since:%Y-%m-%d}: expected a day before the last log, of {last:%Y-%m-%d}; "
            "no log is left"
        )
    return "; ".join(["no result counts", *notes])


_LOGS = (".csv", ".parquet", ".mat", ".h5", ".hdf5", ".mcap", ".db3", ".jsonl")


def _not_read(found: Results) -> list[str]:
    """Sentences on results that do not count."""
    said = [f"left out: {each}" for each in found.unreadable]
    if found.without_time:
        first, more = found.without_time[0], len(found.without_time) - 1
        also = f", and of {more} more" if more else ""
        said.append(
            f"when was the log of {first}{also} recorded? Neither its clock nor its name says: "
            "estimate it again with --recorded 2026-03-02T08:15, or with a date in the name"
        )
    if found.without_interval:
        said.append(
            f"{found.without_interval[0]}: the method gives no intervals; expected "
            'method = "FilteredRegression"'
        )
    return said
