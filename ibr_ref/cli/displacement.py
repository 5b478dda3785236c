"""`ibr-ref render displacement`."""

from __future__ import annotations

from enum import StrEnum
from inspect import signature
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from ibr_ref.cli import emptiness, options, own_case
from ibr_ref.cli.what_goes_with_what import ABSENT, GIVEN, Beside, always
from ibr_ref.methods import named
from ibr_ref.progress import progress
from ibr_ref.searches import SEARCHES

if TYPE_CHECKING:
    from ibr_ref.scene import BasePolygon

EXAMPLES = """
Examples:

    ibr-ref render displacement --height h.png --color c.png --out image.png

    ibr-ref render displacement --height h.png --invert-height --color c.png --normal n.png --height-scale 0.1 --steps 50
    --out image.png --stages dump.npz

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


class FaceSet(StrEnum):
    """Faces of the volume that are drawn."""

    auxiliary = "auxiliary"
    base = "base"
    extended = "extended"


def command(
    out: Annotated[Path, typer.Option(help="The picture: .png or .jpg.")],
    height: Annotated[
        Path | None, typer.Option(help="Height map, white is high: grey PNG (8 or 16 bits) or JPEG.")
    ] = None,
    normal_height: Annotated[
        Path | None,
        typer.Option(help="Instead of --height and --normal: RGBA, the normal in RGB, the height in alpha."),
    ] = None,
    color: Annotated[Path | None, typer.Option(help="Colour map. Without: greys by height.")] = None,
    normal: Annotated[Path | None, typer.Option(help="Normal map (+y is up). Without: from the heights.")] = None,
    facade: Annotated[Path | None, typer.Option(help="Tile that covers steep walls.")] = None,
    facade_tile: Annotated[
        options.Pair, typer.Option(parser=options.pair, metavar="W,H", help="Size of a facade tile, world units.")
    ] = options.Pair(0.1, 0.1),
    invert_height: Annotated[bool, typer.Option("--invert-height", help="White is deep in the height map.")] = False,
    no_exif: Annotated[
        bool, typer.Option("--no-exif", help="Keep the rows as stored: do not turn images as their Exif tags say.")
    ] = False,
    height_scale: Annotated[
        float, typer.Option(parser=options.number, help="Height of white, world units; the map's longer side is 1.")
    ] = 0.15,
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
    light: Annotated[
        options.Vector, typer.Option(parser=options.vector, metavar="X,Y,Z", help="Direction towards the light.")
    ] = options.Vector(-0.6, -0.5, 1),
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
    stages: Annotated[Path | None, typer.Option(help="Also write every stage array, as .npz.")] = None,
    case: own_case.Folder = None,
) -> None:
    """Protruded displacement mapping (Yoo & Han 2006) of a height map and a colour map."""
    with progress(3) as step:
        step("reading maps")
        from ibr_ref import displacement, io
        from ibr_ref.scene import Camera, Light

        io.check_image_writable(out)
        own_case.check_writable(case)
        if stages is not None:
            io.check_writable(stages)
        polygon = _polygon(
            height, normal_height, color, normal, facade, facade_tile, invert_height, height_scale, not no_exif
        )
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
        step("rendering")
        frame = displacement.render(scene, params, stages=stages is not None)
        step("writing")
        if stages is not None:
            frame.save_stages(stages)
        frame.save(out)
    own_case.write(case, scene, params)
    emptiness.say(frame, lambda: displacement.culled(scene, params))


def _polygon(
    height: Path | None,
    normal_height: Path | None,
    color: Path | None,
    normal: Path | None,
    facade: Path | None,
    facade_tile: tuple[float, float],
    invert_height: bool,
    height_scale: float,
    exif: bool,
) -> BasePolygon:
    """The maps on a rectangle of their own shape: longer side 1, centred, z up, the images' top edge at +y.

    Rows are turned over: texture row 0 lies at v = 0, which must be at -y for the polygon's normal to point up.
    """
    from ibr_ref import io
    from ibr_ref.scene import BasePolygon

    if (height is None) == (normal_height is None) or (normal_height is not None and normal is not None):
        raise typer.BadParameter("give either --height (and perhaps --normal) or --normal-height")
    normals = None if normal is None else io.read_normal(normal, exif)
    if normal_height is not None:
        normals, heights = io.read_normal_height(normal_height, exif)
    else:
        assert height is not None
        heights = io.read_height(height, exif)
    heights = 1.0 - heights if invert_height else heights
    colors = io.read_color(color, exif) if color else 0.25 + 0.65 * heights[..., None].repeat(3, axis=2)
    longest = max(heights.shape)
    across, along = heights.shape[1] / longest, heights.shape[0] / longest
    return BasePolygon(
        corner=(-across / 2, -along / 2, 0.0),
        edge_u=(across, 0.0, 0.0),
        edge_v=(0.0, along, 0.0),
        height_map=heights[::-1],
        color_map=colors[::-1],
        normal_map=None if normals is None else normals[::-1],
        facade_map=None if facade is None else io.read_color(facade, exif),
        facade_tile=facade_tile,
        height_scale=height_scale,
    )


def goes_with() -> dict[str, Beside]:
    """Beside which others each option is read."""
    from ibr_ref.displacement.inputs import READ_BY

    def read(field: str, **others: Any) -> Beside:
        return Beside(f"others do not read {field}", {"method": READ_BY[field], **others})

    walls = READ_BY["steep_threshold"]
    return {
        **{name: read(name) for name in signature(command).parameters if name in READ_BY},
        **always("out", "height", "color", "invert_height", "height_scale", "eye", "target", "fov", "near", "far"),
        **always("no_exif", "light", "size", "shadow_steps", "method", "stages"),
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
