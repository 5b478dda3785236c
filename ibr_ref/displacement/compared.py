"""The systems that the paper compares with (its table 1), and three later ones: their searches, on the base face alone.

Each has a kernel of its own, compiled when it is first asked for. It is given the point of every pixel on the polygon, and
finds the hit there; `fragment.draw` takes it from there as from any other search. What a system needs beforehand (a mip
chain, distances, cones, a quadtree) is made once for each polygon.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple
from weakref import WeakKeyDictionary

import numpy as np
from numpy.typing import NDArray

from ibr_ref.displacement import cones, maximum_mipmap
from ibr_ref.displacement.buffers import Hits, Uniforms
from ibr_ref.displacement.cone import cone_search
from ibr_ref.displacement.donnelly import MOST_VOXELS, distance_texture, donnelly_search
from ibr_ref.displacement.fragment import Map, base_points
from ibr_ref.displacement.inputs import Params
from ibr_ref.displacement.mcguire import levels_at, mcguire_search, mip_chain
from ibr_ref.displacement.relaxed_cone import relaxed_cone_search
from ibr_ref.displacement.tatarchuk import tatarchuk_search
from ibr_ref.displacement.welsh import welsh_search
from ibr_ref.scene import BasePolygon
from ibr_ref.scene.checks import reject

Floats = NDArray[np.float64]


class Found(NamedTuple):
    """What a search finds, one element a pixel."""

    hits: Hits
    fetches: NDArray[np.int32]
    """Texture fetches of the search; 0 where the polygon does not cover the pixel."""


class _Search(NamedTuple):
    """A search's inputs."""

    polygon: BasePolygon
    heights: Floats
    """(H, W), read-only."""
    height: Map
    """The same, flat."""
    repeat: bool | None
    points: Floats
    """(3, P): the pixels' points on the polygon, NaN where it does not cover them."""
    constants: Uniforms
    params: Params
    found: Found


_PREPARED: WeakKeyDictionary[BasePolygon, dict[tuple[Any, ...], Any]] = WeakKeyDictionary()


def _prepared(search: _Search, key: tuple[Any, ...], make: Callable[[], Any]) -> Any:
    """What `make` makes, kept for as long as the polygon lives."""
    kept = _PREPARED.setdefault(search.polygon, {})
    if key not in kept:
        kept[key] = make()
    return kept[key]


def _welsh(s: _Search) -> None:
    welsh_search(s.repeat, s.points, s.constants, *s.height, *s.found)


def _mcguire(s: _Search) -> None:
    chain = _prepared(s, ("mips",), lambda: mip_chain(s.heights))
    mcguire_search(
        s.repeat, s.points, s.constants, *levels_at(chain, s.params.lod_bias), s.params.linear_steps, *s.found
    )


def _donnelly(s: _Search) -> None:
    layers = s.params.distance_layers
    if layers * s.heights.size > MOST_VOXELS:
        allowed = f"at most {MOST_VOXELS} voxels, layers x the height map's texels {s.heights.shape}"
        raise reject("distance_layers", layers, allowed)
    texels = _prepared(
        s, ("distances", layers), lambda: distance_texture(s.heights, layers, s.repeat is not None).reshape(-1)
    )
    donnelly_search(
        s.repeat, s.points, s.constants.eye, texels, s.height.columns, s.height.rows, layers, s.params.linear_steps,
        *s.found,
    )  # fmt: skip


def _tatarchuk(s: _Search) -> None:
    tatarchuk_search(
        s.repeat, s.points, s.constants, *s.height, s.params.min_steps, s.params.max_steps, *s.found
    )  # fmt: skip


def _ratios(s: _Search, relaxed: bool) -> Floats:
    key = ("cones", relaxed)
    ratios: Floats = _prepared(
        s, key, lambda: cones.cone_map(s.heights, s.repeat is not None, relaxed).reshape(-1)
    )  # fmt: skip
    return ratios


def _cone(s: _Search) -> None:
    texels, columns, rows = s.height
    ratios = _ratios(s, relaxed=False)
    cone_search(
        s.repeat, s.points, s.constants.eye, texels, ratios, columns, rows, s.params.linear_steps, *s.found
    )  # fmt: skip


def _relaxed_cone(s: _Search) -> None:
    texels, columns, rows = s.height
    ratios = _ratios(s, relaxed=True)
    relaxed_cone_search(
        s.repeat, s.points, s.constants.eye, texels, ratios, columns, rows, s.params.linear_steps,
        s.params.binary_steps, *s.found,
    )  # fmt: skip


def _maximum_mipmap(s: _Search) -> None:
    tree = _prepared(s, ("quadtree",), lambda: maximum_mipmap.build(s.heights, s.repeat is not None))
    maximum_mipmap.maximum_mipmap_search(s.repeat, s.points, s.constants.eye, *s.height, tree, *s.found)


SEARCHES: dict[str, Callable[[_Search], None]] = {
    "welsh": _welsh,
    "mcguire": _mcguire,
    "donnelly": _donnelly,
    "tatarchuk": _tatarchuk,
    "cone": _cone,
    "relaxed_cone": _relaxed_cone,
    "maximum_mipmap": _maximum_mipmap,
}
"""By the names of `inputs.METHODS`."""


def search(
    params: Params, polygon: BasePolygon, height: Map, constants: Uniforms, triangles: Any, width: int, rows: int
) -> Found:
    """The hits of a polygon's base face, `triangles`, in a picture of so many columns and rows of pixels."""
    pixels = width * rows
    found = Found(_no_hits(pixels), np.zeros(pixels, np.int32))
    points = np.full((3, pixels), np.nan)
    base_points(triangles, width, rows, points)
    repeat = True if polygon.domain == "repeat" else None
    heights = np.asarray(polygon.height_map, np.float64)
    SEARCHES[params.method](_Search(polygon, heights, height, repeat, points, constants, params, found))
    return found


def _no_hits(pixels: int) -> Hits:
    """Hits that are all discarded; no decision was close."""

    def full(value: float) -> Floats:
        return np.full(pixels, value)

    return Hits(
        linear_index=np.full(pixels, -1, np.int32),
        hit_index=np.full(pixels, -1, np.int32),
        u=full(np.nan),
        v=full(np.nan),
        h=full(np.nan),
        height_before=full(0.0),
        steep=np.zeros(pixels, np.bool_),
        margin=full(np.inf),
        domain_margin=full(np.inf),
        steep_margin=full(np.inf),
        depth=full(np.nan),
    )
