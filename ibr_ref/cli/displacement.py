"""`ibr-ref render displacement`."""

from __future__ import annotations

from enum import StrEnum
from inspect import signature
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from ibr_ref.cli import base_polygon, depth_set_options, emptiness, options, own_case, pictures
from ibr_ref.cli.described import Described, beside
from ibr_ref.cli.what_goes_with_what import ABSENT, GIVEN, Beside, always
from ibr_ref.methods import named
from ibr_ref.progress import progress
from ibr_ref.searches import SEARCHES

EXAMPLES = """
Examples:

    ibr-ref render displacement --height h.png --color c.png --out image.png

    ibr-ref render displacement --height h.png --invert-height --color c.png --normal n.png --height-scale 0.1 --steps 50
    --out image.png --stages dump.npz

    ibr-ref render displacement --height dem.tif --height-range 350,4850 --texel-size 30 --out terrain.png

    ibr-ref render displacement --height dem.tif --size 16384x16384 --out poster.tif

    ibr-ref render displacement --height h.png --color c.png --method tatarchuk --max-steps 80 --out occlusion.png
"""


if TYPE_CHECKING:
    Method = str
else:
    Method = options.choices("Method", SEARCHES, "Search for the hit.")
PROTRUDED = Method("protruded")


class Interval(StrEnum):
    """Stretch of the view ray that is searched."""

    paper = "paper"
    volume = "volume"


class HeightFormat(StrEnum):
    """Of a height file that does not say it."""

    hgt = "hgt"
    raw = "raw"
    terrarium = "terrarium"


class ByteOrder(StrEnum):
    """Of raw samples."""

    little = "little"
    big = "big"


class FaceSet(StrEnum):
    """Faces of the volume that are drawn."""

    auxiliary = "auxiliary"
    base = "base"
    extended = "extended"


