"""Folders of pictures that belong together."""

from __future__ import annotations

import re
from pathlib import Path

from ibr_ref.scene import checks

PICTURES = (".png", ".jpg", ".jpeg", ".exr")
MAPS = (".png", ".npy", ".exr", ".pfm", ".tif", ".tiff")


def first_of(folder: Path, names: tuple[str, ...]) -> Path | None:
    """The first of the names that is a folder there."""
    return next((folder / name for name in names if (folder / name).is_dir()), None)


def numbered(folder: Path, endings: tuple[str, ...]) -> list[Path]:
    """The files with these endings, in the order of their names, in which 10 comes after 9.

    Raises ValueError where there is none.
    """
    found = [path for path in folder.iterdir() if path.suffix.lower() in endings and not path.name.startswith(".")]
    if not found:
        raise ValueError(f"{checks.named(folder)}: found no file, allowed: files {' | '.join(endings)}")
    return sorted(found, key=lambda path: (_natural(path.stem), path.name))


def by_stem(paths: list[Path]) -> dict[str, Path]:
    """By name without ending. Raises ValueError for two that differ in the ending alone."""
    result = dict[str, Path]()
    for path in paths:
        if path.stem in result:
            raise ValueError(f"{checks.named(path)}: found beside {result[path.stem].name}, allowed: one of them")
        result[path.stem] = path
    return result


def _natural(name: str) -> list[tuple[int, str]]:
    """Numbers by value, all else by letters."""
    parts = re.split(r"([0-9]+)", name)
    return [(int(part[:18]), part) if part.isdigit() and part.isascii() else (-1, part) for part in parts]
