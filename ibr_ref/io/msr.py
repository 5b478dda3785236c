"""The MSR 3D Video data set (Zitnick et al. 2004): calibrated photographs with depth, of which Lee & Park show Ballet."""

from __future__ import annotations

import os
from collections.abc import Sequence
from os import PathLike
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ibr_ref.io.depth_codes import depth_codes
from ibr_ref.io.files import contents, naming
from ibr_ref.io.textures import read_color
from ibr_ref.scene import Camera, DepthImage, checks

_PREFIX = "calibParams-"
_PLANES = {"breakdancers": (44.0, 120.0), "ballet": (42.0, 130.0)}
"""World Z of the depth codes 255 and 0 by sequence, as its README says. The calibration file does not have them."""
_NUMBERS = 1 + 9 + 2 + 12
"""In the file for each camera: its index, K, two distortion coefficients, [R|t]."""
_MARGIN = 1.05
"""The clip planes lie this much outside the depths: a splat whose centre is just off the picture may reach in."""


class _Calibration(NamedTuple):
    """A camera in the file's own space: left-handed, looking down +z, rows counted from the bottom, centres at integers."""

    intrinsics: NDArray[np.float64]
    rotation: NDArray[np.float64]
    translation: NDArray[np.float64]

    @property
    def world_from_view(self) -> NDArray[np.float64]:
        """(3, 3) inverse of the rotation: adjugate over determinant, as a measured rotation's transpose is not it."""
        a, b, c = self.rotation
        columns = (np.cross(b, c), np.cross(c, a), np.cross(a, b))
        determinant = float(a[0] * columns[0][0] + a[1] * columns[0][1] + a[2] * columns[0][2])
        return np.stack(columns, axis=1) / determinant

    def ray_z(self, column: NDArray[np.float64], row: NDArray[np.float64]) -> NDArray[np.float64]:
        """World Z of the pixels' rays, each as long as its component along the view axis is 1."""
        (f_x, s, c_x), (_, f_y, c_y) = self.intrinsics[:2].tolist()
        y = (row - c_y) / f_y
        x = (column - c_x - s * y) / f_x
        r_x, r_y, r_z = self.world_from_view[2]
        z: NDArray[np.float64] = r_x * x + r_y * y + r_z
        return z

    @property
    def center_z(self) -> float:
        """World Z of the eye."""
        r, t = self.world_from_view[2], self.translation
        return -float(r[0] * t[0] + r[1] * t[1] + r[2] * t[2])


def read_msr(
    folder: str | PathLike[str],
    frame: int = 0,
    cameras: Sequence[int] = (0, 1),
    near: float | None = None,
    far: float | None = None,
) -> tuple[DepthImage, ...]:
    """Read one frame of an MSR 3D Video sequence, as seen by each of the cameras, in their order.

    The folder holds `calibParams-NAME.txt` and, there or in folders `camN` as the data set has them,
    `color-camN-fNNN.jpg` and `depth-camN-fNNN.png`. All pixels are valid.

    near and far: world Z of the depth codes 255 and 0; None: those known for the NAMEs breakdancers (44, 120) and ballet
    (42, 130). A code d is the inverse depth 1/z = d/255 (1/near - 1/far) + 1/far along the *world's* Z axis, so the depth
    of a pixel along its view axis is (z - C_z)/r_z, with the eye C and the pixel's ray r. The file's space is left-handed,
    its cameras look down +z and count rows from the bottom: S = diag(1, 1, -1) takes it to ours, R' = S R S, t' = S t,
    K' = [[f_x, -s, c_x + 1/2], [0, f_y, H - 1/2 - c_y], [0, 0, 1]].

    The cameras' own near and far enclose what near and far span in their pictures, so that none clips what another saw.

    Raises OSError or ValueError, in one line that starts with the file or the argument: for files that are missing,
    unreadable or cut off, a camera that the calibration does not have, a colour image whose size is not its depth's, a
    depth image with unequal channels, near >= far, planes that are neither given nor known, a distortion other than 0.
    """
    frame = checks.whole("frame", frame, low=0, high=999)
    set_ = _described(folder, cameras, near, far)
    return tuple(_depth_image(set_, index, frame) for index in set_.indices)