def read(
    height: Annotated[
        Path | None,
        typer.Option(help="Height map, white is high: PNG, JPEG, TIFF, GeoTIFF, EXR, PFM, .hgt, .raw, .r16, .r32."),
    ] = None,
    height_format: Annotated[
        HeightFormat | None, typer.Option(help="Of a file that does not say it. Without: content, .hgt, .raw.")
    ] = None,
    height_size: Annotated[
        options.Size | None,
        typer.Option(
            parser=options.size, metavar="WxH", help="Samples of a raw file: of 1, 2 (unsigned) or 4 bytes (float)."
        ),
    ] = None,
    height_order: Annotated[ByteOrder | None, typer.Option(help="Byte order of a raw file. Without: little.")] = None,
    height_range: Annotated[
        options.Pair | None,
        typer.Option(
            parser=options.pair,
            metavar="LOW,HIGH",
            help="Heights that become 0 and 1, in the file's numbers. Without: all that unsigned integers can say; others "
            "must lie in [0, 1].",
        ),
    ] = None,
    nodata: Annotated[
        float | None,
        typer.Option(parser=options.number, help="Number that stands for no height. Without: the file's own."),
    ] = None,
    fill: Annotated[
        float | None, typer.Option(parser=options.number, help="Height given to where there is none; without, refused.")
    ] = None,
    normal_height: Annotated[
        Path | None,
        typer.Option(help="Instead of --height and --normal: RGBA, the normal in RGB, the height in alpha."),
    ] = None,
    color: base_polygon.Color = None,
    normal: base_polygon.Normal = None,
    facade: base_polygon.Facade = None,
    facade_tile: base_polygon.FacadeTile = base_polygon.TILE,
    invert_height: base_polygon.InvertHeight = False,
    no_exif: Annotated[
        bool, typer.Option("--no-exif", help="Keep the rows as stored: do not turn images as their Exif tags say.")
    ] = False,
    height_scale: Annotated[
        float | None,
        typer.Option(
            parser=options.number,
            help="Height of white, world units; the map's longer side is 1. With --texel-size: in the map's own units. "
            "Without: 0.15, or the true proportions where the size of a texel is known.",
        ),
    ] = None,
    texel_size: Annotated[
        options.Pair | None,
        typer.Option(
            parser=options.one_or_two,
            metavar="A[,B]",
            help="Width (and height) of a texel in the units of the heights. Without: what a GeoTIFF or .hgt says.",
        ),
    ] = None,
    eye: Annotated[
        options.Vector,
        typer.Option(
            parser=options.vector, metavar="X,Y,Z", help="The eye; z is up, the map is centred at the origin."
        ),
    ] = options.Vector(0.6, -1.25, 0.95),
    target: Annotated[
        options.Vector, typer.Option(parser=options.vector, metavar="X,Y,Z", help="The point looked at.")
    ] = options.Vector(0, 0, 0),
    fov: Annotated[float, typer.Option(parser=options.number, help="Vertical field of view, degrees.")] = 45.0,
    near: options.Near = None,
    far: options.Far = None,
    light: base_polygon.LightDirection = base_polygon.LIGHT,
    size: Annotated[
        options.Size, typer.Option(parser=options.size, metavar="WxH", help="Pixels of the picture.")
    ] = options.Size(640, 480),
    steps: Annotated[int, typer.Option(parser=options.whole, help="N, steps of the linear search.")] = 10,
    binary_steps: Annotated[int, typer.Option(parser=options.whole, help="M, steps of the binary search.")] = 6,
    delta: Annotated[
        float,
        typer.Option(parser=options.number, help="--facade: threshold of a steep wall, in units of the height."),
    ] = 0.1,
    shadow_steps: Annotated[
        int, typer.Option(parser=options.whole, help="Samples towards the light; 0: no self-shadow.")
    ] = 0,
    interval: Annotated[Interval, typer.Option(help="Stretch of the view ray that is searched.")] = Interval.paper,
    faces: Annotated[FaceSet, typer.Option(help="Faces of the volume that are drawn.")] = FaceSet.auxiliary,
    method: Annotated[
        Method, typer.Option(help="Search for the hit; from relief on, systems to compare with: shapes sink, not rise.")
    ] = PROTRUDED,
    lod_bias: Annotated[
        float, typer.Option(parser=options.number, help="mcguire: level of the mip chain that heights come from.")
    ] = 1.0,
    min_steps: Annotated[
        int, typer.Option(parser=options.whole, help="tatarchuk: steps where the view is straight down.")
    ] = 8,
    max_steps: Annotated[
        int, typer.Option(parser=options.whole, help="tatarchuk: steps where the view is horizontal.")
    ] = 50,
    distance_layers: Annotated[
        int, typer.Option(parser=options.whole, help="donnelly: layers of the distance texture.")
    ] = 32,
) -> Described:
    """What the options describe. Raises ValueError and OSError for maps and numbers that make no scene."""
    from ibr_ref import displacement
    from ibr_ref.scene import Camera, Light

    heights, normals = base_polygon.read_maps(
        height,
        normal_height,
        normal,
        invert_height=invert_height,
        exif=not no_exif,
        kind=height_format and height_format.value,
        size=height_size,
        order=height_order and height_order.value,
        height_range=height_range,
        nodata=nodata,
        fill=fill,
    )
    polygon = base_polygon.polygon(
        heights,
        normals,
        color,
        facade,
        proportions=heights.proportions(height_scale, texel_size),
        facade_tile=facade_tile,
        exif=not no_exif,
    )
    del heights
    params = displacement.Params(
        linear_steps=steps,
        binary_steps=binary_steps,
        steep_threshold=delta,
        shadow_steps=shadow_steps,
        interval=interval.value,
        faces=faces.value,
        method=str(method),
        lod_bias=lod_bias,
        min_steps=min_steps,
        max_steps=max_steps,
        distance_layers=distance_layers,
    )
    view = Camera.look_at(
        eye=eye, target=target, up=options.up(eye, target), vertical_fov=fov, width=size.width, height=size.height
    )
    scene = displacement.Scene(
        polygons=[polygon],
        camera=view.fitted(displacement.bounding_points([polygon], view, params), near=near, far=far),
        light=Light(direction=light),
        background=(1.0, 1.0, 1.0),
    )
    return Described(scene, params, {})


