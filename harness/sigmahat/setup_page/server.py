"""Serves the page on this computer alone, until Ctrl-C."""

import errno
import logging
import os
import secrets
import socket
import tempfile
import threading
import time
import warnings
import webbrowser
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import partial
from pathlib import Path
from typing import Any

import tomlkit
from bokeh.application import Application
from bokeh.application.handlers import FunctionHandler
from bokeh.core.validation import silence
from bokeh.core.validation.warnings import EMPTY_LAYOUT
from bokeh.document import Document
from bokeh.resources import Resources
from bokeh.server.server import BaseServer
from bokeh.server.tornado import BokehTornado
from bokeh.server.util import bind_sockets
from bokeh.util.warnings import BokehUserWarning
from tornado.httpserver import HTTPServer
from tornado.ioloop import IOLoop

from sigmahat.fmi.interrupts import ENDS, handling
from sigmahat.recording.log import Log
from sigmahat.setup_page.background import Jobs
from sigmahat.setup_page.setup import Setup
from sigmahat.setup_page.window import Window

_HOST = "127.0.0.1"
_RETRY = 0.1  # [s] until a connection is accepted again, without file handles


class _Small(BokehTornado):  # type: ignore[misc] # types of Bokeh are not checked
    """Serves only the parts of BokehJS that the page uses, so it loads in half of the time."""

    def resources(self, absolute_url: str | bool | None = None) -> Resources:
        found = super().resources(absolute_url)
        found.components = ["bokeh", "bokeh-widgets"]
        return found


def serve(
    log: Log,
    path: Path,
    document: tomlkit.TOMLDocument | None,
    port: int,
    say: Callable[[str], object],
) -> Path | None:
    """Serves the page of a log, and opens it in the browser.

    Anybody with the address can use the page. The address contains a random token. A page of
    another origin cannot connect to this page.

    path      the file to write
    document  contents of the file, to start from; None: the guess of `init`
    port      0 for any free port
    say       is called with messages for the user

    Returns the file with edits that were not written, after Ctrl-C. Raises ValueError if the port
    is in use.
    """
    setup = Setup(log, path)
    jobs = Jobs(setup, IOLoop.current().add_callback)
    token = secrets.token_urlsafe(16)
    server, port = _listen(
        token, port, lambda window: Window(setup, window, jobs.start, jobs.estimate)
    )
    address = f"http://{_HOST}:{port}/{token}"
    with handling(lambda *_: server.io_loop.add_callback_from_signal(server.io_loop.stop), *ENDS):
        server.start()
        if document is not None:
            setup.start_from(document)
        say(f"{log.path} is open until you press Ctrl-C. Address:\n{address}")
        with _link(address, path.parent) as link:
            threading.Thread(target=partial(_open, link, say), daemon=True).start()
            server.io_loop.start()
    server.stop()
    return setup.write_draft()


def _listen(token: str, port: int, window: Callable[[Document], object]) -> tuple[BaseServer, int]:
    """Starts a server and returns its port; `window` fills the document of each window."""
    # No messages about other requests of browsers, and about windows that close.
    for name in ("tornado.access", "bokeh.server.views"):
        logging.getLogger(name).setLevel(logging.ERROR)
    silence(EMPTY_LAYOUT)  # at first, the page has no checks and no curve
    # A browser may refer to a plot that was replaced meanwhile.
    warnings.filterwarnings("ignore", "reference already known", BokehUserWarning)
    try:
        sockets, port = bind_sockets(_HOST, port)
    except OSError as error:
        reason = error.strerror or error
        raise ValueError(
            f"port {port} cannot be used ({reason}); omit --port to use a free port"
        ) from error
    tornado = _Small(
        {f"/{token}": Application(FunctionHandler(window))},
        extra_websocket_origins=[f"{_HOST}:{port}"],
        use_index=False,
    )
    http = HTTPServer(tornado)
    listening = [_Listening(fileno=each.detach()) for each in sockets]
    for each in listening:
        each.setblocking(False)
    http.add_sockets(listening)
    return BaseServer(IOLoop.current(), tornado, http), port


class _Listening(socket.socket):
    """A socket whose connections wait while the process has no file handle for them.

    The event loop would ask for them again and again, and log each time that it gets none.
    """

    def accept(self) -> tuple[socket.socket, Any]:
        try:
            return super().accept()
        except OSError as error:
            if error.errno not in (errno.EMFILE, errno.ENFILE):
                raise
            time.sleep(_RETRY)
            raise BlockingIOError from error


@contextmanager
def _link(address: str, folder: Path) -> Iterator[str]:
    """Yields the address of a file that leads a browser to an address, until the end of the block.

    Other users of this computer see the arguments of a browser, and must not see the token. They
    cannot read the file. It is in the folder of the user's files, because some browsers may read no
    others. Yields "" if the folder cannot be written to.
    """
    try:
        handle, name = tempfile.mkstemp(".html", "sigmahat-open-", folder)
    except OSError:
        yield ""
        return
    try:
        with os.fdopen(handle, "w", encoding="utf-8") as file:
            file.write(f'<meta http-equiv="refresh" content="0; url={address}">\n')
        yield Path(name).absolute().as_uri()
    finally:
        Path(name).unlink(missing_ok=True)


def _open(link: str, say: Callable[[str], object]) -> None:
    if not link or not webbrowser.open(link):
        say("No browser was opened: open the address in a browser on this computer.")
