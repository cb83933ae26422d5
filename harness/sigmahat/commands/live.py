"""The command that estimates on line."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from threading import Thread
from typing import TYPE_CHECKING

import click

from sigmahat.commands import common

if TYPE_CHECKING:
    from sigmahat.live.loop import Inbox
    from sigmahat.live.session import Session


@common.command("live knee.toml --from udp:9870 --to udp:9871")
@click.argument("config", type=common.FILE)
@common.option(
    "--from",
    "source",
    default="udp:9870",
    metavar="SOURCE",
    help="udp:PORT, one message per datagram; tcp:PORT or stdin, one message per line, as JSON or "
    "CSV. ros2: joint states, from the topics that the columns name.",
)
@click.option("--replay", type=common.PATH, help="Recorded log as the source, at its own speed.")
@click.option(
    "--to",
    "targets",
    multiple=True,
    metavar="TARGET",
    help="Send the estimates on: udp:PORT or udp:HOST:PORT, JSON for PlotJuggler; "
    "foxglove[:PORT], a WebSocket; ros2, topics. May be repeated.",
)
@click.option(
    "--columns", default="", metavar="A,B,...", help="Names of the columns, if CSV has no title."
)
@common.option(
    "--host",
    default="127.0.0.1",
    help="Address of this computer to which others may connect; 0.0.0.0 means every address.",
)
@common.out_option("Folder for the recording and the results.", "{config}-live")
@click.option(
    "--start-from",
    type=common.PATH,
    help="Continue an earlier estimation: its folder of results, or the state.json in it.",
)
@click.option(
    "--health",
    "results",
    type=common.PATH,
    help="Results of earlier logs, for --limit: folder of `sigmahat health`, or of `estimate`.",
)
@click.option(
    "--limit",
    type=common.ChangeLimit("stiffness"),
    help="Tell when the stiffness has changed by this since the first logs: stiffness=-10%.",
)
@common.answer_options
def live(
    config: Path,
    source: str,
    replay: Path | None,
    targets: Sequence[str],
    columns: str,
    host: str,
    out: Path,
    start_from: Path | None,
    results: Path | None,
    limit: tuple[str, float] | None,
) -> None:
    """Estimate on line: read messages of a robot and send estimates, until Ctrl-C.

    CONFIG is the configuration of a log of the robot, with the columns of the messages. Messages
    are recorded as a log, from which `sigmahat estimate` computes the same estimates.
    """
    from sigmahat.files.output import created_folder
    from sigmahat.live.endpoints import Endpoints
    from sigmahat.live.limits import Limits
    from sigmahat.live.loop import Inbox, receive, watch
    from sigmahat.live.session import Session
    from sigmahat.live.terminal import terminal

    common.need_fmus("StiffnessEstimator")
    if (results is None) != (limit is None):
        raise click.UsageError("--limit needs --health, the results of earlier logs, and reverse")
    with common.errors_in_one_line(out), created_folder(out):
        limits = Limits.read(results, limit[1]) if results and limit else None
        session, inbox = Session(config, out, start_from, limits), Inbox()
        ends = Endpoints(session, host, out)
        titles = columns.split(",") if columns else []
        opened = ends.source(source, titles) if replay is None else ends.replay(replay)
        sinks = [ends.sink(each) for each in targets]
        name = source if replay is None else f"the log {replay}"
        if not common.is_quiet():
            click.echo(common.printable(_greeting(session, name, targets, host)), err=True)
            sinks.append(terminal())
        Thread(target=receive, args=[opened, inbox], daemon=True).start()
        watch(session, inbox, sinks)
    values = _counts(session, inbox)
    counts = [f"{count} {what}" for what, count in values.items() if count or what == "read"]
    files = session.recordings
    learned = f"What was learned is in {out.resolve()}; the recording is read by"
    lines = [f"messages: {', '.join(counts)}", learned if files else "Nothing was recorded"]
    lines += [f"sigmahat estimate {each} --config {each.with_suffix('.toml')}" for each in files]
    common.answer("\n".join(lines), {"messages": values, "recordings": [str(f) for f in files]})
    if inbox.failure is not None:
        raise click.ClickException(f"the messages from {name} have ended: {inbox.failure}")
    if session.not_written:
        files_and_reasons = [f"{file} ({why})" for file, why in session.not_written.items()]
        raise click.ClickException(f"not written, or only in part: {', '.join(files_and_reasons)}")
    if not inbox.read and inbox.wrong:
        expected = f"JSON, or CSV with the columns {', '.join(session.columns)}"
        raise click.ClickException(
            f"none of {inbox.wrong} messages could be read; expected {expected}. For CSV without a "
            "title line, name its columns with --columns"
        )


def _greeting(session: Session, source: str, targets: Sequence[str], host: str) -> str:
    lines = [f"Messages from {source}; columns {', '.join(session.columns)}; Ctrl-C ends it"]
    opened = [source] if source.startswith(("udp:", "tcp:")) else []
    opened += [each for each in targets if each.startswith("foxglove")]
    if opened and not host.startswith("127."):
        lines.append(f"Open to every computer that can connect to {host}: {', '.join(opened)}")
    for joint in session.joints:
        name = f"{joint.configuration.joint}: " if joint.configuration.joint else ""
        if not joint.time_column(""):
            lines.append(f"{name}[time] has no column: the time of arrival is taken")
        if joint.configuration.time.longest_gap is None:
            gap = 1e3 * joint.longest_gap
            lines.append(f"{name}time.longest_gap is not set: {gap:g} ms are interpolated at most")
    return "\n".join(lines)


def _counts(session: Session, inbox: Inbox) -> dict[str, int]:
    clocks, joints = session.clocks.values(), session.joints
    return {
        "read": inbox.read,
        "not readable": inbox.wrong,
        "lost in this program": inbox.dropped,
        "missing": sum(each.lost for each in clocks),
        "double": sum(each.double for each in clocks),
        "late": sum(each.late for each in clocks),
        "far off in time": sum(each.strays for each in clocks),
        "ticks skipped": sum(joint.skipped_of_all for joint in joints),
        "ticks interpolated": sum(p.interpolated for j in joints for p in j.ports.values()),
    }
