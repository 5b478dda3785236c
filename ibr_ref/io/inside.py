"""Files that other files name: in their folder or below, and nowhere else."""

from __future__ import annotations

import errno
import re
from pathlib import Path

from ibr_ref.scene import checks


def file_inside(field: str, folder: Path, name: str) -> Path:
    """The path of a file that `field` names.

    Raises ValueError for a name that leads out of the folder, by its steps or by a link.
    """
    steps = re.split(r"[/\\]", name)
    if not steps[0] or ".." in steps or ":" in name or "\0" in name:
        raise checks.reject(field, name[:200], "the name of one file, in the folder of this one or below")
    path = folder / name
    try:
        within = path.resolve().is_relative_to(folder.resolve()) and not _in_a_circle(path)
    except (OSError, RuntimeError):  # a name that is too long; links in a circle, before Python 3.13
        within = False
    if not within:
        raise checks.reject(field, name[:200], "a file in the folder of this one or below, not a link out of it")
    return path


def _in_a_circle(path: Path) -> bool:
    """Whether links lead to each other, which `resolve` says nothing of since Python 3.13."""
    try:
        path.stat()
    except OSError as error:
        return error.errno == errno.ELOOP
    return False
