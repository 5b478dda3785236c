"""A folder of one's own: color/, depth/, intrinsics and poses, whose conventions nobody but its owner knows.

color/ (or rgb/, images/) and depth/ hold files of the same names, endings aside. poses/ holds NAME.txt for each, a matrix of
16 or 12 numbers; or poses.txt all of them, in the order of the names. intrinsics.txt holds a matrix of 9, 12 or 16 numbers,
if the option does not. Depths: whole numbers (PNG, NPY) with depth_scale, floats (NPY, EXR, PFM, TIFF) in world units.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ibr_ref.io.depth_sets.conventions import ANY, Conventions, Format, Options
from ibr_ref.io.depth_sets.folders import MAPS, PICTURES, by_stem, first_of, numbered
from ibr_ref.io.depth_sets.text import all_numbers, matrix_file, pinhole
from ibr_ref.io.depth_sets.view import View
from ibr_ref.scene import checks

_COLOR = ("color", "rgb", "images")


def _holds(folder: Path) -> bool:
    return first_of(folder, _COLOR) is not None and (folder / "depth").is_dir()


def _views(folder: Path, options: Options) -> list[View]:
    place = first_of(folder, _COLOR)
    if place is None or not (folder / "depth").is_dir():
        allowed = f"the folders {' | '.join(_COLOR)} and depth"
        raise FileNotFoundError(f"{checks.named(folder)}: found no pictures with depth, allowed: {allowed}")
    color, depth = by_stem(numbered(place, PICTURES)), by_stem(numbered(folder / "depth", MAPS))
    if set(color) != set(depth):
        name = checks.one_line(min(set(color) ^ set(depth)))
        raise ValueError(f"{checks.named(folder)}: found {name} in one of {place.name}/ and depth/, allowed: in both")
    k = _intrinsics(folder, options)
    poses = _poses(folder, list(color))
    return [
        View(path.name, where, path, depth[stem], k, pose)
        for (stem, path), (where, pose) in zip(color.items(), poses, strict=True)
    ]


def _intrinsics(folder: Path, options: Options) -> NDArray[np.float64]:
    if options.intrinsics is not None:
        return pinhole(*options.intrinsics)
    path = folder / "intrinsics.txt"
    if not path.exists():
        allowed = "f_x, f_y, c_x, c_y, pixels"
        raise ValueError(f"{checks.named(folder)}: intrinsics: found None and no intrinsics.txt, allowed: {allowed}")
    return matrix_file(path)[:3, :3]


def _poses(folder: Path, stems: list[str]) -> list[tuple[str, NDArray[np.float64]]]:
    """Where each is from, and the matrix."""
    together = folder / "poses.txt"
    if not together.exists():
        paths = [folder / "poses" / f"{stem}.txt" for stem in stems]
        return [(str(path), matrix_file(path)) for path in paths]
    values = all_numbers(together)
    size = next((size for size in (16, 12) if len(values) == size * len(stems)), None)
    if size is None:
        found = f"{len(values)} numbers for {len(stems)} pictures"
        raise ValueError(f"{checks.named(together)}: found {found}, allowed: 16 a picture, or 12")
    poses = np.tile(np.eye(4), (len(stems), 1, 1))
    poses[:, : size // 4] = np.reshape(values, (len(stems), -1, 4))
    return [(f"{together}: pose {i}", pose) for i, pose in enumerate(poses)]


FORMAT = Format(
    "folder",
    "color/ and depth/, intrinsics.txt, and poses/ or poses.txt",
    _holds,
    _views,
    Conventions(None, None, None, None),
    (*ANY, "intrinsics"),
)
