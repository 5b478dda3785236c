"""Where the references of `ibr-ref render splatting` are from, and the cameras that see them."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any

import typer

from ibr_ref.cli import options

if TYPE_CHECKING:
    from ibr_ref.scene import Camera, DepthImage


def check(
    msr: Path | None,
    rgbd: Path | None,
    simple_texture: Path | None,
    mesh: Path | None,
    cameras: options.Cameras,
    view: options.View | None,
    pose: options.Numbers | None,
    eye: options.Vector | None,
    path: Path | None,
) -> None:
    """Raise BadParameter for what no table of options can say: that something is missing."""
    if [msr, rgbd, simple_texture, mesh].count(None) != 3:
        raise typer.BadParameter("give one of --msr, --rgbd, --simple-texture and --mesh")
    which = "the number of a camera, such as 1, or 0:1 for midway between two"
    if msr is not None and view is None:
        raise typer.BadParameter(f"--msr needs --view: {which}")
    if msr is not None and not cameras:
        raise typer.BadParameter("--cameras: found all, allowed beside --msr: numbers of cameras, such as 0,1")
    if rgbd is not None and view is None and pose is None and eye is None and path is None:
        raise typer.BadParameter(f"--rgbd needs --view ({which}), --pose, --eye or --path")


Photograph = Callable[[], "DepthImage | None"]
"""Reads what was taken from the view, if there is such a picture."""


def no_photograph() -> DepthImage | None:
    """Of a view that no camera had."""
    return None


def from_msr(
    folder: Path, cameras: options.Cameras, view: options.View, frame: int, near: float | None, far: float | None
) -> tuple[Sequence[DepthImage], Camera, Photograph]:
    """References, the view, and the photograph that was taken from there."""
    from ibr_ref import io
    from ibr_ref.scene import Camera

    images = io.read_msr(folder, frame, cameras, near, far)
    ends = [view.first] if view.second is None else [view.first, view.second]
    size = images[0].camera.width, images[0].camera.height
    first, *rest = io.read_msr_cameras(folder, ends, *size, near, far)
    if rest:
        return images, Camera.between(first, rest[0], view.fraction), no_photograph

    def photograph() -> DepthImage | None:
        if not io.has_msr_picture(folder, frame, view.first):
            return None
        (taken,) = io.read_msr(folder, frame, ends, near, far)
        found = taken.camera.width, taken.camera.height
        if found != size:
            raise ValueError(
                f"{folder}: found {found[0]} x {found[1]} pixels from camera {view.first}, allowed: {size[0]} x {size[1]} "
                f"as from camera {cameras[0]}, to be compared"
            )
        return taken

    return images, first, photograph


def from_rgbd(
    folder: Path,
    cameras: options.Cameras,
    view: options.View | None,
    pose: options.Numbers | None,
    planes: tuple[float | None, float | None],
    **says: Any,
) -> tuple[Sequence[DepthImage], Camera | None, Photograph]:
    """References, the view if it is that of a picture or a pose, and the picture that was taken there.

    says: the format and the options of `io.read_depth_set`.
    """
    import numpy as np

    from ibr_ref import io
    from ibr_ref.scene import Camera

    images = io.read_depth_set(folder, views=cameras or None, **says)
    if view is None and pose is None:
        return images, None, no_photograph
    ends = [*cameras[:1]] or [0]
    if view is not None:
        ends = [view.first] if view.second is None else [view.first, view.second]
    matrix = None if pose is None else np.reshape(pose, (-1, 4))
    camera, *rest = io.read_depth_cameras(folder, views=ends, pose=matrix, **says)
    if rest and view is not None:
        camera = Camera.between(camera, rest[0], view.fraction)
    points = np.concatenate([image.points for image in images])
    camera = camera.fitted(points, near=planes[0], far=planes[1])
    if pose is not None or rest:
        return images, camera, no_photograph

    def photograph() -> DepthImage | None:
        with suppress(FileNotFoundError):  # a view needs no depth map of its own
            (taken,) = io.read_depth_set(folder, views=ends, **says)
            return taken
        return None

    return images, camera, photograph


def of_file(simple_texture: Path | None, mesh: Path | None, count: int, size: int) -> Sequence[DepthImage]:
    """References that a file describes, or that are made of a mesh."""
    from ibr_ref import io, models

    if simple_texture is not None:
        return io.read_simple_texture(simple_texture)
    assert mesh is not None
    return models.depth_rig(io.read_mesh(mesh), count, size=size)


def view_of(
    images: Sequence[DepthImage],
    eye: options.Vector | None,
    target: options.Vector | None,
    up: options.Vector,
    fov: float,
    size: options.Size,
    near: float | None,
    far: float | None,
) -> Camera:
    """The view; what is not given is chosen so that all points are seen."""
    import numpy as np

    from ibr_ref import splatting
    from ibr_ref.scene import Camera

    low, high = splatting.bounds(images)
    center = (low + high) / 2.0 if target is None else np.array(target)
    radius = float(np.sqrt(((high - low) ** 2).sum())) / 2.0 or 1.0
    at = center + radius * np.array([1.3, -2.3, 1.1]) if eye is None else np.array(eye)
    camera = Camera.look_at(eye=at, target=center, up=up, vertical_fov=fov, width=size.width, height=size.height)
    return fitted(images, camera, near, far)


def fitted(images: Sequence[DepthImage], camera: Camera, near: float | None, far: float | None) -> Camera:
    """The camera with planes around all points, or where they are given."""
    from ibr_ref import splatting
    from ibr_ref.scene.boxes import box_corners

    return camera.fitted(box_corners(splatting.bounds(images)), near=near, far=far)
