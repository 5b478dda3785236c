"""Files that are read whole, and files that are written completely or not at all."""

from __future__ import annotations

import os
import stat
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from os import PathLike
from pathlib import Path
from typing import BinaryIO, cast

_MAX_BYTES = 2**32
"""Twice the samples of the largest 16-bit image: what is larger is a mistake, not an input."""


def contents(path: str | PathLike[str]) -> bytes:
    """All bytes of a file, at least one.

    Raises OSError or ValueError with the path for a name that does not exist or cannot be read, a folder, a device or
    pipe (which might never end), and a file that is empty or larger than 4 GiB.
    """
    path = Path(path)
    try:
        status = path.stat()
        if stat.S_ISREG(status.st_mode) and 0 < status.st_size <= _MAX_BYTES:
            return path.read_bytes()
    except OSError as error:
        raise type(error)(f"{path}: cannot be read ({error.strerror})") from None
    if stat.S_ISDIR(status.st_mode):
        raise IsADirectoryError(f"{path}: is a folder, a file is needed")
    if not stat.S_ISREG(status.st_mode):
        raise OSError(f"{path}: is a device or a pipe, a file is needed")
    raise ValueError(f"{path}: found {status.st_size} bytes, allowed: 1 to 2^32")


_LONGEST_MESSAGE = 400
"""Characters behind the path: decoders quote what they read."""


@contextmanager
def naming(path: str | PathLike[str]) -> Iterator[None]:
    """Around a decoder: whatever it raises comes out as a ValueError of one line that starts with the path.

    OSError where memory does not suffice.
    """
    try:
        yield
    except MemoryError:
        raise OSError(f"{path}: does not fit in memory") from None
    except (OSError, SyntaxError, ValueError) as error:
        raise ValueError(f"{path}: {_one_line(error)}") from None
    except Exception as error:  # bad data break the decoders of others in any way
        raise ValueError(f"{path}: is damaged ({type(error).__name__} {_one_line(error)})") from None


def _one_line(error: Exception) -> str:
    text = " ".join(str(error).split())
    return text if len(text) <= _LONGEST_MESSAGE else text[: _LONGEST_MESSAGE - 3] + "..."


@contextmanager
def atomic(path: str | PathLike[str]) -> Iterator[BinaryIO]:
    """Write to a temporary file beside `path`, which takes the name only if the block ends well.

    Raises OSError with the path where it cannot be written.
    """
    path = Path(path)
    if os.path.isdir(path):  # Path.is_dir raises for names that are too long
        raise IsADirectoryError(f"{path}: is a folder, a file name is needed")
    if not path.parent.is_dir():
        raise FileNotFoundError(f"{path}: the folder {path.parent} does not exist")
    try:
        handle, name = tempfile.mkstemp(prefix=f".{path.name}.", dir=path.parent)
    except OSError as error:
        raise OSError(f"{path}: cannot be written ({error.strerror})") from None
    try:
        with os.fdopen(handle, "wb") as file:
            yield cast(BinaryIO, file)
        umask = os.umask(0)
        os.umask(umask)
        os.chmod(name, 0o666 & ~umask)
        os.replace(name, path)
    except BaseException as error:
        Path(name).unlink(missing_ok=True)
        if isinstance(error, OSError) and error.strerror:
            # A full disk, say: the system's own message names the temporary file, or none.
            raise OSError(f"{path}: cannot be written ({error.strerror})") from None
        raise


class _TrialOver(Exception):  # noqa: N818, it is no error
    """Ends the trial of `check_writable`."""


def check_writable(path: str | PathLike[str]) -> None:
    """Raise what `atomic` would, before long work; nothing is written."""
    try:
        with atomic(path):
            raise _TrialOver
    except _TrialOver:
        pass
