"""Where `--json` goes: to a file, or with `-` to standard output, which then has nothing else on it."""

from __future__ import annotations

import sys
from pathlib import Path

_STANDARD_OUTPUT = Path("-")


def is_standard_output(path: Path | None) -> bool:
    """Whether everything else has to go to standard error."""
    return path == _STANDARD_OUTPUT


def check_writable(path: Path | None) -> None:
    """Raise OSError where it cannot be written, before long work."""
    if path is not None and not is_standard_output(path):
        from ibr_ref import io

        io.check_writable(path)


def write(path: Path | None, text: str) -> None:
    """Write the text and a line's end, if there is a place for it."""
    if path is None:
        return
    data = (text + "\n").encode("utf-8")
    if is_standard_output(path):
        sys.stdout.flush()
        sys.stdout.buffer.write(data)
        sys.stdout.flush()
        return
    from ibr_ref.io.outputs import atomic

    with atomic(path) as file:
        file.write(data)
