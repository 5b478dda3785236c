"""transforms.json of instant-ngp (Müller et al. 2022) and nerfstudio (Tancik et al. 2023).

A document of `frames`, each with file_path, depth_file_path (nerfstudio) or depth_path (instant-ngp) and transform_matrix,
4 x 4, camera to world, OpenGL's axes; and, in the frame or for all of them, fl_x, fl_y, cx, cy, w, h, or camera_angle_x and
camera_angle_y, radians. Pixels' centres are half-integers. integer_depth_scale (instant-ngp) is the world units of a stored
whole number, depth_unit_scale_factor of any; without either, whole numbers need depth_scale (0.001 is nerfstudio's own
default, for floats too). applied_scale, by which nerfstudio has scaled the poses, scales the depths. skew, near and far are
what `write_depth_set` adds.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ibr_ref.io.depth_sets.conventions import ANY, Conventions, Format, Options
from ibr_ref.io.depth_sets.documents import document, number
from ibr_ref.io.depth_sets.text import pinhole
from ibr_ref.io.depth_sets.view import View
from ibr_ref.io.files import naming
from ibr_ref.io.inside import file_inside
from ibr_ref.scene import checks
from ibr_ref.scene.trigonometry import sine_cosine

NAME = "transforms.json"

_MODELS = ("OPENCV", "PINHOLE", "SIMPLE_PINHOLE", "OPENCV_FISHEYE", "SIMPLE_RADIAL", "RADIAL", "FULL_OPENCV")
"""Of a camera: pinholes, if all that bends is 0."""
_BENDS = ("k1", "k2", "k3", "k4", "k5", "k6", "p1", "p2")
_OTHER_LENSES = ("is_fisheye", "ftheta_p0", "latlong", "equirectangular", "orthographic")
"""Of instant-ngp: no pinholes."""
_NUMBERS = ("fl_x", "fl_y", "cx", "cy", "w", "h", "camera_angle_x", "camera_angle_y", "skew")
_OF_A_CAMERA = (*_NUMBERS, "camera_model", *_BENDS, *_OTHER_LENSES)
_FACTORS = ("integer_depth_scale", "depth_unit_scale_factor", "applied_scale")
_MOST = 1e9


def _holds(folder: Path) -> bool:
    return (folder / NAME).exists()


def _views(folder: Path, options: Options) -> list[View]:
    path = folder / NAME
    tree = document(path)
    with naming(path):
        frames = tree.get("frames")
        if not isinstance(frames, list) or not frames:
            raise checks.reject("frames", frames, "a list of at least one")
        whole, every, applied = (_factor(tree, name) for name in _FACTORS)
        if whole is not None and every is not None:
            raise checks.reject("depth_unit_scale_factor", every, "None beside integer_depth_scale")
        shared = {name: tree[name] for name in _OF_A_CAMERA if name in tree}
    result = []
    for i, frame in enumerate(frames):
        where = f"{path}: frames[{i}]"
        with naming(where):
            if not isinstance(frame, dict):
                raise ValueError(f"found a {type(frame).__name__}, allowed: an object")
            view = _view(folder, where, {**shared, **frame})
            scale = whole if every is None else every
            result.append(view._replace(depth_scale=scale, scales_floats=every is not None, unit=applied or 1.0))
    return result


def _view(folder: Path, where: str, frame: dict[str, Any]) -> View:
    color = _file(folder, "file_path", frame.get("file_path"))
    if not color.suffix:
        color = color.with_name(color.name + ".png")  # as instant-ngp has it
    name = next((name for name in ("depth_file_path", "depth_path") if frame.get(name) is not None), None)
    depth = None if name is None else _file(folder, name, frame[name])
    k, size = _intrinsics(frame)
    planes = None
    if "near" in frame and "far" in frame:
        planes = number(frame, "near", low=1e-12, high=_MOST), number(frame, "far", low=1e-12, high=_MOST)
    matrix = np.eye(4)
    rows = frame.get("transform_matrix")
    if not isinstance(rows, list) or len(rows) not in (3, 4):
        raise checks.reject("transform_matrix", rows, "four rows of four numbers")
    matrix[: len(rows)] = checks.matrix("transform_matrix", rows, len(rows), 4)
    return View(str(color.relative_to(folder)), where, color, depth, k, matrix, size=size, planes=planes)


def _factor(tree: dict[str, Any], name: str) -> float | None:
    return number(tree, name, low=1e-12, high=_MOST) if name in tree else None


def _file(folder: Path, field: str, name: object) -> Path:
    if not isinstance(name, str) or not name:
        raise checks.reject(field, name, "the name of a file")
    return file_inside(field, folder, name)


def _intrinsics(frame: dict[str, Any]) -> tuple[NDArray[np.float64], tuple[int, int] | None]:
    if "camera_model" in frame:
        checks.choice("camera_model", frame["camera_model"], _MODELS)
    for name in _BENDS:
        if frame.get(name) is not None and checks.number(name, frame[name]) != 0.0:
            allowed = "0: pictures without distortion (nerfstudio's ns-process-data and COLMAP undistort)"
            raise checks.reject(name, frame[name], allowed)
    lens = next((name for name in _OTHER_LENSES if frame.get(name)), None)
    if lens is not None or frame.get("camera_model") == "OPENCV_FISHEYE":
        name = lens or "camera_model"
        raise checks.reject(name, frame[name], "a pinhole: pictures without distortion")
    size = _size(frame)
    f_x = _focal(frame, "fl_x", "camera_angle_x", None if size is None else size[0])
    f_y = _focal(frame, "fl_y", "camera_angle_y", None if size is None else size[1], f_x)
    c_x, c_y = (_center(frame, name, None if size is None else size[axis]) for axis, name in enumerate(("cx", "cy")))
    skew = number(frame, "skew", low=-_MOST, high=_MOST) if "skew" in frame else 0.0
    return pinhole(f_x, f_y, c_x, c_y, skew), size


def _size(frame: dict[str, Any]) -> tuple[int, int] | None:
    if "w" not in frame and "h" not in frame:
        return None
    width, height = (checks.whole(name, frame.get(name), low=1, high=65536) for name in ("w", "h"))
    return width, height


def _focal(frame: dict[str, Any], name: str, angle: str, pixels: int | None, other: float | None = None) -> float:
    """A focal length: given, from the field of view, or that of the other axis."""
    if name in frame:
        return number(frame, name, low=1e-9, high=_MOST)
    if angle in frame:
        if pixels is None:
            raise checks.reject("w and h", None, f"the size of the pictures, which {angle} is about")
        sine, cosine = sine_cosine(number(frame, angle, low=1e-6, high=3.14) / 2.0)
        return 0.5 * pixels * cosine / sine
    if other is None:
        raise checks.reject(name, None, f"a number of pixels, or {angle}")
    return other


def _center(frame: dict[str, Any], name: str, pixels: int | None) -> float:
    """Of the picture, if it is not given."""
    if name in frame:
        return number(frame, name, low=-_MOST, high=_MOST)
    if pixels is None:
        raise checks.reject(name, None, "a number of pixels, or w and h")
    return 0.5 * pixels


FORMAT = Format(
    "transforms",
    NAME,
    _holds,
    _views,
    Conventions("opengl", "camera_to_world", "axis", "half"),
    ANY,
)
