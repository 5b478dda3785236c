"""The reference image of splatting: colours, their depths, and the camera that saw them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ibr_ref.scene import checks
from ibr_ref.scene.camera import Camera


@dataclass(frozen=True, kw_only=True, eq=False)
class DepthImage:
    """A picture whose every pixel inside the mask is a point in space (Lee & Park 2006, section 3.1).

    The point of pixel (column, row) lies on the line of sight through (column + 0.5, row + 0.5). A mask without a pixel
    is allowed: the back of an object may be empty. Arrays are copied and read-only.

    Raises ValueError for colours outside [0, 1], a depth inside the mask that is not finite or not > 0, sizes that
    differ from the colours', a mask that is not true or false, or a camera for pictures of another size.
    """

    color: ArrayLike
    """(H, W, 3), linear, in [0, 1]."""
    depth: ArrayLike
    """(H, W) world units along the view axis, from the plane of the eye: -z of view space, > 0 inside the mask. Stored as
    0 outside, whatever is given there."""
    camera: Camera
    """For pictures of W x H."""
    mask: ArrayLike | None = None
    """(H, W) bool, or numbers 0 and 1: the pixels that are points; the others are background. None: all are, and so it is
    stored."""

    def __post_init__(self) -> None:
        set_field = object.__setattr__
        color = checks.texture("color", self.color, 3)
        height, width = color.shape[:2]
        mask = _mask(self.mask, height, width)
        set_field(self, "color", color)
        set_field(self, "mask", mask)
        set_field(self, "depth", _depth(self.depth, mask))
        if not isinstance(self.camera, Camera):
            raise checks.reject("camera", type(self.camera).__name__, "a Camera")
        if (self.camera.width, self.camera.height) != (width, height):
            found = f"pictures of {self.camera.width} x {self.camera.height}"
            raise checks.reject("camera", found, f"{width} x {height}, the size of color")

    @property
    def arrays(self) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.bool_]]:
        """color, depth and mask as arrays."""
        return np.asarray(self.color), np.asarray(self.depth), np.asarray(self.mask)

    @property
    def points(self) -> NDArray[np.float64]:
        """(N, 3) in world space: those of the pixels inside the mask, row after row."""
        _, depths, mask = self.arrays
        (f_x, skew, c_x), (_, f_y, c_y) = self.camera.intrinsics[:2].tolist()
        rows, columns = np.nonzero(mask)
        depth = depths[mask]
        along = depth if self.camera.perspective else 1.0
        y_n = (rows + 0.5 - c_y) / f_y
        x_n = (columns + 0.5 - c_x - skew * y_n) / f_x
        x, y, z = x_n * along, -y_n * along, -depth
        matrix = self.camera.world_from_view
        return np.stack([row[0] * x + row[1] * y + row[2] * z + row[3] for row in matrix[:3]], axis=1)


def _mask(value: ArrayLike | None, height: int, width: int) -> NDArray[np.bool_]:
    if value is None:
        mask = np.ones((height, width), bool)
    else:
        try:
            given = np.array(value)
        except ValueError:
            raise checks.reject("mask", type(value).__name__, "an array of true and false") from None
        if given.shape != (height, width):
            raise checks.reject("mask.shape", given.shape, f"{(height, width)}, the size of color")
        if given.dtype.kind not in "biuf":
            raise checks.reject("mask.dtype", str(given.dtype), "bool, or numbers 0 and 1")
        mask = given == 1
        bad = ~mask & (given != 0)
        if bad.any():
            row, column = np.argwhere(bad)[0].tolist()
            raise checks.reject(f"mask[{row}, {column}]", given[row, column].item(), "true and false, or 0 and 1")
    mask.setflags(write=False)
    return mask


def _depth(value: ArrayLike, mask: NDArray[np.bool_]) -> NDArray[np.float64]:
    try:
        given = np.asarray(value)
        if given.dtype.kind not in "biuf":
            raise TypeError
        depth = np.array(given, np.float64, order="C")
    except (TypeError, ValueError):
        raise checks.reject("depth", type(value).__name__, "an array (H, W) of numbers") from None
    if depth.shape != mask.shape:
        raise checks.reject("depth.shape", depth.shape, f"{mask.shape}, the size of color")
    bad = mask & ~((depth > 0.0) & (depth < np.inf))
    if bad.any():
        row, column = np.argwhere(bad)[0].tolist()
        raise checks.reject(f"depth[{row}, {column}]", float(depth[row, column]), "finite numbers > 0 inside the mask")
    depth[~mask] = 0.0
    return checks.frozen(depth)