def read_msr_cameras(
    folder: str | PathLike[str],
    cameras: Sequence[int],
    width: int,
    height: int,
    near: float | None = None,
    far: float | None = None,
) -> tuple[Camera, ...]:
    """Read the cameras alone of an MSR 3D Video sequence, for pictures of width x height: no picture is looked for.

    The calibration does not say how large the pictures are; those that `read_msr` reads do. near, far and errors as there.
    """
    set_ = _described(folder, cameras, near, far)
    return tuple(set_.camera(index, width, height) for index in set_.indices)


def has_msr_picture(folder: str | PathLike[str], frame: int, camera: int) -> bool:
    """Whether a camera's colours and depths of a frame are in the folder: both files, whatever they hold."""
    return all(path.exists() for path in _image_files(Path(folder), camera, frame))


class _Set(NamedTuple):
    """A data set's calibration, and the cameras that are asked for."""

    path: Path
    """Of the calibration file."""
    indices: list[int]
    calibrations: dict[int, _Calibration]
    near: float
    far: float

    def camera(self, index: int, width: int, height: int) -> Camera:
        with naming(f"{self.path}: camera {index}"):
            return _camera(self.calibrations[index], width, height, self.near, self.far)


def _described(folder: str | PathLike[str], cameras: Sequence[int], near: float | None, far: float | None) -> _Set:
    if not isinstance(cameras, Sequence) or not cameras:
        raise checks.reject("cameras", cameras, "a sequence of camera numbers, at least one")
    indices = [checks.whole(f"cameras[{i}]", camera, low=0, high=2**31) for i, camera in enumerate(cameras)]
    path = _calibration_file(Path(folder))
    near, far = _planes(path, near, far)
    data = contents(path)
    with naming(path):
        calibrations = _calibrations(data)
    missing = [index for index in indices if index not in calibrations]
    if missing:
        has = ", ".join(map(str, sorted(calibrations)))
        raise ValueError(f"{checks.named(path)}: found no camera {missing[0]}, allowed: the cameras that it has, {has}")
    return _Set(path, indices, calibrations, near, far)


def _calibration_file(folder: Path) -> Path:
    if not os.path.isdir(folder):  # Path.is_dir raises for names that are too long
        raise NotADirectoryError(f"{checks.named(folder)}: is no folder, one with {_PREFIX}NAME.txt is needed")
    found = sorted(folder.glob(f"{_PREFIX}*.txt"))
    if len(found) != 1:
        names = checks.one_line(", ".join(path.name for path in found)) or "none"
        raise FileNotFoundError(f"{checks.named(folder)}: found {names}, needed: one file {_PREFIX}NAME.txt")
    return found[0]


def _planes(path: Path, near: float | None, far: float | None) -> tuple[float, float]:
    name = path.stem.removeprefix(_PREFIX).lower()
    if (near is None or far is None) and name not in _PLANES:
        known = ", ".join(_PLANES)
        field = "near" if near is None else "far"
        raise ValueError(
            f"{checks.named(path)}: {field}: found None, allowed: a number, or None for the sequences {known}"
        )
    planes = _PLANES.get(name, (0.0, 0.0))
    near = checks.number("near", planes[0] if near is None else near, above=0.0)
    far = checks.number("far", planes[1] if far is None else far)
    if not far > near:
        raise checks.reject("far", far, f"> near = {near:g}")
    return near, far


