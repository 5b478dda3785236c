"""`ibr-ref render splatting`."""

from __future__ import annotations

from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from ibr_ref.cli import emptiness, options, own_case
from ibr_ref.cli.what_goes_with_what import ABSENT, GIVEN, Beside, always
from ibr_ref.methods import named
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
    cameras: Annotated[
        options.Cameras,
        typer.Option(parser=options.cameras, metavar="I,J,..", help="--msr: the cameras that are references."),
    ] = options.Cameras((0,)),
    view: Annotated[
        options.View | None,
        typer.Option(
            parser=options.view,
            metavar="I|I:J|I:J:F",
            help="--msr: seen from camera I, or between I and J (midway, or at F of 1).",
        ),
    ] = None,
    frame: Annotated[int, typer.Option(parser=options.whole, help="--msr: number of the frame.")] = 0,
    near: Annotated[
        float | None,
        typer.Option(
            parser=options.number,
            help="Distance of the near plane, which is before all points without; --msr: Z of the depth code 255, known for "
            "two sequences.",
        ),
    ] = None,
    far: Annotated[
        float | None,
        typer.Option(parser=options.number, help="Distance of the far plane likewise; --msr: Z of the depth code 0."),
    ] = None,
    simple_texture: Annotated[Path | None, typer.Option(help="A SimpleTexture file (XMT-A).")] = None,
    mesh: Annotated[Path | None, typer.Option(help="A mesh, of which reference images are made.")] = None,
    count: Annotated[int, typer.Option(parser=options.whole, help="--mesh: 4, 9, 16 or 32 reference images.")] = 9,
    reference_size: Annotated[
        int, typer.Option(parser=options.whole, help="--mesh: pixels a side of a reference image.")
    ] = 320,
    eye: Annotated[
        options.Vector | None,
        typer.Option(parser=options.vector, metavar="X,Y,Z", help="The eye. Without: obliquely from the front."),
    ] = None,
    target: Annotated[
        options.Vector | None,
        typer.Option(parser=options.vector, metavar="X,Y,Z", help="Point looked at. Without: the middle."),
    ] = None,
    up: Annotated[
        options.Vector,
        typer.Option(parser=options.vector, metavar="X,Y,Z", help="The direction that is up in the picture."),
    ] = options.Vector(0, 0, 1),
    fov: Annotated[float, typer.Option(parser=options.number, help="Vertical field of view, degrees.")] = 45.0,
    size: Annotated[
        options.Size,
        typer.Option(parser=options.size, metavar="WxH", help="Pixels of the picture; --msr has its own."),
    ] = options.Size(640, 480),
    law: Annotated[
        options.Law | None,
        typer.Option(parser=options.law, metavar="A,B,C,D", help="W = A/(B d^2 + C d + D) pixels at the distance d."),
    ] = None,
    fit: Annotated[
        bool, typer.Option("--fit", help="Fit the law to the references and the view (the default).")
    ] = False,
    min_width: Annotated[float, typer.Option(parser=options.number, help="Least width of a splat, pixels.")] = 1.0,
    max_width: Annotated[float, typer.Option(parser=options.number, help="Largest width of a splat, pixels.")] = 64.0,
    shape: Annotated[
        Shape,
        typer.Option(help="Shape of a splat; ellipse: elliptical weighted averages (Zwicker et al. 2001), no law."),
    ] = Shape.square,
    footprint: Annotated[
        float,
        typer.Option(parser=options.number, help="--shape ellipse: deviation of a point's Gaussian, reference pixels."),
    ] = 0.5,
    low_pass: Annotated[
        float,
        typer.Option(parser=options.number, help="--shape ellipse: deviation of the filter, pixels of the picture."),
    ] = 0.5,
    cutoff: Annotated[
        float, typer.Option(parser=options.number, help="--shape ellipse: where Gaussians end, deviations.")
    ] = 2.0,
    depth_tolerance: Annotated[
        float,
        typer.Option(
            parser=options.number, help="--shape ellipse: what is averaged with the nearest, share of the distance."
        ),
    ] = 0.01,
    method: Annotated[
        Method, typer.Option(help="software: the paper's comparison, a loop on one thread; the same picture.")
    ] = Method.shader,
    light: Annotated[
        options.Vector | None,
        typer.Option(
            parser=options.vector, metavar="X,Y,Z", help="Relight, from this direction. Without: the stored colours."
        ),
    ] = None,
    report: Annotated[
        bool, typer.Option("--report", help="Print coverage, holes, overdraw, and the difference to the photograph.")
    ] = False,
    stages: Annotated[Path | None, typer.Option(help="Also write every stage array, as .npz.")] = None,
    case: own_case.Folder = None,
) -> None:
    """Splatting of reference images with depth (Lee & Park 2006) from a new view: of photographs, files, or a mesh."""
    if [msr, simple_texture, mesh].count(None) != 2:
        raise typer.BadParameter("give one of --msr, --simple-texture and --mesh")
    if msr is not None and view is None:
        raise typer.BadParameter("--msr needs --view: the number of a camera, such as 1, or 0:1 for midway between two")
    with progress(3) as step:
        step("reading references")
        from ibr_ref import io, splatting
        from ibr_ref.scene import Light

        io.check_image_writable(out)
        own_case.check_writable(case)
        if stages is not None:
            io.check_writable(stages)
        photograph: DepthImage | None = None
        if msr is not None:
            assert view is not None
            images, camera, photograph = _from_msr(msr, cameras, view, frame, near, far, report)
        else:
            images = _images(simple_texture, mesh, count, reference_size)
            camera = _camera(images, eye, target, up, fov, size, near, far)
        scene = splatting.Scene(
            images=images,
            camera=camera,
            light=None if light is None else Light(direction=light),
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
    own_case.write(case, scene, params)
    emptiness.say(picture, lambda: splatting.culled(scene, params))
    if report:
        from ibr_ref.cli.splatting_report import report_lines

        typer.echo("\n".join(report_lines(scene, params, picture, photograph)))


def _params(scene: Scene, law: options.Law | None, **rest: Any) -> Params:
    """The parameters, with the law that is given or fitted; ellipses have none, and where no point is in view none fits."""
    from ibr_ref import splatting

    plain = splatting.Params(**rest)  # what is wrong with these is said before the fit, which takes its time
    if law is not None:
        return splatting.Params(**law._asdict(), **rest)
    if plain.shape == "ellipse":
        return plain
    widths = {name: rest[name] for name in ("min_width", "max_width")}
    try:
        fitted = splatting.fit_splat_law(scene.images, scene.camera, **widths)
    except ValueError:
        if splatting.culled(scene, plain).drawn:
            raise
        return plain
    return splatting.Params(**fitted._asdict(), **rest)


def _from_msr(
    folder: Path,
    cameras: options.Cameras,
    view: options.View,
    frame: int,
    near: float | None,
    far: float | None,
    report: bool,
) -> tuple[Sequence[DepthImage], Camera, DepthImage | None]:
    """References, the view, and for a report the photograph that was taken from there, if there is one."""
    from ibr_ref import io
    from ibr_ref.scene import Camera

    images = io.read_msr(folder, frame, cameras, near, far)
    ends = [view.first] if view.second is None else [view.first, view.second]
    size = images[0].camera.width, images[0].camera.height
    first, *rest = io.read_msr_cameras(folder, ends, *size, near, far)
    if rest:
        return images, Camera.between(first, rest[0], view.fraction), None
    if not (report and io.has_msr_picture(folder, frame, view.first)):
        return images, first, None
    (photograph,) = io.read_msr(folder, frame, ends, near, far)
    found = photograph.camera.width, photograph.camera.height
    if found != size:
        raise ValueError(
            f"{folder}: found {found[0]} x {found[1]} pixels from camera {view.first}, allowed: {size[0]} x {size[1]} as "
            f"from camera {cameras[0]}, to be compared"
        )
    return images, first, photograph


def _images(simple_texture: Path | None, mesh: Path | None, count: int, size: int) -> Sequence[DepthImage]:
    from ibr_ref import io, models

    if simple_texture is not None:
        return io.read_simple_texture(simple_texture)
    assert mesh is not None
    return models.depth_rig(io.read_mesh(mesh), count, size=size)


def _camera(
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
    corners = [[(low, high)[i >> axis & 1][axis] for axis in range(3)] for i in range(8)]
    return camera.fitted(corners, near=near, far=far)


def goes_with() -> dict[str, Beside]:
    """Beside which others each option is read."""
    from ibr_ref.splatting.inputs import READ_BY

    one = "there is one source of references"
    photographs, camera = "it is about photographs", "the view is that of a camera of the data set"
    of_shape = {
        name: Beside(f"others do not read {name}", {"shape": READ_BY[name]})
        for name in ("min_width", "footprint", "low_pass", "cutoff", "depth_tolerance")
    }
    return {
        **always("out", "near", "far", "max_width", "shape", "method", "light", "report", "stages"),
        **of_shape,
        "case": Beside(own_case.WHY, {"shape": named("splatting").judged[1]}),
        "msr": Beside(one, {"simple_texture": ABSENT, "mesh": ABSENT}),
        "simple_texture": Beside(one, {"msr": ABSENT, "mesh": ABSENT}),
        "mesh": Beside(one, {"msr": ABSENT, "simple_texture": ABSENT}),
        **{name: Beside(photographs, {"msr": GIVEN}) for name in ("cameras", "view", "frame")},
        **{
            name: Beside("reference images are made of a mesh", {"mesh": GIVEN}) for name in ("count", "reference_size")
        },
        **{name: Beside(camera, {"msr": ABSENT}) for name in ("eye", "target", "up", "fov", "size")},
        "law": Beside("ellipses have no law, and a law is given or fitted", {"shape": READ_BY["alpha"], "fit": ABSENT}),
        "fit": Beside("ellipses have no law, and a law is given or fitted", {"shape": READ_BY["alpha"], "law": ABSENT}),
    }
