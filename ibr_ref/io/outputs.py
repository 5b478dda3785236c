"""Files that are written: completely or not at all, at the place that a name stands for.

A symbolic link stands for what it leads to. A pipe, a terminal or another character device, and an open descriptor
(/dev/stdout, /dev/fd/3) are written to; whatever else has the name is replaced.
"""

from __future__ import annotations

import os
import re
import shutil
import stat
import sys
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from os import PathLike
from pathlib import Path
from typing import BinaryIO, cast

from ibr_ref.scene.checks import named

_DESCRIPTORS = re.compile(r"/dev/fd|/proc/(self|[0-9]+)/fd")
_MOST_LINKS = 40
"""As Linux has it."""

_unfinished: set[Path] = set()
"""What is being written, under its temporary name."""


@contextmanager
def unfinished(place: Path) -> Iterator[None]:
    """A file or folder under a temporary name: removed if the block ends early, or the process (`remove_unfinished`)."""
    _unfinished.add(place)
    try:
        yield
    except BaseException:
        _remove(place)
        raise
    finally:
        _unfinished.discard(place)


def remove_unfinished() -> None:
    """Remove all that is half written, by any thread: the process is about to end."""
    for place in list(_unfinished):
        _remove(place)


def _remove(place: Path) -> None:
    if place.is_dir():
        shutil.rmtree(place, ignore_errors=True)
    else:
        place.unlink(missing_ok=True)


@contextmanager
def atomic(path: str | PathLike[str]) -> Iterator[BinaryIO]:
    """Write to a temporary file beside the file that `path` leads to, which takes its name only if the block ends well.

    For a pipe, a device or a descriptor it lies elsewhere, and is copied there then. Raises OSError with the path where it
    cannot be written.
    """
    try:
        descriptor = _descriptor(path)
        if descriptor is not None or is_stream(path):
            with tempfile.TemporaryFile() as file:
                yield cast(BinaryIO, file)
                file.seek(0)
                _copy(cast(BinaryIO, file), path, descriptor)
        else:
            with _beside(_place(path)) as file:
                yield file
    except OSError as error:
        if error.strerror:
            # A full disk, say: the system's own message names the temporary file, or none.
            raise OSError(f"{named(path)}: cannot be written ({error.strerror})") from None
        raise


def check_writable(path: str | PathLike[str]) -> None:
    """Raise what `atomic` would, before long work; nothing is written, and no pipe opened: its reader would see the end."""
    try:
        descriptor = _descriptor(path)
        if descriptor is not None:
            os.fstat(descriptor)
            return
        if is_stream(path):
            if not os.access(path, os.W_OK):
                raise PermissionError(13, os.strerror(13))
            return
    except OSError as error:
        if error.strerror:
            raise OSError(f"{named(path)}: cannot be written ({error.strerror})") from None
        raise
    try:
        with atomic(path):
            raise _TrialOver
    except _TrialOver:
        pass


class _TrialOver(Exception):  # noqa: N818, it is no error
    """Ends the trial of `check_writable`."""


def is_stream(path: str | PathLike[str]) -> bool:
    """Whether the path leads to a pipe or a character device, of which no file can take the place.

    Raises OSError for what cannot be looked at, and for disks and sockets.
    """
    try:
        mode = os.stat(path).st_mode
    except (FileNotFoundError, NotADirectoryError, ValueError):
        return False
    if stat.S_ISBLK(mode) or stat.S_ISSOCK(mode):
        kind = "block device" if stat.S_ISBLK(mode) else "socket"
        raise OSError(f"{named(path)}: is a {kind}, a file, a pipe or a character device is needed")
    return stat.S_ISFIFO(mode) or stat.S_ISCHR(mode)


def make_folder(folder: str | PathLike[str]) -> Path:
    """Make the folder that the path leads to, and those above it, where they are missing; raises OSError with the path."""
    try:
        place = Path(os.path.realpath(folder))
        place.mkdir(parents=True, exist_ok=True)
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or "not a name"
        raise OSError(f"{named(folder)}: cannot be made ({reason}), a folder is needed") from None
    return Path(folder)


def _descriptor(path: str | PathLike[str]) -> int | None:
    """The number of this process's open descriptor that the path leads to, link by link.

    Opened by its name, a file that standard output goes to would be written from its start again, and replaced it would
    be lost to whoever opened it.
    """
    place = os.fspath(path)
    for _ in range(_MOST_LINKS):
        folder, name = os.path.split(place)
        folder = os.path.realpath(folder)
        if name.isdecimal() and _DESCRIPTORS.fullmatch(folder):
            return int(name) if folder in ("/dev/fd", f"/proc/{os.getpid()}/fd") else None
        if not os.path.islink(place):
            return None
        place = os.path.join(folder, os.readlink(place))
    return None


def _place(path: str | PathLike[str]) -> Path:
    """The file that is written: at the end of all links, there or not."""
    try:
        place = Path(os.path.realpath(path))
    except ValueError:
        raise OSError(22, os.strerror(22)) from None  # a zero byte
    if os.path.isdir(place):
        raise IsADirectoryError(f"{named(path)}: is a folder, a file name is needed")
    if not os.path.isdir(place.parent):
        raise FileNotFoundError(f"{named(path)}: the folder {named(place.parent)} does not exist")
    return place


@contextmanager
def _beside(place: Path) -> Iterator[BinaryIO]:
    handle, name = tempfile.mkstemp(prefix=f".{place.name[:60]}.", dir=place.parent)
    with unfinished(Path(name)):
        with os.fdopen(handle, "wb") as file:
            yield cast(BinaryIO, file)
        umask = os.umask(0)
        os.umask(umask)
        os.chmod(name, 0o666 & ~umask)
        os.replace(name, place)


def _copy(file: BinaryIO, path: str | PathLike[str], descriptor: int | None) -> None:
    if descriptor is None:
        target = os.open(path, os.O_WRONLY)
    else:
        sys.stdout.flush()  # what has been printed so far comes first
        target = os.dup(descriptor)
    with os.fdopen(target, "wb") as out:
        shutil.copyfileobj(file, out)
