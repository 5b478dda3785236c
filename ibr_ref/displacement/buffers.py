"""Arrays between the stages: one element a fragment, (F,), in submission order.

A band of the picture is processed at a time, so that these arrays stay in the cache. Their lengths are multiples of
LANES: the last wave runs over the end, into elements that nobody reads.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ibr_ref.array_types import Bools, Floats, Indices, Lanes
from ibr_ref.jit import LANES, device
from ibr_ref.pipeline.waves import load


class Uniforms(NamedTuple):
    """Constants of one polygon's draw call."""

    corner: Floats
    """(3,) world."""
    axes: Floats
    """(3, 3): U, V and N3 as rows, world."""
    rows: Floats
    """(3, 3): the reciprocal basis as rows; the first two are U* and V*."""
    frame: Floats
    """(3, 3): U/|U|, n x U/|U| and n as rows: the frame of the normal map."""
    lengths: Floats
    """(2,): |U| and |V|."""
    scale: float
    """World units of h = 1."""
    tile: Floats
    """(2,): width and height of a facade tile, world units."""
    eye: Floats
    """(4,) in patch space."""
    light: Floats
    """(4,) in patch space."""
    eye_world: Floats
    """(4,)."""
    light_world: Floats
    """(4,)."""
    phong: Floats
    """(3,): ambient, diffuse, specular."""
    exponent: int
    """Specular exponent."""
    view_from_world: Floats
    """(4, 4)."""
    clip_from_view: Floats
    """(4, 4)."""


class Settings(NamedTuple):
    """Parameters of the search as the kernels see them."""

    method: int
    """Index into `fragment.BUILT_IN`; -1: another search has found the hits."""
    volume: bool
    """interval="volume"."""
    bounded: bool
    """Samples outside the polygon are empty: domain="clip" in the paper's interval."""
    linear_steps: int
    binary_steps: int
    steep_threshold: float
    shadow_steps: int
    shadow_bias: float
    floor: float
    """The solid lies in [floor, floor + 1]: -1 for what sinks below the polygon."""
    polygon_depth: bool
    """depth="polygon"."""


class Fragments(NamedTuple):
    """Stage raster: what the rasterizer hands to the fragment stage."""

    pixel: NDArray[np.int64]
    """row * width + column."""
    face: Indices
    patch: Floats
    """(3, F): C, the fragment's point in patch space, u, v and h in rows."""
    depth: Floats
    """Window depth of the face."""


class Rays(NamedTuple):
    """View rays p(t) = (u, v, h) + t (du, dv, dh), t in [0, 1]. A ray with h = 2 does not go down: it meets nothing."""

    u: Floats
    v: Floats
    h: Floats
    du: Floats
    dv: Floats
    dh: Floats


class Hits(NamedTuple):
    """Stage march."""

    linear_index: Indices
    """Step at which the linear search stopped; -1 none."""
    hit_index: Indices
    """Lattice index of the hit; -1 discarded."""
    u: Floats
    """NaN: discarded."""
    v: Floats
    h: Floats
    height_before: Floats
    steep: Bools
    margin: Floats
    domain_margin: Floats
    steep_margin: Floats
    depth: Floats
    """Window depth of the hit."""


class Shades(NamedTuple):
    """Stage shade; channels in rows: (3, F)."""

    slope: Floats
    """(2, F): gradient of the height map."""
    color: Floats
    albedo: Floats
    normal: Floats
    lit: Bools
    lit_margin: Floats
    axis_margin: Floats
    facing_margin: Floats


@device
def load_rays(rays: Rays, first: int, u: Lanes, v: Lanes, h: Lanes, du: Lanes, dv: Lanes, dh: Lanes) -> None:
    """Copy a wave's rays to its lanes."""
    load(rays.u, first, u)
    load(rays.v, first, v)
    load(rays.h, first, h)
    load(rays.du, first, du)
    load(rays.dv, first, dv)
    load(rays.dh, first, dh)


@device
def over_polygon(u: float, v: float, h: float) -> bool:
    """Whether a fragment's point lies on the polygon itself: such a ray always hits something."""
    return (h == 0.0) & (u >= 0.0) & (u <= 1.0) & (v >= 0.0) & (v <= 1.0)


@device
def padded(count: int) -> int:
    """The smallest multiple of LANES that is not below count."""
    return (count + LANES - 1) // LANES * LANES


@device
def fragments_for(count: int) -> Fragments:
    """Fragments for a band; those that only a wave's rest reads are zero, which is harmless."""
    size = padded(count)
    fragments = Fragments(np.empty(size, np.int64), np.empty(size, np.int32), np.empty((3, size)), np.empty(size))
    for i in range(count, size):
        fragments.patch[0, i] = fragments.patch[1, i] = fragments.patch[2, i] = 0.0
    return fragments


@device
def rays_for(count: int) -> Rays:
    """Rays for a band."""
    size = padded(count)
    return Rays(np.empty(size), np.empty(size), np.empty(size), np.empty(size), np.empty(size), np.empty(size))


@device
def hits_for(count: int) -> Hits:
    """Hits for a band; the margins start at infinity (no decision was close)."""
    size = padded(count)
    return Hits(
        np.full(size, np.int32(-1)),
        np.full(size, np.int32(-1)),
        np.empty(size),
        np.empty(size),
        np.empty(size),
        np.zeros(size),
        np.zeros(size, np.bool_),
        np.full(size, np.inf),
        np.full(size, np.inf),
        np.full(size, np.inf),
        np.empty(size),
    )


@device
def shades_for(count: int) -> Shades:
    """Shades for a band."""
    size = padded(count)
    return Shades(
        np.empty((2, size)),
        np.empty((3, size)),
        np.empty((3, size)),
        np.empty((3, size)),
        np.ones(size, np.bool_),
        np.full(size, np.inf),
        np.full(size, np.inf),
        np.empty(size),
    )
