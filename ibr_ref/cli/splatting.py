"""`ibr-ref render splatting`."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from ibr_ref.choices import DRAWN_BY, SHAPES
from ibr_ref.cli import depth_set_options, emptiness, options, own_case, pictures, splatting_sources
from ibr_ref.cli.described import Described, beside
from ibr_ref.cli.groups import grouped, told
from ibr_ref.cli.what_goes_with_what import ABSENT, GIVEN, Beside, always
from ibr_ref.progress import progress

if TYPE_CHECKING:
    from ibr_ref.splatting import Params, Scene

EXAMPLES = """
Examples:

    ibr-ref render splatting --msr breakdancers --cameras 0 --view 1 --report --out view.png

    ibr-ref render splatting --msr breakdancers --cameras 0,1 --view 0:1 --out midway.png

    ibr-ref render splatting --rgbd freiburg3 --intrinsics 535.4,539.2,320.1,247.6 --cameras 0,40 --view 20 --out view.png

    ibr-ref render splatting --rgbd scene --cameras all --eye 3,-2,1 --target 0,0,0 --point-cloud scene.ply --out view.png

    ibr-ref render splatting --mesh cow.obj --count 9 --light=-1,-1,2 --out cow.png

    ibr-ref render splatting --mesh cow.obj --path path.json --frames 120 --video film.mp4 --out film.png

    ibr-ref render splatting --mesh cow.obj --shape ellipse --out smooth.png

    ibr-ref render splatting --simple-texture set.xmt --law 1,0,0.002,0.7 --eye 3,-2,1 --target 0,0,0 --out image.png
"""


if TYPE_CHECKING:
    Shape = str
    Method = str
else:
    Shape = options.choices("Shape", SHAPES, "Shape of a splat.")
    Method = options.choices("Method", DRAWN_BY, "How the points are drawn.")
SQUARE, SHADER = Shape("square"), Method("shader")


@dataclass(frozen=True, kw_only=True)
class Splats:
    """Options: the fields of Params, the law's four numbers as one."""

    law: Annotated[
        options.Law | None,
        typer.Option(parser=options.law, metavar="A,B,C,D", help="W = A/(B d^2 + C d + D) pixels at the distance d."),
    ] = None
    fit: Annotated[bool, typer.Option("--fit", help="Fit the law to the references and the view (the default).")] = (
        False
    )
    min_width: Annotated[float, typer.Option(parser=options.number, help="Least width of a splat, pixels.")] = 1.0
    max_width: Annotated[float, typer.Option(parser=options.number, help="Largest width of a splat, pixels.")] = 64.0
    shape: Annotated[
        Shape,
        typer.Option(help="Shape of a splat; ellipse: elliptical weighted averages (Zwicker et al. 2001), no law."),
    ] = SQUARE
    footprint: Annotated[
        float,
        typer.Option(parser=options.number, help="--shape ellipse: deviation of a point's Gaussian, reference pixels."),
    ] = 0.5
    low_pass: Annotated[
        float,
        typer.Option(parser=options.number, help="--shape ellipse: deviation of the filter, pixels of the picture."),
    ] = 0.5
    cutoff: Annotated[
        float, typer.Option(parser=options.number, help="--shape ellipse: where Gaussians end, deviations.")
    ] = 2.0
    depth_tolerance: Annotated[
        float,
        typer.Option(
            parser=options.number, help="--shape ellipse: what is averaged with the nearest, share of the distance."
        ),
    ] = 0.01
    method: Annotated[
        Method, typer.Option(help="software: the paper's comparison, a loop on one thread; the same picture.")
    ] = SHADER


@grouped
def read(
    sources: splatting_sources.Sources,
    seen: splatting_sources.Seen,
    splats: Splats,
    light: Annotated[
        options.Vector | None,
        typer.Option(
            parser=options.vector, metavar="X,Y,Z", help="Relight, from this direction. Without: the stored colours."
        ),
    ] = None,
    *,
    path: Path | None = None,
) -> Described:
    """What the options describe; path: of cameras, beside which no view is needed.

    Raises ValueError and OSError for references and numbers that make no scene.
    """
    splatting_sources.check(sources, seen, path)
    from ibr_ref import splatting
    from ibr_ref.scene import Light

    images, camera, photograph = splatting_sources.references(sources)
    if camera is None:
        camera = splatting_sources.view_of(images, seen, sources.near, sources.far)
    scene = splatting.Scene(
        images=images,
        camera=camera,
        light=None if light is None else Light(direction=light),
        background=(1.0, 1.0, 1.0) if sources.msr is None and sources.files.rgbd is None else (0.0, 0.0, 0.0),
    )
    return Described(scene, _params(scene, splats), {}, photograph)


