"""Height maps of any file, in [0, 1], and what 0 and 1 stand for."""

from __future__ import annotations

from dataclasses import dataclass
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ibr_ref.choices import BYTE_ORDERS, HEIGHT_KINDS
from ibr_ref.io.elevations import Elevations, of_file
from ibr_ref.io.files import contents, naming
from ibr_ref.scene import checks

DEFAULT_SCALE = 0.15
"""World units of height 1 where nothing says what it is: the map's longer side is 1."""


@dataclass(frozen=True, kw_only=True, eq=False)
class HeightMap:
    """Heights for a `BasePolygon`, and their own units: metres, or steps of the file's integers."""

    values: NDArray[np.float64]
    """(H, W) in [0, 1], row 0 on top."""
    low: float
    """The height, in its own units, that is 0."""
    high: float
    """The height that is 1, > low."""
    texel_size: tuple[float, float] | None = None
    """Width and height of a texel in the same units, where the file says it."""

    def proportions(
        self, height_scale: float | None = None, texel_size: tuple[float, float] | None = None
    ) -> tuple[float, float, float]:
        """World units of the map's width, its height in the picture's plane, and its relief: the longer side is 1.

        texel_size: width and height of a texel, > 0, in the heights' own units; then height_scale is what 1 stands for in
        those units, `high - low` if it is left out: the true proportions. With neither, the file's own texel size if it
        has one. height_scale alone, > 0, is in world units; where nothing is known it is 0.15 and texels are squares.
        """
        if height_scale is not None:
            checks.number("height_scale", height_scale, above=0.0)
        own = texel_size if texel_size is not None or height_scale is not None else self.texel_size
        width, height = (1.0, 1.0) if own is None else checks.vector("texel_size", own, 2).tolist()
        if not (width > 0.0 and height > 0.0):
            raise checks.reject("texel_size", [width, height], "a width and a height > 0")
        across, along = self.values.shape[1] * width, self.values.shape[0] * height
        longest = max(across, along)
        if own is None:
            return across / longest, along / longest, DEFAULT_SCALE if height_scale is None else height_scale
        relief = self.high - self.low if height_scale is None else height_scale
        return across / longest, along / longest, relief / longest


def read_height_map(
    path: str | PathLike[str],
    exif: bool = True,
    *,
    kind: str | None = None,
    size: tuple[int, int] | None = None,
    order: str | None = None,
    height_range: tuple[float, float] | None = None,
    nodata: float | None = None,
    fill: float | None = None,
) -> HeightMap:
    """Read a height map: PNG, JPEG, TIFF, GeoTIFF, EXR, PFM, HGT, raw samples or a Terrarium tile.

    kind: "hgt", "raw" or "terrarium" for a file that does not say it; without, by content, and HGT and raw samples by the
        name's ending (.hgt; .raw, .r8, .r16, .r32).
    size, order: of raw samples, (width, height) and "little" (without) or "big"; their length says of how many bytes they
        are: 1 and 2 are unsigned, 4 floats.
    height_range: (low, high), the heights that become 0 and 1, in the file's own numbers: as stored, or, where a GeoTIFF has
        a scale and an offset, stored x scale + offset. Without: for unsigned integers all that their bits can say, for
        others (0, 1). There must be no heights outside.
    nodata: the stored number where there is no height; without, the file's own (GeoTIFF; HGT: -32768).
    fill: the height given to where there is none, in the file's own numbers; without, such a file is refused.

    Of RGB with equal channels, but for 4 / 255 of white, the green one is read; of RGB + alpha the alpha of a normal map
    with the heights packed into it (Yoo & Han 2006), unless the colours are grey. exif: as in `read_image`. EXR and TIFF
    need the extra `ibr_ref[io]`.

    Raises OSError or ValueError, in one line that starts with the path: for what `read_image` and `read_values` refuse, for
    colour pictures, heights outside the range, none where no fill is given, NaN and infinities.
    """
    _check_options(kind, size, order, nodata, fill)
    wanted = None if height_range is None else _range(height_range)
    data = contents(path)
    with naming(path):
        elevations = of_file(data, Path(path), exif, kind, size, order)
        del data
        heights = _filled(elevations, elevations.nodata if nodata is None else nodata, fill)
        low, high = wanted or (0.0, 1.0 if elevations.white is None else elevations.white)
        values = _within(heights, low, high)
    return HeightMap(values=values, low=low, high=high, texel_size=elevations.texel_size)


