"""Signals: other handlers for a while, and Ctrl-C that waits."""

import signal
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager

ENDS = [getattr(signal, name) for name in ("SIGINT", "SIGTERM", "SIGHUP") if hasattr(signal, name)]
"""Signals that end a program which runs until it is told to; Windows has no SIGHUP."""


@contextmanager
def handling(handler: Callable[..., object], *numbers: int) -> Iterator[None]:
    """Inside the block, the handler is called for these signals. Only for the main thread.

    SIGHUP stays without effect if it was, as under `nohup`.
    """
    hang_up = getattr(signal, "SIGHUP", None)
    if hang_up in numbers and signal.getsignal(hang_up) == signal.SIG_IGN:
        numbers = tuple(number for number in numbers if number != hang_up)
    before = {number: signal.signal(number, handler) for number in numbers}
    try:
        yield
    finally:
        for number, own in before.items():
            signal.signal(number, own)


@contextmanager
def interrupts_wait() -> Iterator[None]:
    """Ctrl-C inside the block has its effect at the end of the block.

    Inside the block, Ctrl-C would be lost, or would leave work half done. The function has no
    effect outside of the main thread: only this thread handles signals.
    """
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    received: list[int] = []
    with handling(lambda number, _: received.append(number), signal.SIGINT):
        yield
    if received:
        signal.raise_signal(signal.SIGINT)
