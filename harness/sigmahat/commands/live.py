"""The command that estimates on line."""

from __future__ import annotations

import re
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import click

from sigmahat.commands import common

if TYPE_CHECKING:
    from sigmahat.live.session import Session
    from sigmahat.live.sinks import Sink
    from sigmahat.live.sources import Source
    from sigmahat.live.watch import Counted

_PORT = re.compile(r"(?:(?P<host>[^:]+):)?(?P<port>\d{1,5})")
_LOOPBACK = "127.0.0.1"


@click.command()
@click.argument("config", type=click.Path(path_type=Path, dir_okay=False))
@click.option(
    "--from",
    "source",
    default="udp:9870",
    show_default=True,
    metavar="SOURCE",
    help="udp:PORT, a datagram is a message; tcp:PORT or stdin, a line is one. Messages are JSON "
    "or CSV.",
)
@click.option(
    "--replay", type=click.Path(path_type=Path), help="This log instead, at its own pace."
)
@click.option(
    "--to",
    "targets",
    multiple=True,
    metavar="TARGET",
    help="Send the estimates on: udp:PORT or udp:HOST:PORT, JSON for PlotJuggler. May be repeated.",
)
@click.option(
    "--columns", default="", metavar="A,B,...", help="Columns of CSV without a title line."
)
@click.option(
    "--host",
    default=_LOOPBACK,
    show_default=True,
    help="Address of this computer that others may reach; 0.0.0.0 is each one.",
)
@click.option(
    "--out",
    callback=common.folder,
    help="Folder for the recording and what was learned.  [default: sigmahat-results/CONFIG-live]",
)
@click.option(
    "--start-from",
    type=click.Path(path_type=Path),
    help="Go on from what was learned before: a folder of results, or its state.json.",
)
@common.json_option
@common.quiet_option
def live(
    config: Path,
    source: str,
    replay: Path | None,
    targets: Sequence[str],
    columns: str,
    host: str,
    out: Path | None,
    start_from: Path | None,
) -> None:
    """Estimate on line: messages of a robot in, estimates out, until Ctrl-C.

    CONFIG is that of a log of the robot; its columns are those of the messages. What was received
    is recorded as a log, from which `sigmahat estimate` gets the same estimates.

    \b
    Example: sigmahat live knee.toml --from udp:9870 --to udp:9871
    """
    from sigmahat.files.output import created_folder
    from sigmahat.live.session import Session
    from sigmahat.live.sources import Inbox, start
    from sigmahat.live.watch import watch

    common.need_fmu("StiffnessEstimator")
    out = out or Path("sigmahat-results", f"{config.stem}-live")
    with common.errors_in_one_line(out), created_folder(out):
        session = Session(config, out, start_from)
        inbox = Inbox()
        opened = _source(source, replay, host, columns, session)
        sinks = [_sink(each, host) for each in targets]
        if not common.is_quiet():
            from sigmahat.live.terminal import Terminal

            where = f"the log {replay}" if replay else f"{source} at {host}"
            click.echo(common.printable(_greeting(session, where)), err=True)
            sinks.append(Terminal())
        start(opened, inbox)
        counted = watch(session, inbox, sinks)
    values = _counts(session, counted, inbox.dropped)
    files = [str(each) for each in session.recordings]
    text = ", ".join(f"{count} {what}" for what, count in values.items() if count or what == "read")
    where = f"Nothing was recorded in {out.resolve()}"
    if files:
        where = "\n".join(
            f"sigmahat estimate {each} --config {Path(each).with_suffix('.toml')}" for each in files
        )
        where = f"The state is in {out.resolve()}; the recording is read by\n{where}"
    common.answer(f"messages: {text}\n{where}", {"messages": values, "recordings": files})


def _source(name: str, replay: Path | None, host: str, columns: str, session: Session) -> Source:
    from sigmahat.live import sources
    from sigmahat.live.messages import Decoder
    from sigmahat.logs.readers.formats import open_log

    titles = columns.split(",") if columns else []
    unused = [each for each in session.columns if each not in titles]
    if titles and unused:
        raise click.UsageError(f"--columns lacks {', '.join(unused)}, which the configuration uses")
    if replay is not None:
        return sources.replay(open_log(replay), session)
    if name == "stdin":
        return sources.stdin(Decoder(session.columns, titles))
    kind, _, port = name.partition(":")
    if kind not in ("udp", "tcp"):
        raise click.UsageError(f"--from: expected udp:PORT, tcp:PORT or stdin, got {name!r}")
    address = host, _address(port, host, "--from")[1]
    try:
        if kind == "tcp":
            return sources.tcp(address, session.columns, titles)
        return sources.udp(address, Decoder(session.columns, titles))
    except OSError as error:
        raise click.ClickException(
            f"cannot listen at {host}, {name}: {error.strerror}; name another port, or an address "
            "of this computer with --host"
        ) from error


def _sink(name: str, host: str) -> Sink:
    from sigmahat.live import sinks

    kind, _, rest = name.partition(":")
    if kind != "udp":
        raise click.UsageError(f"--to: expected udp:PORT or udp:HOST:PORT, got {name!r}")
    return sinks.udp(_address(rest, _LOOPBACK, "--to"))


def _address(text: str, host: str, option: str) -> tuple[str, int]:
    found = _PORT.fullmatch(text)
    if found is None or not 0 < int(found["port"]) < 1 << 16:
        raise click.UsageError(f"{option}: expected a port from 1 to 65535, got {text!r}")
    return found["host"] or host, int(found["port"])


def _greeting(session: Session, source: str) -> str:
    """What it waits for, and what it takes as given."""
    lines = [f"Messages from {source}; columns {', '.join(session.columns)}; Ctrl-C ends it"]
    for joint in session.joints:
        name = f"{joint.configuration.joint}: " if joint.configuration.joint else ""
        if not joint.time_column(""):
            lines.append(f"{name}[time] has no column: the time of arrival is taken")
        if joint.configuration.time.longest_gap is None:
            gap = 1e3 * joint.longest_gap
            lines.append(f"{name}time.longest_gap is not set: {gap:g} ms are interpolated at most")
    return "\n".join(lines)


def _counts(session: Session, counted: Counted, dropped: int) -> dict[str, int]:
    clocks, joints = session.clocks.values(), session.joints
    return {
        "read": counted.messages,
        "not readable": counted.wrong,
        "lost in this program": dropped,
        "missing": sum(each.lost for each in clocks),
        "double": sum(each.double for each in clocks),
        "late": sum(each.late for each in clocks),
        "far off in time": sum(each.strays for each in clocks),
        "ticks skipped": sum(joint.skipped_of_all for joint in joints),
        "ticks interpolated": sum(p.interpolated for j in joints for p in j.ports.values()),
    }