@beside(read)
def command(
    out: options.Out,
    path: pictures.CameraPath = None,
    frames: pictures.Frames = 120,
    video: pictures.Video = None,
    fps: pictures.Fps = 30.0,
    scheduler: pictures.Scheduler = None,
    depth_set: depth_set_options.OneDepthImage = None,
    bits: options.Bits = 8,
    stages: Annotated[Path | None, typer.Option(help="Also write every stage array, as .npz.")] = None,
    case: own_case.Folder = None,
    **described: Any,
) -> None:
    """Protruded displacement mapping (Yoo & Han 2006) of a height map and a colour map."""
    whole = {"stages": stages, "depth_set": depth_set}
    wanted = pictures.Wanted(
        out=out,
        bits=bits,
        path=path,
        frames=frames,
        video=video,
        fps=fps,
        scheduler=scheduler,
        fov=described["fov"],
        whole=whole,
    )
    with progress(3) as step:
        step("reading maps")
        from ibr_ref import displacement, io

        wanted.check(*described["size"])
        own_case.check_writable(case)
        if stages is not None:
            io.check_writable(stages)
        scene, params, *_ = read(**described)
        near, far = described["near"], described["far"]
        shown, frame = pictures.draw(
            wanted,
            scene,
            params,
            lambda scene, **rows: displacement.render(scene, params, stages=stages is not None, **rows),
            lambda camera: camera.fitted(
                displacement.bounding_points(scene.polygons, camera, params), near=near, far=far
            ),
            step,
        )
        if frame is not None:
            pictures.write(wanted, frame, step, stages=stages, depth_set=depth_set, camera=scene.camera)
    own_case.write(case, scene, params)
    emptiness.say(shown, lambda: displacement.culled(scene, params))


def goes_with() -> dict[str, Beside]:
    """Beside which others each option is read."""
    from ibr_ref.displacement.inputs import READ_BY

    def read(field: str, **others: Any) -> Beside:
        return Beside(f"others do not read {field}", {"method": READ_BY[field], **others})

    walls = READ_BY["steep_threshold"]
    return {
        **{name: read(name) for name in signature(command).parameters if name in READ_BY},
        **always(
            "out",
            "bits",
            "depth_set",
            "height",
            "color",
            "invert_height",
            "height_scale",
            "near",
            "far",
        ),
        **always("fov", "no_exif", "light", "size", "shadow_steps", "method", "stages"),
        **pictures.goes_with("eye", "target"),
        **{
            name: Beside("it says how --height is read", {"height": GIVEN})
            for name in ("height_format", "height_size", "height_order", "height_range", "nodata", "fill", "texel_size")
        },
        "normal_height": Beside("it holds both", {"height": ABSENT, "normal": ABSENT}),
        "normal": Beside("--normal-height holds the normals", {"normal_height": ABSENT}),
        "facade": read("facade_map"),
        "case": Beside(own_case.WHY, {"method": named("displacement").judged[1]}),
        "facade_tile": Beside("facade_tile is the size of its tiles", {"facade": GIVEN}),
        "steps": read("linear_steps"),
        "binary_steps": Beside(
            "for others binary_steps only number the hits",
            {"method": READ_BY["binary_steps"]},
            {"method": "exact", "stages": GIVEN},
        ),
        "delta": Beside(
            "steep_threshold says what is covered by the facade",
            {"method": walls, "facade": GIVEN},
            {"method": walls, "stages": GIVEN},
        ),
    }
