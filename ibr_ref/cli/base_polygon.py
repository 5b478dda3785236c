"""The maps of `ibr-ref render displacement` on a rectangle of their own shape."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from ibr_ref.cli import options

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from ibr_ref.io import HeightMap
    from ibr_ref.scene import BasePolygon

Color = Annotated[Path | None, typer.Option(help="Colour map. Without: greys by height.")]
Normal = Annotated[Path | None, typer.Option(help="Normal map (+y is up). Without: from the heights.")]
Facade = Annotated[Path | None, typer.Option(help="Tile that covers steep walls.")]
FacadeTile = Annotated[
    options.Pair, typer.Option(parser=options.pair, metavar="W,H", help="Size of a facade tile, world units.")
]
TILE = options.Pair(0.1, 0.1)
InvertHeight = Annotated[bool, typer.Option("--invert-height", help="White is deep in the height map.")]
LightDirection = Annotated[
    options.Vector, typer.Option(parser=options.vector, metavar="X,Y,Z", help="Direction towards the light.")
]
LIGHT = options.Vector(-0.6, -0.5, 1)

_MOST_GREYS = 2048
"""Texels a side of the colours made of heights: a large map's would take three times its memory."""


def polygon(
    heights: HeightMap,
    normals: NDArray[np.float64] | None,
    color: Path | None,
    facade: Path | None,
    *,
    proportions: tuple[float, float, float],
    facade_tile: tuple[float, float],
    exif: bool,
) -> BasePolygon:
    """The maps on a rectangle: centred, z up, the images' top edge at +y. proportions: its width, its height, its relief.

    Rows are turned over: texture row 0 lies at v = 0, which must be at -y for the polygon's normal to point up.
    """
    from ibr_ref import io
    from ibr_ref.scene import BasePolygon

    colors = greys(heights.values) if color is None else io.read_color(color, exif)
    across, along, relief = proportions
    return BasePolygon(
        corner=(-across / 2, -along / 2, 0.0),
        edge_u=(across, 0.0, 0.0),
        edge_v=(0.0, along, 0.0),
        height_map=heights.values[::-1],
        color_map=colors[::-1],
        normal_map=None if normals is None else normals[::-1],
        facade_map=None if facade is None else io.read_color(facade, exif),
        facade_tile=facade_tile,
        height_scale=relief,
    )


def greys(heights: NDArray[np.float64]) -> NDArray[np.float64]:
    """Colours (h, w, 3) by height: of each texel, or of those in the middle where there are more than 2048 a side."""
    import numpy as np  # here: an answer to --help must not wait for it

    rows, columns = (
        ((np.arange(count) + 0.5) * side / count).astype(int)
        for side, count in ((side, min(side, _MOST_GREYS)) for side in heights.shape)
    )
    return 0.25 + 0.65 * heights[np.ix_(rows, columns)][..., None].repeat(3, axis=2)


def read_maps(
    height: Path | None,
    normal_height: Path | None,
    normal: Path | None,
    *,
    invert_height: bool,
    exif: bool,
    **options: Any,
) -> tuple[HeightMap, NDArray[np.float64] | None]:
    """Heights, white or black the highest, and normals where there are any. options: of `io.read_height_map`."""
    from ibr_ref import io

    if (height is None) == (normal_height is None) or (normal_height is not None and normal is not None):
        raise typer.BadParameter("give either --height (and perhaps --normal) or --normal-height")
    if height is not None:
        normals = None if normal is None else io.read_normal(normal, exif)
        heights = io.read_height_map(height, exif, **options)
    else:
        assert normal_height is not None
        normals, values = io.read_normal_height(normal_height, exif)
        heights = io.HeightMap(values=values, low=0.0, high=1.0)
    return replace(heights, values=1.0 - heights.values) if invert_height else heights, normals