def read_height(path: str | PathLike[str], exif: bool = True, **options: Any) -> NDArray[np.float64]:
    """Read a height map (H, W) in [0, 1], row 0 on top, of any of the files of `read_height_map`, whose options it takes."""
    return read_height_map(path, exif, **options).values


def _check_options(
    kind: str | None,
    size: tuple[int, int] | None,
    order: str | None,
    nodata: float | None,
    fill: float | None,
) -> None:
    if kind is not None:
        checks.choice("kind", kind, HEIGHT_KINDS)
    if order is not None:
        checks.choice("order", order, BYTE_ORDERS)
    if size is not None:
        for side in checks.vector("size", size, 2).tolist():
            checks.whole("size", side, low=1, high=2**28)
    if fill is not None:
        checks.number("fill", fill)
    if nodata is not None and not np.isnan(nodata):
        checks.number("nodata", nodata)


def _range(found: ArrayLike) -> tuple[float, float]:
    """Two numbers whose difference is one."""
    low, high = checks.vector("height_range", found, 2).tolist()
    if not (low < high and np.isfinite(high - low)):
        raise checks.reject("height_range", [low, high], "two numbers, the first below the second")
    return low, high


def _filled(elevations: Elevations, nodata: float | None, fill: float | None) -> NDArray[np.float64]:
    """A new array of heights (H, W) in their own units, all finite."""
    stored = elevations.stored
    heights = np.array(stored, np.float64, order="C")  # changed in place from here on: large maps take memory enough
    if (elevations.scale, elevations.offset) != (1.0, 0.0):
        heights *= elevations.scale
        heights += elevations.offset
    void = np.zeros(stored.shape, np.bool_) if nodata is None else _is(stored, nodata)
    if void.any():
        if fill is None:
            raise ValueError(
                f"found {_counted(void)} without a height ({nodata:g}), allowed: none, or a fill for them (--fill)"
            )
        heights[void] = fill
    bad = ~np.isfinite(heights)
    if bad.any():
        first = heights[tuple(np.argwhere(bad)[0])]
        raise ValueError(
            f"found {_counted(bad)} with the height {first:g}, allowed: numbers, or --nodata nan and a --fill"
        )
    return heights


def _is(stored: NDArray[Any], value: float) -> NDArray[np.bool_]:
    """Where the stored numbers are the value: of floats its nearest, as files write it with few or many digits."""
    nearest = stored.dtype.type(value) if stored.dtype.kind == "f" else value
    found: NDArray[np.bool_] = np.isnan(stored) if np.isnan(value) else np.equal(stored, nearest)
    return found


def _within(heights: NDArray[np.float64], low: float, high: float) -> NDArray[np.float64]:
    """Heights from low to high as 0 to 1, in place."""
    lowest, highest = float(heights.min()), float(heights.max())
    if lowest < low or highest > high:
        outside = int(np.count_nonzero(heights < low) + np.count_nonzero(heights > high))
        raise ValueError(
            f"found heights from {lowest:g} to {highest:g}, {outside} of {heights.size} texels outside, allowed: "
            f"{low:g} to {high:g}; a height_range (--height-range LOW,HIGH) says what becomes 0 and 1"
        )
    if (low, high) != (0.0, 1.0):
        heights -= low
        heights /= high - low
    return heights


def _counted(mask: NDArray[np.bool_]) -> str:
    """How many texels, and the first of them."""
    row, column = np.argwhere(mask)[0].tolist()
    return f"{int(np.count_nonzero(mask))} of {mask.size} texels (the first in row {row}, column {column})"
