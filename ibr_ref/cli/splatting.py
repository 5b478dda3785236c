"""`ibr-ref render splatting`."""

from __future__ import annotations

from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from ibr_ref.cli import options
from ibr_ref.progress import progress

if TYPE_CHECKING:
    from collections.abc import Sequence

    from ibr_ref.scene import Camera, DepthImage
    from ibr_ref.splatting import Params, Scene

EXAMPLES = """
Examples:

    ibr-ref render splatting --msr breakdancers --cameras 0 --view 1 --report --out view.png

    ibr-ref render splatting --msr breakdancers --cameras 0,1 --view 0:1 --out midway.png

    ibr-ref render splatting --mesh cow.obj --count 9 --light=-1,-1,2 --out cow.png

    ibr-ref render splatting --mesh cow.obj --shape ellipse --out smooth.png

    ibr-ref render splatting --simple-texture set.xmt --law 1,0,0.002,0.7 --eye 3,-2,1 --target 0,0,0 --out image.png
"""


class Shape(StrEnum):
    """Shape of a splat."""

    square = "square"
    disc = "disc"
    ellipse = "ellipse"


class Method(StrEnum):
    """How the points are drawn."""

    shader = "shader"
    software = "software"


def command(
    out: Annotated[Path, typer.Option(help="The picture: .png or .jpg.")],
    msr: Annotated[Path | None, typer.Option(help="A folder of MSR 3D Video (calibParams-*.txt, images).")] = None,
    cameras: Annotated[str, typer.Option(metavar="I,J,..", help="--msr: the cameras that are references.")] = "0",
    view: Annotated[
        str | None,
        typer.Option(
            metavar="I|I:J|I:J:F", help="--msr: seen from camera I, or between I and J (midway, or at F of 1)."
        ),
    ] = None,
    frame: Annotated[int, typer.Option(help="--msr: number of the frame.")] = 0,
    near: Annotated[float | None, typer.Option(help="--msr: Z of the depth code 255; known for two sequences.")] = None,
    far: Annotated[float | None, typer.Option(help="--msr: Z of the depth code 0.")] = None,
    simple_texture: Annotated[Path | None, typer.Option(help="A SimpleTexture file (XMT-A).")] = None,
    mesh: Annotated[Path | None, typer.Option(help="A mesh, of which reference images are made.")] = None,
    count: Annotated[int, typer.Option(help="--mesh: 4, 9, 16 or 32 reference images.")] = 9,
    reference_size: Annotated[int, typer.Option(help="--mesh: pixels a side of a reference image.")] = 320,
    eye: Annotated[
        str | None, typer.Option(metavar="X,Y,Z", help="The eye. Without: obliquely from the front.")
    ] = None,
    target: Annotated[str | None, typer.Option(metavar="X,Y,Z", help="Point looked at. Without: the middle.")] = None,
    up: Annotated[str, typer.Option(metavar="X,Y,Z", help="The direction that is up in the picture.")] = "0,0,1",
    fov: Annotated[float, typer.Option(help="Vertical field of view, degrees.")] = 45.0,
    size: Annotated[str | None, typer.Option(metavar="WxH", help="Pixels of the picture; 640x480.")] = None,
    law: Annotated[
        str | None, typer.Option(metavar="A,B,C,D", help="W = A/(B d^2 + C d + D) pixels at the distance d.")
    ] = None,
    fit: Annotated[
        bool, typer.Option("--fit", help="Fit the law to the references and the view (the default).")
    ] = False,
    min_width: Annotated[float, typer.Option(help="Least width of a splat, pixels.")] = 1.0,
    max_width: Annotated[float, typer.Option(help="Largest width of a splat, pixels.")] = 64.0,
    shape: Annotated[
        Shape,
        typer.Option(help="Shape of a splat; ellipse: elliptical weighted averages (Zwicker et al. 2001), no law."),
    ] = Shape.square,
    footprint: Annotated[
        float, typer.Option(help="--shape ellipse: deviation of a point's Gaussian, reference pixels.")
    ] = 0.5,
    low_pass: Annotated[
        float, typer.Option(help="--shape ellipse: deviation of the filter, pixels of the picture.")
    ] = 0.5,
    cutoff: Annotated[float, typer.Option(help="--shape ellipse: where Gaussians end, deviations.")] = 2.0,
    depth_tolerance: Annotated[
        float, typer.Option(help="--shape ellipse: what is averaged with the nearest, share of the distance.")
    ] = 0.01,
    method: Annotated[
        Method, typer.Option(help="software: the paper's comparison, a loop on one thread; the same picture.")
    ] = Method.shader,
    light: Annotated[
        str | None, typer.Option(metavar="X,Y,Z", help="Relight, from this direction. Without: the stored colours.")
    ] = None,
    report: Annotated[
        bool, typer.Option("--report", help="Print coverage, holes, overdraw, and the difference to the photograph.")
    ] = False,
    stages: Annotated[Path | None, typer.Option(help="Also write every stage array, as .npz.")] = None,
) -> None:
    """Splatting of reference images with depth (Lee & Park 2006) from a new view: of photographs, files, or a mesh."""
    if [msr, simple_texture, mesh].count(None) != 2:
        raise typer.BadParameter("give one of --msr, --simple-texture and --mesh")
    if msr is not None and view is None:
        raise typer.BadParameter("--msr needs --view: the number of a camera, such as 1, or 0:1 for midway between two")
    if law is not None and fit:
        raise typer.BadParameter("give --law or --fit, not both")
    with progress(3) as step:
        step("reading references")
        from ibr_ref import io, splatting
        from ibr_ref.scene import Light

        io.check_image_writable(out)
        if stages is not None:
            io.check_writable(stages)
        photograph: DepthImage | None = None
        if msr is not None:
            assert view is not None
            images, camera, photograph = _from_msr(msr, options.numbers(cameras), view, frame, near, far)
        else:
            images = _images(simple_texture, mesh, count, reference_size)
            width, height = options.size(size or "640x480")
            camera = _camera(images, eye, target, up, fov, width, height)
        scene = splatting.Scene(
            images=images,
            camera=camera,
            light=None if light is None else Light(direction=options.vector(light)),
            background=(1.0, 1.0, 1.0) if msr is None else (0.0, 0.0, 0.0),
        )
        params = _params(
            scene,
            law,
            min_width=min_width,
            max_width=max_width,
            shape=shape.value,
            footprint=footprint,
            low_pass=low_pass,
            cutoff=cutoff,
            depth_tolerance=depth_tolerance,
            method=method.value,
        )
        step("rendering")
        picture = splatting.render(scene, params, stages=report or stages is not None)
        step("writing")
        if stages is not None:
            picture.save_stages(stages)
        picture.save(out)
    if report:
        from ibr_ref.cli.splatting_report import report_lines

        typer.echo("\n".join(report_lines(scene, params, picture, photograph)))