@beside(read)
def command(
    *,
    report: Annotated[
        bool, typer.Option("--report", help="Print coverage, holes, overdraw, and the difference to the photograph.")
    ] = False,
    picture: pictures.Picture,
    depth_set: depth_set_options.DepthSet = None,
    point_cloud: depth_set_options.PointCloud = None,
    kept: pictures.Kept,
    **described: Any,
) -> None:
    """Splatting of reference images with depth (Lee & Park 2006) from a new view: of photographs, files, or a mesh."""
    wanted = pictures.Wanted(picture, kept, fov=described["fov"], whole={"report": report})
    with progress(3) as step:
        step("reading references")
        from ibr_ref import io, splatting

        wanted.check(described["size"])
        if point_cloud is not None:
            io.check_writable(point_cloud)
        scene, params, _, read_photograph = read(**described, path=picture.path)
        photograph = read_photograph() if report else None
        if depth_set is not None:
            io.write_depth_set(depth_set, scene.images, bits=kept.bits)
        if point_cloud is not None:
            io.write_point_cloud(point_cloud, scene.images)
        keep, near, far = report or kept.stages is not None, described["near"], described["far"]
        shown, frame = pictures.draw(
            wanted,
            scene,
            params,
            lambda scene, **rows: splatting.render(scene, params, stages=keep, **rows),
            lambda camera: splatting_sources.fitted(scene.images, camera, near, far),
            step,
        )
        if frame is not None:
            pictures.write(wanted, frame, step)
    own_case.write(kept.case, scene, params)
    emptiness.say(shown, lambda: splatting.culled(scene, params))
    if frame is not None and report:
        from ibr_ref.cli.splatting_report import report_lines

        typer.echo("\n".join(report_lines(scene, params, frame, photograph)))


def _params(scene: Scene, splats: Splats) -> Params:
    """The parameters, with the law that is given or fitted; ellipses have none, and where no point is in view none fits."""
    from ibr_ref import splatting

    rest = told(splats, "law", "fit")
    plain = splatting.Params(**rest)  # what is wrong with these is said before the fit, which takes its time
    if splats.law is not None:
        return splatting.Params(**splats.law._asdict(), **rest)
    if plain.shape == "ellipse":
        return plain
    try:
        fitted = splatting.fit_splat_law(
            scene.images, scene.camera, min_width=splats.min_width, max_width=splats.max_width
        )
    except ValueError:
        if splatting.culled(scene, plain).drawn:
            raise
        return plain
    return splatting.Params(**fitted._asdict(), **rest)


def goes_with() -> dict[str, Beside]:
    """Beside which others each option is read."""
    from ibr_ref.splatting.inputs import READ_BY

    one, sources = "there is one source of references", ("msr", "rgbd", "simple_texture", "mesh")
    of_shape = {
        name: Beside(f"others do not read {name}", {"shape": READ_BY[name]})
        for name in ("min_width", "footprint", "low_pass", "cutoff", "depth_tolerance")
    }
    seen = "there is one view"
    told = (
        "format_",
        "depth_scale",
        "convention",
        "poses",
        "along",
        "pixel_centers",
        "intrinsics",
        "max_time_gap",
    )
    return {
        **always("out", "bits", "near", "far", "max_width", "shape", "method", "light", "report", "stages"),
        **always("depth_set", "point_cloud", "case"),
        **of_shape,
        **{name: Beside(one, {other: ABSENT for other in sources if other != name}) for name in sources},
        "cameras": Beside("it is about photographs", {"msr": GIVEN}, {"rgbd": GIVEN}),
        "view": Beside("it is about photographs", {"msr": GIVEN}, {"rgbd": GIVEN}),
        "frame": Beside("it is about photographs", {"msr": GIVEN}),
        **{name: Beside("it is about pictures with depth", {"rgbd": GIVEN}) for name in told},
        "pose": Beside("it is one of the set's poses, in place of --view", {"rgbd": GIVEN, "view": ABSENT}),
        **{
            name: Beside("reference images are made of a mesh", {"mesh": GIVEN}) for name in ("count", "reference_size")
        },
        **pictures.goes_with(),
        "path": Beside(seen, {"msr": ABSENT, "view": ABSENT, "pose": ABSENT}),
        **{name: Beside(seen, {"msr": ABSENT, "view": ABSENT, "pose": ABSENT}) for name in ("size", "fov")},
        **{
            name: Beside(seen, {"msr": ABSENT, "view": ABSENT, "pose": ABSENT, "path": ABSENT})
            for name in ("eye", "target", "up")
        },
        "law": Beside("ellipses have no law, and a law is given or fitted", {"shape": READ_BY["alpha"], "fit": ABSENT}),
        "fit": Beside("ellipses have no law, and a law is given or fitted", {"shape": READ_BY["alpha"], "law": ABSENT}),
    }
