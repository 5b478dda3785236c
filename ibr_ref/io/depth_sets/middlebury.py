"""Middlebury stereo pairs (Scharstein et al. 2014, 2021): two pictures, their disparities, and calib.txt.

im0.png and im1.png, disp0.pfm and disp1.pfm (disp0GT.pfm in ETH3D's sets of this form), infinite where nothing is known.
calib.txt: cam0, cam1 = [f s c_x; 0 f c_y; 0 0 1], doffs = c_x1 - c_x0 and baseline; its unit, a millimetre, is the world's.
A disparity d is a depth baseline f/(d + doffs). The world is the left camera's; the right one is a baseline to its right.
"""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ibr_ref.io.depth_sets.conventions import Conventions, Format, Options
from ibr_ref.io.depth_sets.text import finite, text
from ibr_ref.io.depth_sets.view import View
from ibr_ref.io.files import naming
from ibr_ref.io.words import shown
from ibr_ref.scene import checks

_MOST_BYTES = 2**16
_NAME = "calib.txt"


def _holds(folder: Path) -> bool:
    return (folder / _NAME).exists()


def _views(folder: Path, options: Options) -> list[View]:
    path = folder / _NAME
    fields = _fields(path)
    with naming(path):
        (baseline,), (doffs,) = (finite(fields.get(name, []), 1, name) for name in ("baseline", "doffs"))
        checks.number("baseline", baseline, above=0.0, high=1e9)
        size = _size(fields)
        cameras = [_camera(fields.get(f"cam{i}", []), f"cam{i}") for i in range(2)]
    result = []
    for i, k in enumerate(cameras):
        color = _first(folder, (f"im{i}.png", f"im{i}.jpg"))
        depth = _first(folder, (f"disp{i}.pfm", f"disp{i}GT.pfm"))
        if color is None:
            raise FileNotFoundError(f"{checks.named(folder)}: found no im{i}.png, allowed: two pictures")
        pose = np.eye(4)
        pose[0, 3] = i * baseline
        disparity = baseline * float(k[0, 0]), doffs
        result.append(View(color.name, str(path), color, depth, k, pose, size=size, disparity=disparity))
    return result


def _fields(path: Path) -> dict[str, list[bytes]]:
    """By name, the words after `=`."""
    with naming(path):
        result = {}
        for line in text(path, _MOST_BYTES).splitlines():
            name, equals, value = line.partition(b"=")
            if equals:
                result[name.strip().decode("latin-1")] = re.split(rb"[\s;\[\]]+", value.strip(b"[] \t\r"))
        return result


def _size(fields: dict[str, list[bytes]]) -> tuple[int, int] | None:
    if "width" not in fields or "height" not in fields:
        return None
    width, height = (checks.whole(n, *finite(fields[n], 1, n), low=1, high=65536) for n in ("width", "height"))
    return width, height


def _camera(words: list[bytes], name: str) -> NDArray[np.float64]:
    k = np.reshape(finite(words, 9, name), (3, 3))
    if not k[0, 0] > 0.0:
        raise ValueError(f"{name}: found {shown(words)}, allowed: a focal length above 0")
    return k


def _first(folder: Path, names: tuple[str, ...]) -> Path | None:
    return next((folder / name for name in names if (folder / name).exists()), None)


FORMAT = Format(
    "middlebury",
    "calib.txt, im0.png, im1.png, disp0.pfm",
    _holds,
    _views,
    Conventions("opencv", "camera_to_world", "axis", "integer"),
    ("pixel_centers",),
)
