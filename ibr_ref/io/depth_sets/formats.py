"""The formats that there are, and which one a folder has."""

from __future__ import annotations

import os
from pathlib import Path

from ibr_ref.io.depth_sets import colmap, folder, middlebury, open3d, scannet, transforms, tum
from ibr_ref.io.depth_sets.conventions import Format, Options
from ibr_ref.scene import checks

_KNOWN = (
    open3d.FORMAT,
    tum.FORMAT,
    scannet.FORMAT,
    transforms.FORMAT,
    colmap.FORMAT,
    middlebury.FORMAT,
    folder.FORMAT,
)
FORMATS = {format_.name: format_ for format_ in _KNOWN}
"""By name."""

READ_BY = {name: tuple(f.name for f in FORMATS.values() if name in f.reads) for name in Options._fields}
"""Which formats have a use for an option."""


def format_of(path: Path, name: str | None) -> Format:
    """The format of a folder: the one named, or the only one whose files it has; `folder` is what has no other's."""
    if name is not None:
        checks.choice("format", name, tuple(FORMATS))
    if not os.path.isdir(path):  # Path.is_dir raises for names that are too long
        raise NotADirectoryError(f"{checks.named(path)}: is no folder, one with pictures and depth maps is needed")
    if name is not None:
        return FORMATS[name]
    found = [format_ for format_ in FORMATS.values() if format_.holds(path)]
    if len(found) > 1 and found[-1].name == "folder":
        found.pop()
    if not found:
        wanted = "; ".join(f"{format_.name}: {format_.wants}" for format_ in FORMATS.values())
        raise ValueError(f"{checks.named(path)}: found none of the depth sets that are read, allowed: {wanted}")
    if len(found) > 1:
        names = " | ".join(format_.name for format_ in found)
        raise ValueError(f"{checks.named(path)}: format: found the files of several, allowed: one of {names}")
    return found[0]
