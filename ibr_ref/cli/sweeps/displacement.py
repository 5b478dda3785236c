"""`ibr-ref sweep displacement`."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from ibr_ref.cli import base_polygon, options
from ibr_ref.cli.groups import grouped, told
from ibr_ref.cli.sweeps import shared
from ibr_ref.cli.what_goes_with_what import GIVEN, Beside, always

if TYPE_CHECKING:
    from ibr_ref.displacement import Scene

EXAMPLES = """
Examples:

    ibr-ref sweep displacement --height h.png --over steps=5:100:5 --over delta=0.02,0.05,0.1 --views 8
    --out sweep.parquet

    ibr-ref sweep displacement --height h.png --over steps=5:100:5 --bound wrong=0.005 --plot frontier.png

    ibr-ref sweep displacement --over method=protruded,relief,tatarchuk --bound silhouette=0.99 --cost milliseconds
"""


class Against(StrEnum):
    """What is true."""

    exact = "exact"


@dataclass(frozen=True, kw_only=True)
class Maps:
    """Options: those of `base_polygon.Maps` that a sweep has."""

    height: Annotated[
        Path | None, typer.Option(help="Height map, as `ibr-ref render` reads it. Without: the built-in box.")
    ] = None
    height_range: Annotated[
        options.Pair | None,
        typer.Option(
            parser=options.pair, metavar="LOW,HIGH", help="Heights that become 0 and 1, in the file's numbers."
        ),
    ] = None
    color: base_polygon.Color = None
    normal: base_polygon.Normal = None
    facade: base_polygon.Facade = None
    facade_tile: base_polygon.FacadeTile = base_polygon.TILE
    invert_height: base_polygon.InvertHeight = False
    height_scale: Annotated[
        float | None, typer.Option(parser=options.number, help="Height of white, world units. Without: 0.15.")
    ] = None


@dataclass(frozen=True, kw_only=True)
class View:
    """Options: the first view, and the light."""

    eye: Annotated[
        options.Vector, typer.Option(parser=options.vector, metavar="X,Y,Z", help="The eye of the first view.")
    ] = options.Vector(0.6, -1.25, 0.95)
    target: Annotated[
        options.Vector, typer.Option(parser=options.vector, metavar="X,Y,Z", help="Point that it looks at.")
    ] = options.Vector(0, 0, 0)
    light: base_polygon.LightDirection = base_polygon.LIGHT
    size: shared.Size = shared.SMALL


@grouped
def command(
    *,
    maps: Maps,
    view: View,
    views: shared.Views = 1,
    against: Annotated[
        Against, typer.Option(help="What is true: the first intersection with the solid.")
    ] = Against.exact,
    wanted: shared.Wanted,
) -> None:
    """Which parameters does my height map need? Every combination from every view, against the first intersection.

    Measures: wrong (share of the pixels), silhouette, smear, drift, fetches, milliseconds.
    """
    shared.run("displacement", wanted, views, lambda: (_scene(maps, view), against.value))


def _scene(maps: Maps, view: View) -> Scene:
    from ibr_ref import displacement, models
    from ibr_ref.scene import Camera, Light

    polygon = models.box() if maps.height is None else base_polygon.polygon(base_polygon.Maps(**told(maps)))
    up, (width, height) = options.up(view.eye, view.target), view.size
    camera = Camera.look_at(eye=view.eye, target=view.target, up=up, vertical_fov=45.0, width=width, height=height)
    return displacement.Scene(
        polygons=[polygon],
        camera=camera.fitted(displacement.bounding_points([polygon], camera)),
        light=Light(direction=view.light),
        background=(1.0, 1.0, 1.0),
    )


def goes_with() -> dict[str, Beside]:
    """Beside which others each option is read."""
    of_file = ("height_range", "color", "normal", "facade", "invert_height", "height_scale")
    return {
        **shared.goes_with(),
        **always("height", "eye", "target", "light"),
        **{name: Beside("the built-in box has its own maps", {"height": GIVEN}) for name in of_file},
        "facade_tile": Beside("facade_tile is the size of its tiles", {"facade": GIVEN}),
    }