def _params(scene: Scene, law: str | None, **rest: Any) -> Params:
    """The parameters, with the law that is given or fitted; ellipses have none."""
    from ibr_ref import splatting

    plain = splatting.Params(**rest)  # what is wrong with these is said before the fit, which takes its time
    if law is not None:
        fitted = options.law(law)
    elif plain.shape == "ellipse":
        return plain
    else:
        widths = {name: rest[name] for name in ("min_width", "max_width")}
        fitted = splatting.fit_splat_law(scene.images, scene.camera, **widths)
    alpha, beta, gamma, delta = fitted
    return splatting.Params(alpha=alpha, beta=beta, gamma=gamma, delta=delta, **rest)


def _from_msr(
    folder: Path, cameras: list[int], view: str, frame: int, near: float | None, far: float | None
) -> tuple[Sequence[DepthImage], Camera, DepthImage | None]:
    """References, the view, and the picture that was taken from there (None between two cameras)."""
    from ibr_ref import io
    from ibr_ref.scene import Camera

    images = io.read_msr(folder, frame, cameras, near, far)
    first, second, fraction = options.view(view)
    if second is None:
        (photograph,) = io.read_msr(folder, frame, (first,), near, far)
        return images, photograph.camera, photograph
    ends = io.read_msr(folder, frame, (first, second), near, far)
    return images, Camera.between(ends[0].camera, ends[1].camera, fraction), None


def _images(simple_texture: Path | None, mesh: Path | None, count: int, size: int) -> Sequence[DepthImage]:
    from ibr_ref import io, models

    if simple_texture is not None:
        return io.read_simple_texture(simple_texture)
    assert mesh is not None
    return models.depth_rig(io.read_mesh(mesh), count, size=size)


def _camera(
    images: Sequence[DepthImage],
    eye: str | None,
    target: str | None,
    up: str,
    fov: float,
    width: int,
    height: int,
) -> Camera:
    """The view; what is not given is chosen so that all points are seen."""
    import numpy as np

    from ibr_ref import splatting
    from ibr_ref.scene import Camera

    low, high = splatting.bounds(images)
    center = (low + high) / 2.0 if target is None else np.array(options.vector(target))
    radius = float(np.sqrt(((high - low) ** 2).sum())) / 2.0 or 1.0
    at = center + radius * np.array([1.3, -2.3, 1.1]) if eye is None else np.array(options.vector(eye))
    reach = float(np.sqrt(((at - (low + high) / 2.0) ** 2).sum())) + radius
    return Camera.look_at(
        eye=at,
        target=center,
        up=options.vector(up),
        vertical_fov=fov,
        near=1e-3 * reach,
        far=1.01 * reach,
        width=width,
        height=height,
    )
