"""Ctrl-C, also while a kernel runs: Python itself hears of it between two of its own steps, which may be minutes apart.

A thread is told at once, and waits whether the main thread hears of it too. If not, it removes what is half written and
ends the process.
"""

from __future__ import annotations

import os
import signal
import socket
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType

CODE = 130
"""The exit code, as shells have it."""

GRACE = 1.0
"""Seconds that the main thread has to hear of it."""


@contextmanager
def heard() -> Iterator[None]:
    """While inside, an interruption is a KeyboardInterrupt, or the end of the process `GRACE` later. For the main thread."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    reader, writer = socket.socketpair()
    writer.setblocking(False)
    came = threading.Event()

    def interrupted(number: int, frame: FrameType | None) -> None:
        came.set()
        raise KeyboardInterrupt

    handler = signal.signal(signal.SIGINT, interrupted)
    before = signal.set_wakeup_fd(writer.fileno(), warn_on_full_buffer=False)
    threading.Thread(target=_watch, args=(reader, came), daemon=True).start()
    try:
        yield
    finally:
        signal.set_wakeup_fd(before)
        signal.signal(signal.SIGINT, handler)
        writer.close()  # which ends the thread


def _watch(reader: socket.socket, came: threading.Event) -> None:
    """Wait for the number of a signal, which is written as soon as it comes."""
    with reader:
        while number := reader.recv(1):
            if number[0] != signal.SIGINT:
                continue
            if not came.wait(GRACE):
                from ibr_ref.io.outputs import remove_unfinished

                remove_unfinished()
                os._exit(CODE)
            came.clear()
