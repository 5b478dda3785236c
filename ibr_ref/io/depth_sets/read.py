"""Depth sets, read."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from os import PathLike
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from ibr_ref.io.depth_sets.conventions import Conventions, Format, Options, checked, settled
from ibr_ref.io.depth_sets.formats import format_of
from ibr_ref.io.depth_sets.view import FARTHEST, View, depth_image, view_camera
from ibr_ref.scene import Camera, DepthImage, DepthSet, checks

MOST_PIXELS = 2**26
"""Of all pictures together: as many as the atlas of splatting holds."""


def read_depth_set(
    path: str | PathLike[str],
    format: str | None = None,  # noqa: A002, as the option
    *,
    views: Sequence[int] | None = None,
    convention: str | None = None,
    poses: str | None = None,
    along: str | None = None,
    pixel_centers: str | None = None,
    depth_scale: float | None = None,
    intrinsics: Sequence[float] | None = None,
    max_time_gap: float | None = None,
) -> DepthSet:
    """Read pictures with depth, in the world of their own poses.

    format: "open3d" | "tum" | "scannet" | "transforms" | "colmap" | "middlebury" | "folder" (README.md in ibr_ref/io has
    the table); None: told by the files. views: which pictures, from 0 in the set's order; None: all with a depth map.

    The others are for what a format leaves open, and for sets that are not as their format says; None: as it says.
    convention: the axes of cameras, "opencv" (+y down, looking down +z) | "opengl" (+y up, looking down -z).
    poses: "camera_to_world" | "world_to_camera".
    along: depths along the "axis" of view | along the "ray" from the eye.
    pixel_centers: where the intrinsics have the centres of pixels, at "integer" places | at "half" ones.
    depth_scale: world units of one stored unit, > 0: 0.001 for millimetres in a world of metres.
    intrinsics: (f_x, f_y, c_x, c_y) of the pictures, pixels. max_time_gap: seconds, of what belongs together.

    Depths of 0, below 0, of 1e9 and more, infinite and NaN are nothing: off the mask. An image has the size of its depth
    map; colours of another size, in the same shape, are fetched bilinearly at the centres of its pixels. near and far of
    the cameras enclose what each has seen.

    Raises OSError or ValueError, in one line that starts with the file or the option, for what is missing, damaged, not
    a rigid pose or a pinhole (pictures with lens distortion are refused), left open, has no valid depth at all, or is
    more than 2^26 pixels: choose `views` then.
    """
    options = Options(convention, poses, along, pixel_centers, depth_scale, intrinsics, max_time_gap)
    set_ = _opened(path, format, options)
    names, images, stored, pixels = list[str](), list[DepthImage](), "", 0
    for view in set_.chosen(views):
        image, stored = depth_image(view, set_.conventions, set_.options)
        pixels += image.camera.width * image.camera.height
        if pixels > MOST_PIXELS:
            found = f"more than {MOST_PIXELS} pixels in {len(images) + 1} pictures"
            raise ValueError(f"{checks.named(path)}: views: found {found}, allowed: fewer of the {len(set_.views)}")
        names.append(view.name)
        images.append(image)
    if not any(image.arrays[2].any() for image in images):
        found = f"no valid depth in {len(images)} maps, the last one of {stored}"
        raise ValueError(f"{checks.named(path)}: found {found}, allowed: numbers > 0, below {FARTHEST:g} world units")
    return DepthSet(images=images, names=names)


def read_depth_cameras(
    path: str | PathLike[str],
    format: str | None = None,  # noqa: A002
    *,
    views: Sequence[int] | None = None,
    near: float = 0.1,
    far: float = 100.0,
    pose: ArrayLike | None = None,
    **options: Any,
) -> tuple[Camera, ...]:
    """Read the cameras alone, those of pictures without a depth map too; None: all. `Camera.fitted` finds other planes.

    pose: (4, 4) or (3, 4), where they stand instead, in the set's own axes and direction. options: those of
    `read_depth_set`; the errors as there.
    """
    set_ = _opened(path, format, Options(**options))
    chosen = set_.chosen(views, with_depth=False)
    if pose is not None:
        rows = 4 if np.shape(pose) == (4, 4) else 3
        matrix = np.concatenate([checks.matrix("pose", pose, rows, 4), np.eye(4)[rows:]])
        chosen = (view._replace(pose=matrix) for view in chosen)
    return tuple(view_camera(view, set_.conventions, near, far) for view in chosen)


class _Set(NamedTuple):
    """A data set, of which only the texts have been read."""

    path: Path
    format: Format
    views: list[View]
    conventions: Conventions
    options: Options

    def chosen(self, views: Sequence[int] | None, with_depth: bool = True) -> Iterator[View]:
        if views is None:
            chosen = [view for view in self.views if view.depth is not None or not with_depth]
            if not chosen:
                found, allowed = f"{len(self.views)} pictures and no depth map", f"at least one ({self.format.wants})"
                raise ValueError(f"{checks.named(self.path)}: found {found}, allowed: {allowed}")
            return iter(chosen)
        if not isinstance(views, Sequence) or not views:
            raise checks.reject("views", views, "a sequence of numbers of pictures, at least one, or None for all")
        last = len(self.views) - 1
        return iter([self.views[checks.whole(f"views[{i}]", k, low=0, high=last)] for i, k in enumerate(views)])


def _opened(path: str | PathLike[str], name: str | None, options: Options) -> _Set:
    options = checked(options)
    format_ = format_of(Path(path), name)
    conventions = settled(format_, options)
    try:
        views = format_.views(Path(path), options)
    except OSError as error:
        if error.strerror:  # of a folder: the system's own message does not start with its name
            raise type(error)(f"{checks.named(error.filename or path)}: cannot be read ({error.strerror})") from None
        raise
    return _Set(Path(path), format_, views, conventions, options)
