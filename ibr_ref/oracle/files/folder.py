"""Folders that are written completely or not at all, and files that are only looked for inside of one."""

from __future__ import annotations

import os
import shutil
import stat
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from os import PathLike
from pathlib import Path

from ibr_ref.io.outputs import unfinished
from ibr_ref.oracle.files.problem import UnusableError
from ibr_ref.scene.checks import named


def existing_folder(folder: str | PathLike[str]) -> Path:
    """The folder. Raises OSError for what is none."""
    path = Path(folder)
    try:
        mode = path.stat().st_mode
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or "no file's name"
        raise FileNotFoundError(f"{named(path)}: cannot be read ({reason}), a folder is needed") from None
    if not stat.S_ISDIR(mode):
        raise NotADirectoryError(f"{named(path)}: is no folder, one is needed")
    return path


def file_inside(folder: Path, name: str, label: object = None) -> Path:
    """The regular file of that name, which may be a link, but not one that leads out of the folder."""
    path = folder / name
    label = path if label is None else label
    try:
        inside = path.resolve(strict=True).is_relative_to(folder.resolve(strict=True))
        mode = path.stat().st_mode
        if inside and stat.S_ISREG(mode) and not os.access(path, os.R_OK):
            raise PermissionError(13, os.strerror(13))
    except FileNotFoundError:
        raise UnusableError(label, "no such file", "a file") from None
    except (OSError, RuntimeError, ValueError) as error:
        reason = getattr(error, "strerror", None) or "no file's name"
        raise UnusableError(label, f"what cannot be read ({reason})", "a file") from None
    if not inside:
        raise UnusableError(label, "a link that leads out of the folder", "a file in it")
    if not stat.S_ISREG(mode):
        raise UnusableError(label, "a folder" if stat.S_ISDIR(mode) else "a device or a pipe", "a file")
    return path


def small_file(folder: Path, name: str, most: int, label: object = None) -> bytes:
    """All bytes of a document, from 1 to `most`."""
    path = file_inside(folder, name, label)
    size = path.stat().st_size
    if not 0 < size <= most:
        raise UnusableError(path if label is None else label, f"{size} bytes", f"1 to {most}")
    return path.read_bytes()


@contextmanager
def atomic_folder(folder: Path) -> Iterator[Path]:
    """Make a folder under a temporary name beside `folder`; it takes the name, and the place of what is there, at the end.

    A link is followed: what it leads to is made or replaced.

    Missing folders above it are made. Raises OSError with the path where it cannot be made. Whatever ends the block early
    leaves nothing behind but those.
    """
    name, folder = named(folder), Path(os.path.realpath(folder))
    try:
        folder.parent.mkdir(parents=True, exist_ok=True)
        made = Path(tempfile.mkdtemp(prefix=f".{folder.name}.", dir=folder.parent))
        with unfinished(made):
            yield made
            umask = os.umask(0)
            os.umask(umask)
            made.chmod(0o777 & ~umask)
            _take_place(made, folder)
    except OSError as error:
        if error.strerror:
            raise OSError(f"{name}: cannot be written ({error.strerror})") from None
        raise


def _take_place(made: Path, folder: Path) -> None:
    """Rename; what was there is put aside first, comes back if that fails, and is removed if it does not."""
    if not folder.exists():
        made.rename(folder)
        return
    aside = Path(tempfile.mkdtemp(prefix=f".{folder.name}.", dir=folder.parent))
    try:
        folder.rename(aside / "old")
        try:
            made.rename(folder)
        except BaseException:
            (aside / "old").rename(folder)
            raise
    finally:
        shutil.rmtree(aside, ignore_errors=True)
