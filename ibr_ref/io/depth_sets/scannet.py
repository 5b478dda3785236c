"""ScanNet (Dai et al. 2017), as its SensReader writes it out.

color/N.jpg, depth/N.png, pose/N.txt (4 x 4, camera to world, OpenCV's axes), intrinsic/intrinsic_color.txt and
intrinsic_depth.txt (4 x 4). 16-bit depths in millimetres; 0 is nothing. A pose of infinities is a lost camera: no view. The
depth camera has its own intrinsics and size; extrinsic_*.txt, if there, must be the unit matrix, as all of the set are.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from ibr_ref.io.depth_sets.conventions import ANY, Conventions, Format, Options
from ibr_ref.io.depth_sets.folders import PICTURES, by_stem, numbered
from ibr_ref.io.depth_sets.text import matrix_file
from ibr_ref.io.depth_sets.view import View
from ibr_ref.scene import checks


def _holds(folder: Path) -> bool:
    return all((folder / name).is_dir() for name in ("color", "depth", "pose", "intrinsic"))


def _views(folder: Path, options: Options) -> list[View]:
    color, depth = (by_stem(numbered(folder / name, PICTURES)) for name in ("color", "depth"))
    intrinsics = {
        name: matrix_file(folder / "intrinsic" / f"intrinsic_{name}.txt")[:3, :3] for name in ("color", "depth")
    }
    for name in ("color", "depth"):
        path = folder / "intrinsic" / f"extrinsic_{name}.txt"
        if path.exists() and not np.array_equal(matrix_file(path), np.eye(4)):
            raise ValueError(f"{checks.named(path)}: found another matrix, allowed: the unit matrix")
    result = []
    for stem, picture in color.items():
        path = folder / "pose" / f"{stem}.txt"
        if stem not in depth or not path.exists():
            missing = f"depth/{stem}.png" if stem not in depth else f"pose/{stem}.txt"
            raise FileNotFoundError(f"{checks.named(picture)}: found no {missing}, allowed: one for each picture")
        pose = matrix_file(path)
        if not np.isinf(pose[:3]).all():
            result.append(
                View(
                    picture.name,
                    str(path),
                    picture,
                    depth[stem],
                    intrinsics["color"],
                    pose,
                    depth_intrinsics=intrinsics["depth"],
                )
            )
    return result


FORMAT = Format(
    "scannet",
    "color/, depth/, pose/ and intrinsic/",
    _holds,
    _views,
    Conventions("opencv", "camera_to_world", "axis", "integer", depth_scale=1e-3),
    ANY,
)
