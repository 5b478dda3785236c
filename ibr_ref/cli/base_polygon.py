"""The maps of `ibr-ref render displacement`, and they on a rectangle of their own shape."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from ibr_ref.choices import BYTE_ORDERS, HEIGHT_KINDS
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

if TYPE_CHECKING:
    HeightFormat = str
    ByteOrder = str
else:
    HeightFormat = options.choices("HeightFormat", HEIGHT_KINDS, "Of a height file that does not say it.")
    ByteOrder = options.choices("ByteOrder", BYTE_ORDERS, "Of raw samples.")

_MOST_GREYS = 2048
"""Texels a side of the colours made of heights: a large map's would take three times its memory."""


@dataclass(frozen=True, kw_only=True)
class Maps:
    """Options: the maps, how their files are read, and the size of what they are on."""

    height: Annotated[
        Path | None,
        typer.Option(help="Height map, white is high: PNG, JPEG, TIFF, GeoTIFF, EXR, PFM, .hgt, .raw, .r16, .r32."),
    ] = None
    height_format: Annotated[
        HeightFormat | None, typer.Option(help="Of a file that does not say it. Without: content, .hgt, .raw.")
    ] = None
    height_size: Annotated[
        options.Size | None,
        typer.Option(
            parser=options.size, metavar="WxH", help="Samples of a raw file: of 1, 2 (unsigned) or 4 bytes (float)."
        ),
    ] = None
    height_order: Annotated[ByteOrder | None, typer.Option(help="Byte order of a raw file. Without: little.")] = None
    height_range: Annotated[
        options.Pair | None,
        typer.Option(
            parser=options.pair,
            metavar="LOW,HIGH",
            help="Heights that become 0 and 1, in the file's numbers. Without: all that unsigned integers can say; others "
            "must lie in [0, 1].",
        ),
    ] = None
    nodata: Annotated[
        float | None,
        typer.Option(parser=options.number, help="Number that stands for no height. Without: the file's own."),
    ] = None
    fill: Annotated[
        float | None, typer.Option(parser=options.number, help="Height given to where there is none; without, refused.")
    ] = None
    normal_height: Annotated[
        Path | None,
        typer.Option(help="Instead of --height and --normal: RGBA, the normal in RGB, the height in alpha."),
    ] = None
    color: Color = None
    normal: Normal = None
    facade: Facade = None
    facade_tile: FacadeTile = TILE
    invert_height: InvertHeight = False
    no_exif: Annotated[
        bool, typer.Option("--no-exif", help="Keep the rows as stored: do not turn images as their Exif tags say.")
    ] = False
    height_scale: Annotated[
        float | None,
        typer.Option(
            parser=options.number,
            help="Height of white, world units; the map's longer side is 1. With --texel-size: in the map's own units. "
            "Without: 0.15, or the true proportions where the size of a texel is known.",
        ),
    ] = None
    texel_size: Annotated[
        options.Pair | None,
        typer.Option(
            parser=options.one_or_two,
            metavar="A[,B]",
            help="Width (and height) of a texel in the units of the heights. Without: what a GeoTIFF or .hgt says.",
        ),
    ] = None


def polygon(maps: Maps) -> BasePolygon:
    """The maps on a rectangle: centred, z up, the images' top edge at +y. Raises ValueError and OSError for unusable ones.

    Rows are turned over: texture row 0 lies at v = 0, which must be at -y for the polygon's normal to point up.
    """
    from ibr_ref import io
    from ibr_ref.scene import BasePolygon

    heights, normals = _read(maps)
    exif = not maps.no_exif
    colors = greys(heights.values) if maps.color is None else io.read_color(maps.color, exif)
    across, along, relief = heights.proportions(maps.height_scale, maps.texel_size)
    return BasePolygon(
        corner=(-across / 2, -along / 2, 0.0),
        edge_u=(across, 0.0, 0.0),
        edge_v=(0.0, along, 0.0),
        height_map=heights.values[::-1],
        color_map=colors[::-1],
        normal_map=None if normals is None else normals[::-1],
        facade_map=None if maps.facade is None else io.read_color(maps.facade, exif),
        facade_tile=maps.facade_tile,
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


def _read(maps: Maps) -> tuple[HeightMap, NDArray[np.float64] | None]:
    """Heights, white or black the highest, and normals where there are any."""
    from ibr_ref import io

    both, exif = maps.normal_height, not maps.no_exif
    if (maps.height is None) == (both is None) or (both is not None and maps.normal is not None):
        raise typer.BadParameter("give either --height (and perhaps --normal) or --normal-height")
    if maps.height is not None:
        normals = None if maps.normal is None else io.read_normal(maps.normal, exif)
        heights = io.read_height_map(
            maps.height,
            exif,
            kind=maps.height_format and str(maps.height_format),
            size=maps.height_size,
            order=maps.height_order and str(maps.height_order),
            height_range=maps.height_range,
            nodata=maps.nodata,
            fill=maps.fill,
        )
    else:
        assert both is not None
        normals, values = io.read_normal_height(both, exif)
        heights = io.HeightMap(values=values, low=0.0, high=1.0)
    return replace(heights, values=1.0 - heights.values) if maps.invert_height else heights, normals
