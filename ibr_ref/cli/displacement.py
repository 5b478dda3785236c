"""`ibr-ref render displacement`."""

from __future__ import annotations

from dataclasses import dataclass
from inspect import signature
from typing import TYPE_CHECKING, Annotated, Any

import typer

from ibr_ref.choices import FACES, INTERVALS
from ibr_ref.cli import base_polygon, depth_set_options, emptiness, options, own_case, pictures
from ibr_ref.cli.described import Described, beside
from ibr_ref.cli.groups import grouped, told
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
    from ibr_ref.displacement import Params
    from ibr_ref.scene import BasePolygon, Camera

    Method = str
    Interval = str
    FaceSet = str
else:
    Method = options.choices("Method", SEARCHES, "Search for the hit.")
    Interval = options.choices("Interval", INTERVALS, "Stretch of the view ray that is searched.")
    FaceSet = options.choices("FaceSet", FACES, "Faces of the volume that are drawn.")
PROTRUDED, PAPER, AUXILIARY = Method("protruded"), Interval("paper"), FaceSet("auxiliary")


@dataclass(frozen=True, kw_only=True)
class View:
    """Options: the camera and the light."""

    eye: Annotated[
        options.Vector,
        typer.Option(
            parser=options.vector, metavar="X,Y,Z", help="The eye; z is up, the map is centred at the origin."
        ),
    ] = options.Vector(0.6, -1.25, 0.95)
    target: Annotated[
        options.Vector, typer.Option(parser=options.vector, metavar="X,Y,Z", help="The point looked at.")
    ] = options.Vector(0, 0, 0)
    fov: Annotated[float, typer.Option(parser=options.number, help="Vertical field of view, degrees.")] = 45.0
    near: options.Near = None
    far: options.Far = None
    light: base_polygon.LightDirection = base_polygon.LIGHT
    size: Annotated[options.Size, typer.Option(parser=options.size, metavar="WxH", help="Pixels of the picture.")] = (
        options.Size(640, 480)
    )


@dataclass(frozen=True, kw_only=True)
class Search:
    """Options: the fields of Params, two of them under shorter names."""

    steps: Annotated[int, typer.Option(parser=options.whole, help="N, steps of the linear search.")] = 10
    binary_steps: Annotated[int, typer.Option(parser=options.whole, help="M, steps of the binary search.")] = 6
    delta: Annotated[
        float,
        typer.Option(parser=options.number, help="--facade: threshold of a steep wall, in units of the height."),
    ] = 0.1
    shadow_steps: Annotated[
        int, typer.Option(parser=options.whole, help="Samples towards the light; 0: no self-shadow.")
    ] = 0
    interval: Annotated[Interval, typer.Option(help="Stretch of the view ray that is searched.")] = PAPER
    faces: Annotated[FaceSet, typer.Option(help="Faces of the volume that are drawn.")] = AUXILIARY
    method: Annotated[
        Method, typer.Option(help="Search for the hit; from relief on, systems to compare with: shapes sink, not rise.")
    ] = PROTRUDED
    lod_bias: Annotated[
        float, typer.Option(parser=options.number, help="mcguire: level of the mip chain that heights come from.")
    ] = 1.0
    min_steps: Annotated[
        int, typer.Option(parser=options.whole, help="tatarchuk: steps where the view is straight down.")
    ] = 8
    max_steps: Annotated[
        int, typer.Option(parser=options.whole, help="tatarchuk: steps where the view is horizontal.")
    ] = 50
    distance_layers: Annotated[
        int, typer.Option(parser=options.whole, help="donnelly: layers of the distance texture.")
    ] = 32


@grouped
def read(maps: base_polygon.Maps, view: View, search: Search) -> Described:
    """What the options describe. Raises ValueError and OSError for maps and numbers that make no scene."""
    from ibr_ref import displacement
    from ibr_ref.scene import Light

    polygon = base_polygon.polygon(maps)
    others = told(search, "steps", "delta")
    params = displacement.Params(linear_steps=search.steps, steep_threshold=search.delta, **others)
    scene = displacement.Scene(
        polygons=[polygon],
        camera=_camera(polygon, params, view),
        light=Light(direction=view.light),
        background=(1.0, 1.0, 1.0),
    )
    return Described(scene, params, {})


def _camera(polygon: BasePolygon, params: Params, view: View) -> Camera:
    """The view's, with planes around all that there is, or where they are given."""
    from ibr_ref import displacement
    from ibr_ref.scene import Camera

    up, (width, height) = options.up(view.eye, view.target), view.size
    camera = Camera.look_at(eye=view.eye, target=view.target, up=up, vertical_fov=view.fov, width=width, height=height)
    return camera.fitted(displacement.bounding_points([polygon], camera, params), near=view.near, far=view.far)


@beside(read)
def command(
    *,
    picture: pictures.Picture,
    depth_set: depth_set_options.OneDepthImage = None,
    kept: pictures.Kept,
    **described: Any,
) -> None:
    """Protruded displacement mapping (Yoo & Han 2006) of a height map and a colour map."""
    wanted = pictures.Wanted(picture, kept, fov=described["fov"], whole={"depth_set": depth_set})
    with progress(3) as step:
        step("reading maps")
        from ibr_ref import displacement

        wanted.check(described["size"])
        scene, params, *_ = read(**described)
        near, far = described["near"], described["far"]
        shown, frame = pictures.draw(
            wanted,
            scene,
            params,
            lambda scene, **rows: displacement.render(scene, params, stages=kept.stages is not None, **rows),
            lambda camera: camera.fitted(
                displacement.bounding_points(scene.polygons, camera, params), near=near, far=far
            ),
            step,
        )
        if frame is not None:
            pictures.write(wanted, frame, step, depth_set=depth_set, camera=scene.camera)
    own_case.write(kept.case, scene, params)
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