def _calibrations(data: bytes) -> dict[int, _Calibration]:
    """All cameras of the file; blank lines and line breaks count as spaces do."""
    words = data.decode("utf-8", "replace").split()
    if not words or len(words) % _NUMBERS:
        raise ValueError(f"found {len(words)} numbers, allowed: {_NUMBERS} a camera (index, K, 2 of distortion, [R|t])")
    result: dict[int, _Calibration] = {}
    for start in range(0, len(words), _NUMBERS):
        numbers = [_number(word) for word in words[start : start + _NUMBERS]]
        index = checks.whole("camera", numbers[0], low=0, high=2**31)
        if index in result:
            raise checks.reject("camera", index, "each camera once")
        if any(numbers[10:12]):
            raise checks.reject(f"camera {index}: distortion", numbers[10:12], "0 and 0: pictures without distortion")
        pose = np.reshape(numbers[12:], (3, 4))
        result[index] = _Calibration(np.reshape(numbers[1:10], (3, 3)), pose[:, :3], pose[:, 3])
    return result


def _number(word: str) -> float:
    try:
        return checks.number("calibration", float(word))
    except ValueError:
        raise ValueError(f"found {word[:40]!r}, allowed: finite numbers") from None


def _depth_image(set_: _Set, index: int, frame: int) -> DepthImage:
    color_path, depth_path = _image_files(set_.path.parent, index, frame)
    (codes, last), color = depth_codes(depth_path), read_color(color_path, exif=False)
    height, width = codes.shape
    if color.shape[:2] != codes.shape:
        found = f"{color.shape[1]} x {color.shape[0]} pixels"
        raise ValueError(
            f"{checks.named(color_path)}: found {found}, allowed: {width} x {height}, the size of {depth_path.name}"
        )
    camera, calibration = set_.camera(index, width, height), set_.calibrations[index]
    z = 1.0 / (codes / last * (1.0 / set_.near - 1.0 / set_.far) + 1.0 / set_.far)
    row, column = np.arange(height - 1.0, -1.0, -1.0)[:, None], np.arange(float(width))[None, :]
    depth = (z - calibration.center_z) / calibration.ray_z(column, row)
    return DepthImage(color=color, depth=depth, camera=camera)


def _image_files(folder: Path, index: int, frame: int) -> tuple[Path, Path]:
    """Of the colours and of the depths."""
    ending = f"cam{index}-f{frame:03d}"
    return _image_file(folder, index, f"color-{ending}.jpg"), _image_file(folder, index, f"depth-{ending}.png")


def _image_file(folder: Path, index: int, name: str) -> Path:
    inside = folder / f"cam{index}" / name
    return inside if inside.exists() else folder / name


def _camera(calibration: _Calibration, width: int, height: int, near: float, far: float) -> Camera:
    (f_x, s, c_x), (k_10, f_y, c_y), last = calibration.intrinsics.tolist()
    mirror = np.diag((1.0, 1.0, -1.0))

    def made(near: float, far: float) -> Camera:
        return Camera.calibrated(
            intrinsics=[[f_x, 0.0 - s, c_x + 0.5], [k_10, f_y, height - 0.5 - c_y], last],
            rotation=mirror @ calibration.rotation @ mirror,
            translation=mirror @ calibration.translation,
            near=near,
            far=far,
            width=width,
            height=height,
        )

    made(near, far)  # that the matrices are what they should be, before they divide anything
    corners = np.array([-0.5, width - 0.5]), np.array([-0.5, height - 0.5])
    ray_z = calibration.ray_z(corners[0][None, :], corners[1][:, None])  # linear in the pixel: extremes at the corners
    if not ray_z.min() > 0.0:
        raise checks.reject("rotation", calibration.rotation.tolist(), "a camera that looks towards +Z with all pixels")
    if not near > calibration.center_z:
        raise checks.reject("near", near, f"> {calibration.center_z:g}, the Z of the camera")
    nearest, farthest = (near - calibration.center_z) / ray_z.max(), (far - calibration.center_z) / ray_z.min()
    return made(nearest / _MARGIN, farthest * _MARGIN)
