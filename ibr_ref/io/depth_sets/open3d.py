"""A folder as Open3D's reconstruction system reads it: pictures, depth maps, an intrinsic .json, a trajectory .log.

color/ (or image/, rgb/) and depth/, paired in the order of their names. The .json: width, height, and intrinsic_matrix, nine
numbers column after column; Open3D's recordings add depth_scale, the stored units of a metre (1000 without). The .log has
five lines a picture: three numbers, which are not looked at, and the 4 x 4 matrix, camera to world, OpenCV's axes.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ibr_ref.io.depth_sets.conventions import ANY, Conventions, Format, Options
from ibr_ref.io.depth_sets.documents import document, number
from ibr_ref.io.depth_sets.folders import MAPS, PICTURES, first_of, numbered
from ibr_ref.io.depth_sets.text import finite, lines, pinhole
from ibr_ref.io.depth_sets.view import View
from ibr_ref.io.files import naming
from ibr_ref.scene import checks

_COLOR = ("color", "image", "rgb")
_INTRINSICS = ("camera_intrinsic.json", "intrinsic.json", "intrinsics.json")


def _holds(folder: Path) -> bool:
    return first_of(folder, _COLOR) is not None and (folder / "depth").is_dir() and any(folder.glob("*.log"))


def _views(folder: Path, options: Options) -> list[View]:
    place = first_of(folder, _COLOR)
    if place is None:
        raise FileNotFoundError(f"{checks.named(folder)}: found no pictures, allowed: a folder {' | '.join(_COLOR)}")
    color, depth = numbered(place, PICTURES), numbered(folder / "depth", MAPS)
    log = _only(folder, "*.log", "trajectory .log")
    poses = _poses(log)
    if not len(color) == len(depth) == len(poses):
        found = f"{len(color)} pictures, {len(depth)} depth maps and {len(poses)} poses"
        raise ValueError(f"{checks.named(folder)}: found {found}, allowed: as many of each")
    k, size, scale = _intrinsics(folder, options)
    return [
        View(picture.name, f"{log}: pose {i}", picture, map_, k, pose, size=size, depth_scale=scale)
        for i, (picture, map_, pose) in enumerate(zip(color, depth, poses, strict=True))
    ]


def _only(folder: Path, pattern: str, kind: str) -> Path:
    found = sorted(folder.glob(pattern))
    if len(found) != 1:
        names = checks.one_line(", ".join(path.name for path in found)) or "none"
        raise ValueError(f"{checks.named(folder)}: found {names}, allowed: one {kind}")
    return found[0]


def _poses(path: Path) -> list[NDArray[np.float64]]:
    with naming(path):
        rows = list(lines(path))
        if len(rows) % 5:
            raise ValueError(f"found {len(rows)} lines, allowed: five a picture, three numbers and a 4 x 4 matrix")
        return [
            np.array([finite(words, 4, f"line {number}") for number, words in rows[start + 1 : start + 5]])
            for start in range(0, len(rows), 5)
        ]


def _intrinsics(folder: Path, options: Options) -> tuple[NDArray[np.float64], tuple[int, int] | None, float | None]:
    if options.intrinsics is not None:
        return pinhole(*options.intrinsics), None, None
    named = [folder / name for name in _INTRINSICS if (folder / name).exists()]
    path = named[0] if named else _only(folder, "*.json", "intrinsic .json, or the option intrinsics")
    tree = document(path)
    with naming(path):
        numbers: Any = tree.get("intrinsic_matrix")
        if not isinstance(numbers, list) or len(numbers) != 9:
            raise checks.reject("intrinsic_matrix", numbers, "nine numbers, column after column")
        k = np.array([checks.number(f"intrinsic_matrix[{i}]", value) for i, value in enumerate(numbers)])
        size = [checks.whole(name, tree.get(name), low=1, high=65536) for name in ("width", "height")]
        scale = None if "depth_scale" not in tree else 1.0 / number(tree, "depth_scale", low=1e-9, high=1e9)
        return k.reshape(3, 3).T, (size[0], size[1]), scale


FORMAT = Format(
    "open3d",
    "color/, depth/, an intrinsic .json and a trajectory .log",
    _holds,
    _views,
    Conventions("opencv", "camera_to_world", "axis", "integer", depth_scale=1e-3),
    (*ANY, "intrinsics"),
)
