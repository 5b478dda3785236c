"""What the paper compares with (section 2.3, Lee & Ihm 2001): n x n maps made beforehand, and no warp.

For a place between the maps the nearest one is taken, or the mix of the four around it. They are held raw, or compressed
with random access to their blocks (`haar`).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ibr_ref.array_types import Floats
from ibr_ref.pipeline.sampling import lerp
from ibr_ref.shadows import haar, maps
from ibr_ref.shadows.inputs import Params, Scene
from ibr_ref.shadows.prepared import source_of, texels_at, view_of
from ibr_ref.shadows.samples import samples_of, widened_range

Lookup = Callable[[int, int], Floats]
"""The map (S, S) of row j and column i, as numbers from 0 to 1."""


@dataclass(frozen=True, kw_only=True, eq=False)
class MapGrid:
    """n x n shadow maps, evenly spaced over the widened range of the object. Made by `prepare_grid`."""

    ends: Floats
    """(2, 2) (x0, y0) and (x1, y1): the first and the last map's offsets."""
    count: int
    """n."""
    held: list[list[haar.Blocks]] | NDArray[Any]
    """(n, n, S, S): uint8 counts of samples or float64 depths; or n lists of n compressed maps."""
    size: int
    """S."""
    content: str
    samples: int
    """k: a mask's texel is its count over k^2."""
    error: tuple[float, float]
    """Largest and mean absolute difference between the maps as they were rendered and as they are held."""
    source: str
    """Digest of caster, axes and light, to tell maps of another scene."""

    @property
    def storage(self) -> str:
        """Raw or haar."""
        return "raw" if isinstance(self.held, np.ndarray) else "haar"

    @property
    def nbytes(self) -> int:
        """Bytes of all maps as they are held."""
        if isinstance(self.held, np.ndarray):
            return self.held.nbytes
        return sum(blocks.nbytes for line in self.held for blocks in line)

    def image(self, j: int, i: int) -> Floats:
        """(S, S) one map, decoded."""
        if isinstance(self.held, np.ndarray):
            return maps.values(self.held[j, i], self.samples)
        return haar.decode(self.held[j][i], self.size)


def ends_of(scene: Scene, params: Params) -> Floats:
    """(2, 2) offsets of the first and the last map."""
    return np.stack(widened_range(scene, samples_of(scene, params)))


def position(ends: Floats, count: int, j: int, i: int) -> Floats:
    """(2,) offset of the map of row j and column i."""
    return np.array([lerp(ends[0, k], ends[1, k], index / (count - 1)) for k, index in enumerate((i, j))])


def rendered(scene: Scene, params: Params) -> Lookup:
    """A lookup that renders a map when it is asked for, and holds none: the same values as those of `prepare_grid`."""
    ends, view = ends_of(scene, params), view_of(scene, params.map_size)

    def image(j: int, i: int) -> Floats:
        texels = texels_at(view, position(ends, params.grid_size, j, i), params)
        values = maps.values(texels, params.map_samples)
        if params.grid_storage == "raw":
            return values
        return haar.decode(haar.encode(values, params.grid_threshold), params.map_size)

    return image


def prepare_grid(scene: Scene, params: Params) -> MapGrid:
    """Render all n x n maps of `Params.grid_size`, and compress them for grid_storage="haar".

    At the paper's 32 x 32 of 512 x 512 texels they take 256 MB raw, as bytes; depths eight times that.
    """
    ends, view, n = ends_of(scene, params), view_of(scene, params.map_size), params.grid_size
    shape = (n, n, params.map_size, params.map_size)
    raw = (
        np.empty(shape, np.uint8 if params.content == "mask" else np.float64) if params.grid_storage == "raw" else None
    )
    compressed: list[list[haar.Blocks]] = [[] for _ in range(n)]
    largest, total = 0.0, 0.0
    for j in range(n):
        for i in range(n):
            texels = texels_at(view, position(ends, n, j, i), params)
            if raw is not None:
                raw[j, i] = texels
                continue
            values = maps.values(texels, params.map_samples)
            blocks = haar.encode(values, params.grid_threshold)
            difference = np.abs(haar.decode(blocks, params.map_size) - values)
            largest, total = max(largest, float(difference.max())), total + float(difference.mean())
            compressed[j].append(blocks)
    return MapGrid(
        ends=ends,
        count=n,
        held=compressed if raw is None else raw,
        size=params.map_size,
        content=params.content,
        samples=params.map_samples,
        error=(largest, total / (n * n)),
        source=source_of(scene),
    )


def _cell(value: float, low: float, high: float, count: int) -> tuple[int, float]:
    """The map below a coordinate, and the fraction towards the next one."""
    place = (value - low) / (high - low) * (count - 1)
    index = min(max(int(place), 0), count - 2)
    return index, place - index


def image_at(lookup: Lookup, ends: Floats, count: int, offset: Floats, mix: bool) -> Floats:
    """(S, S) the map for an offset: the mix of the four around it, or the nearest."""
    i, s = _cell(float(offset[0]), ends[0, 0], ends[1, 0], count)
    j, t = _cell(float(offset[1]), ends[0, 1], ends[1, 1], count)
    if not mix:
        return lookup(j if t < 0.5 else j + 1, i if s < 0.5 else i + 1)
    top = lookup(j, i) * (1.0 - s) + lookup(j, i + 1) * s
    bottom = lookup(j + 1, i) * (1.0 - s) + lookup(j + 1, i + 1) * s
    return np.asarray(top * (1.0 - t) + bottom * t)
