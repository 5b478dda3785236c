"""Where the references of `ibr-ref render splatting` are from, and the cameras that see them."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from ibr_ref.cli import depth_set_options, options

if TYPE_CHECKING:
    from ibr_ref.scene import Camera, DepthImage


@dataclass(frozen=True, kw_only=True)
class Sources:
    """Options: the references, and the cameras that are told beside them."""

    msr: Annotated[Path | None, typer.Option(help="A folder of MSR 3D Video (calibParams-*.txt, images).")] = None
    files: depth_set_options.Set
    cameras: Annotated[
        options.Cameras,
        typer.Option(
            parser=options.cameras, metavar="I,J,..|all", help="--msr, --rgbd: the cameras that are references."
        ),
    ] = options.Cameras((0,))
    view: Annotated[
        options.View | None,
        typer.Option(
            parser=options.view,
            metavar="I|I:J|I:J:F",
            help="--msr, --rgbd: seen from camera I, or between I and J (midway, or at F of 1).",
        ),
    ] = None
    pose: depth_set_options.Pose = None
    frame: Annotated[int, typer.Option(parser=options.whole, help="--msr: number of the frame.")] = 0
    near: Annotated[
        float | None,
        typer.Option(
            parser=options.number,
            help="Distance of the near plane, which is before all points without; --msr: Z of the depth code 255, known for "
            "two sequences.",
        ),
    ] = None
    far: Annotated[
        float | None,
        typer.Option(parser=options.number, help="Distance of the far plane likewise; --msr: Z of the depth code 0."),
    ] = None
    simple_texture: Annotated[Path | None, typer.Option(help="A SimpleTexture file (XMT-A).")] = None
    mesh: Annotated[Path | None, typer.Option(help="A mesh, of which reference images are made.")] = None
    count: Annotated[int, typer.Option(parser=options.whole, help="--mesh: 4, 9, 16 or 32 reference images.")] = 9
    reference_size: Annotated[
        int, typer.Option(parser=options.whole, help="--mesh: pixels a side of a reference image.")
    ] = 320


@dataclass(frozen=True, kw_only=True)
class Seen:
    """Options: a view of one's own."""

    eye: Annotated[
        options.Vector | None,
        typer.Option(parser=options.vector, metavar="X,Y,Z", help="The eye. Without: obliquely from the front."),
    ] = None
    target: Annotated[
        options.Vector | None,
        typer.Option(parser=options.vector, metavar="X,Y,Z", help="Point looked at. Without: the middle."),
    ] = None
    up: Annotated[
        options.Vector,
        typer.Option(parser=options.vector, metavar="X,Y,Z", help="The direction that is up in the picture."),
    ] = options.Vector(0, 0, 1)
    fov: Annotated[float, typer.Option(parser=options.number, help="Vertical field of view, degrees.")] = 45.0
    size: Annotated[
        options.Size,
        typer.Option(
            parser=options.size, metavar="WxH", help="Pixels of the picture; a camera of a data set has its own."
        ),
    ] = options.Size(640, 480)


def check(sources: Sources, seen: Seen, path: Path | None) -> None:
    """Raise BadParameter for what no table of options can say: that something is missing. path: of cameras."""
    msr, rgbd, view = sources.msr, sources.files.rgbd, sources.view
    if [msr, rgbd, sources.simple_texture, sources.mesh].count(None) != 3:
        raise typer.BadParameter("give one of --msr, --rgbd, --simple-texture and --mesh")
    which = "the number of a camera, such as 1, or 0:1 for midway between two"
    if msr is not None and view is None:
        raise typer.BadParameter(f"--msr needs --view: {which}")
    if msr is not None and not sources.cameras:
        raise typer.BadParameter("--cameras: found all, allowed beside --msr: numbers of cameras, such as 0,1")
    if rgbd is not None and not (view or sources.pose or seen.eye or path):
        raise typer.BadParameter(f"--rgbd needs --view ({which}), --pose, --eye or --path")


