"""COLMAP workspaces (Schönberger et al. 2016): a model, text or binary, the pictures, and dense depth maps.

The model, cameras and images as .bin or .txt, lies in the folder, in sparse/ or in sparse/0/; the pictures in images/; the
maps in stereo/depth_maps/NAME.geometric.bin, or .photometric.bin where there are none of the first kind. Poses are world to
camera, OpenCV's axes; pixels' centres are half-integers; depths are in the model's units, along the axis, 0 is nothing.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ibr_ref.io.depth_sets.colmap_model import CAMERA_MODELS, ColmapCamera, read_model
from ibr_ref.io.depth_sets.conventions import Conventions, Format, Options
from ibr_ref.io.depth_sets.text import pinhole, pose_of
from ibr_ref.io.depth_sets.view import View
from ibr_ref.io.files import naming
from ibr_ref.io.inside import file_inside
from ibr_ref.scene import checks

_MODELS = ("", "sparse", "sparse/0")
_KINDS = ("geometric", "photometric")


def _model(folder: Path) -> Path | None:
    places = [folder / name for name in _MODELS]
    return next((p for p in places if any((p / f"cameras{ending}").exists() for ending in (".bin", ".txt"))), None)


def _holds(folder: Path) -> bool:
    return _model(folder) is not None


def _views(folder: Path, options: Options) -> list[View]:
    place = _model(folder)
    if place is None:
        allowed = "cameras.bin or cameras.txt, there or in sparse/ or sparse/0/"
        raise FileNotFoundError(f"{checks.named(folder)}: found no model, allowed: {allowed}")
    cameras, images = read_model(place)
    pictures, maps = folder / "images", folder / "stereo" / "depth_maps"
    result = []
    for image in images:
        where = f"{place}: image {checks.one_line(image.name)}"
        with naming(where):
            camera = cameras.get(image.camera)
            if camera is None:
                raise checks.reject("camera", image.camera, "a camera of the model")
            k = _intrinsics(camera)
            x, y, z, w = (*image.quaternion[1:], image.quaternion[0])
            pose = pose_of([x, y, z, w], image.translation)
            color = file_inside("the name", pictures, image.name)
            depth = next(
                (
                    path
                    for kind in _KINDS
                    if (path := file_inside("the name", maps, f"{image.name}.{kind}.bin")).exists()
                ),
                None,
            )
        result.append(View(image.name, where, color, depth, k, pose, size=camera.size))
    if not result:
        raise ValueError(f"{checks.named(place)}: found no image, allowed: a model with at least one")
    return result


def _intrinsics(camera: ColmapCamera) -> NDArray[np.float64]:
    """Those of a pinhole. Raises ValueError for a camera that bends."""
    model = CAMERA_MODELS[camera.model]
    bends = camera.parameters[model.pinhole :]
    if model.bends or any(bends):
        found = f"{model.name} {camera.parameters}"
        raise checks.reject("camera", found, "a pinhole, as `colmap image_undistorter` makes them")
    if model.pinhole == 3:
        f, c_x, c_y = camera.parameters[:3]
        return pinhole(f, f, c_x, c_y)
    f_x, f_y, c_x, c_y = camera.parameters[:4]
    return pinhole(f_x, f_y, c_x, c_y)


FORMAT = Format(
    "colmap",
    "a model (cameras.bin or .txt, there, in sparse/ or sparse/0/), images/ and stereo/depth_maps/",
    _holds,
    _views,
    Conventions("opencv", "world_to_camera", "axis", "half"),
    ("convention", "poses", "along", "pixel_centers"),
)