Photograph = Callable[[], "DepthImage | None"]
"""Reads what was taken from the view, if there is such a picture."""


def no_photograph() -> DepthImage | None:
    """Of a view that no camera had."""
    return None


def references(sources: Sources) -> tuple[Sequence[DepthImage], Camera | None, Photograph]:
    """References, the view if it is told beside them, and the picture that was taken there."""
    if sources.msr is not None:
        return _from_msr(sources, sources.msr)
    if sources.files.rgbd is not None:
        return _from_rgbd(sources, sources.files.rgbd)
    return _of_file(sources), None, no_photograph


def _from_msr(sources: Sources, folder: Path) -> tuple[Sequence[DepthImage], Camera, Photograph]:
    """References, the view, and the photograph that was taken from there."""
    from ibr_ref import io
    from ibr_ref.scene import Camera

    cameras, view, frame = sources.cameras, sources.view, sources.frame
    near, far = sources.near, sources.far
    assert view is not None
    images = io.read_msr(folder, frame, cameras, near, far)
    ends = _ends(view)
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


def _from_rgbd(sources: Sources, folder: Path) -> tuple[Sequence[DepthImage], Camera | None, Photograph]:
    """References, the view if it is that of a picture or a pose, and the picture that was taken there."""
    import numpy as np

    from ibr_ref import io
    from ibr_ref.scene import Camera

    cameras, view, pose, says = sources.cameras, sources.view, sources.pose, sources.files.says()
    images = io.read_depth_set(folder, views=cameras or None, **says)
    if view is None and pose is None:
        return images, None, no_photograph
    ends = [*cameras[:1]] or [0] if view is None else _ends(view)
    matrix = None if pose is None else np.reshape(pose, (-1, 4))
    camera, *rest = io.read_depth_cameras(folder, views=ends, pose=matrix, **says)
    if rest and view is not None:
        camera = Camera.between(camera, rest[0], view.fraction)
    points = np.concatenate([image.points for image in images])
    camera = camera.fitted(points, near=sources.near, far=sources.far)
    if pose is not None or rest:
        return images, camera, no_photograph

    def photograph() -> DepthImage | None:
        with suppress(FileNotFoundError):  # a view needs no depth map of its own
            (taken,) = io.read_depth_set(folder, views=ends, **says)
            return taken
        return None

    return images, camera, photograph


def _ends(view: options.View) -> list[int]:
    """The cameras that a view is seen from, or lies between."""
    return [view.first] if view.second is None else [view.first, view.second]


def _of_file(sources: Sources) -> Sequence[DepthImage]:
    """References that a file describes, or that are made of a mesh."""
    from ibr_ref import io, models

    if sources.simple_texture is not None:
        return io.read_simple_texture(sources.simple_texture)
    assert sources.mesh is not None
    return models.depth_rig(io.read_mesh(sources.mesh), sources.count, size=sources.reference_size)


def view_of(images: Sequence[DepthImage], seen: Seen, near: float | None, far: float | None) -> Camera:
    """The view; what is not given is chosen so that all points are seen."""
    import numpy as np

    from ibr_ref import splatting
    from ibr_ref.scene import Camera

    low, high = splatting.bounds(images)
    center = (low + high) / 2.0 if seen.target is None else np.array(seen.target)
    radius = float(np.sqrt(((high - low) ** 2).sum())) / 2.0 or 1.0
    at = center + radius * np.array([1.3, -2.3, 1.1]) if seen.eye is None else np.array(seen.eye)
    width, height = seen.size
    camera = Camera.look_at(eye=at, target=center, up=seen.up, vertical_fov=seen.fov, width=width, height=height)
    return fitted(images, camera, near, far)


def fitted(images: Sequence[DepthImage], camera: Camera, near: float | None, far: float | None) -> Camera:
    """The camera with planes around all points, or where they are given."""
    from ibr_ref import splatting
    from ibr_ref.scene.boxes import box_corners

    return camera.fitted(box_corners(splatting.bounds(images)), near=near, far=far)
