"""Stage project: a map as a texture that the light throws onto what is seen (section 2.2).

What kernels take: texels (S S,) the map; view and clip (4, 4) the light's matrices; of a row of the picture triangle,
hidden, shadow and margin (W,), world (W, 3 or more) and coord (4, W).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ibr_ref.array_types import Bools, Floats, Indices, Texels, Vector4
from ibr_ref.jit import device, kernel, prange
from ibr_ref.pipeline import memory
from ibr_ref.pipeline.sampling import footprint, lerp, mix, nearest_index

MASK, DEPTH, DEPTH_PCF = range(3)


class Lookup(NamedTuple):
    """How a map is read."""

    mode: int
    """MASK, DEPTH or DEPTH_PCF."""
    quantized: bool
    """Both sides of a comparison of depths in 8 bits."""
    bias: float
    caster: int
    """The first of the caster's triangles: in a mask they and those after it are lit."""
    keep: bool
    """Whether coordinates and margins are written too."""


class Projected(NamedTuple):
    """The arrays of the stage, for one light sample; but for `shadow` empty where they are not kept."""

    coord: Floats
    """(H, W, 3) s, t and r; 0 where no surface is."""
    shadow: Floats
    """(H, W) 0 lit to 1."""
    margin: Floats
    """(H, W)."""
    texel_margin: Floats
    """(H, W)."""


@device
def _transform(view: Floats, clip: Floats, x: float, y: float, z: float) -> Vector4:
    """Clip coordinates x, y, z, w of a world position, by one matrix after the other."""
    view_x = view[0, 0] * x + view[0, 1] * y + view[0, 2] * z + view[0, 3]
    view_y = view[1, 0] * x + view[1, 1] * y + view[1, 2] * z + view[1, 3]
    view_z = view[2, 0] * x + view[2, 1] * y + view[2, 2] * z + view[2, 3]
    return (
        clip[0, 0] * view_x + clip[0, 1] * view_y + clip[0, 2] * view_z + clip[0, 3],
        clip[1, 0] * view_x + clip[1, 1] * view_y + clip[1, 2] * view_z + clip[1, 3],
        clip[2, 0] * view_x + clip[2, 1] * view_y + clip[2, 2] * view_z + clip[2, 3],
        clip[3, 0] * view_x + clip[3, 1] * view_y + clip[3, 2] * view_z + clip[3, 3],
    )


@device
def _locate_row(world: Floats, view: Floats, clip: Floats, coord: Floats) -> None:
    """s, t, r and q_w of a row of fragments, into coord (4, W): the bias matrix is s = (x + q_w)/2, t = (q_w - y)/2."""
    for i in range(len(world)):
        x, y, z, w = _transform(view, clip, world[i, 0], world[i, 1], world[i, 2])
        r = z / w
        r = r if r > 0.0 else 0.0
        coord[0, i] = (0.5 * x + 0.5 * w) / w
        coord[1, i] = (-0.5 * y + 0.5 * w) / w
        coord[2, i] = r if r < 1.0 else 1.0
        coord[3, i] = w


@device
def _on_map(coord: Floats, i: int) -> bool:
    """In front of the light and on its map, the border included."""
    s, t = coord[0, i], coord[1, i]
    return (coord[3, i] > 0.0) & (s >= 0.0) & (s <= 1.0) & (t >= 0.0) & (t <= 1.0)


@device
def _to_byte(x: float) -> float:
    return np.floor(255.0 * x + 0.5)


@device
def _to_step(x: float) -> float:
    """Distance, in units of x, to where its rounding to 8 bits changes."""
    y = 255.0 * x + 0.5
    f = y - np.floor(y)
    return min(f, 1.0 - f) / 255.0


@device
def _compare(depth: float, texel: float, quantized: bool) -> tuple[float, float]:
    """Whether a depth, its bias subtracted, lies behind a texel's, as 0 or 1; and the margin of that."""
    if quantized:
        behind = _to_byte(depth) > _to_byte(texel)
        margin = min(_to_step(depth), _to_step(texel))
    else:
        behind = depth > texel
        margin = abs(depth - texel)
    return (1.0 if behind else 0.0), margin


@device
def _compare_four(
    texels: Texels, size: float, s: float, t: float, depth: float, quantized: bool
) -> tuple[float, float]:
    """The bilinear mix of the four comparisons around (s, t), and their smallest margin."""
    i00, i10, i01, i11, fx, fy = footprint(s, t, size, size, None)
    c00, m00 = _compare(depth, texels[i00], quantized)
    c10, m10 = _compare(depth, texels[i10], quantized)
    c01, m01 = _compare(depth, texels[i01], quantized)
    c11, m11 = _compare(depth, texels[i11], quantized)
    return lerp(lerp(c00, c10, fx), lerp(c01, c11, fx), fy), min(min(m00, m10), min(m01, m11))


@device
def _mask_row(texels: Texels, size: float, coord: Floats, hidden: Bools, shadow: Floats, margin: Floats) -> None:
    """Bilinear fetches of the silhouette; in two loops, as the gathers keep the first one from being vectorized."""
    count = len(shadow)
    index, fraction = np.empty((4, count), np.uint32), np.empty((2, count))
    for i in range(count):
        i00, i10, i01, i11, fx, fy = footprint(coord[0, i], coord[1, i], size, size, None)
        index[0, i], index[1, i], index[2, i], index[3, i] = i00, i10, i01, i11
        fraction[0, i], fraction[1, i] = fx, fy
    for i in range(count):
        fetched = mix(texels, index[0, i], index[1, i], index[2, i], index[3, i], fraction[0, i], fraction[1, i])
        shadow[i] = 0.0 if hidden[i] else fetched
        margin[i] = np.inf


@device
def _depth_row(
    texels: Texels, size: float, coord: Floats, hidden: Bools, lookup: Lookup, shadow: Floats, margin: Floats
) -> None:
    """Comparisons of depths: with the nearest texel, or with four."""
    for i in range(len(shadow)):
        shadow[i], margin[i] = 0.0, np.inf
        if hidden[i]:
            continue
        s, t, depth = coord[0, i], coord[1, i], coord[2, i] - lookup.bias
        if lookup.mode == DEPTH_PCF:
            shadow[i], margin[i] = _compare_four(texels, size, s, t, depth, lookup.quantized)
        else:
            nearest = texels[nearest_index(s, t, size, size, None)]
            shadow[i], margin[i] = _compare(depth, nearest, lookup.quantized)


@device
def _hide_row(triangle: Indices, coord: Floats, lookup: Lookup, hidden: Bools) -> None:
    """What is lit whatever the map says: no surface, beside the map, behind the light, in a mask the caster itself."""
    last = lookup.caster if lookup.mode == MASK else 2147483647
    for i in range(len(triangle)):
        hidden[i] = (triangle[i] < 0) | (triangle[i] >= last) | (not _on_map(coord, i))


@device
def edge_distance(x: float) -> float:
    """From x to the nearest whole number."""
    f = x - np.floor(x)
    return min(f, 1.0 - f)


@device
def _keep_row(triangle: Indices, coord: Floats, size: float, margins: Floats, row: int, result: Projected) -> None:
    """The arrays that are kept with the shadows."""
    for i in range(len(triangle)):
        seen = triangle[i] >= 0
        for k in range(3):
            result.coord[row, i, k] = coord[k, i] if seen else 0.0
        nearest = min(edge_distance(coord[0, i] * size), edge_distance(coord[1, i] * size))
        result.margin[row, i] = margins[i]
        result.texel_margin[row, i] = nearest if seen and coord[3, i] > 0.0 else np.inf


@device
def _project_row(
    triangle: Indices,
    world: Floats,
    view: Floats,
    clip: Floats,
    texels: Texels,
    size: float,
    lookup: Lookup,
    row: int,
    result: Projected,
) -> None:
    columns = len(triangle)
    coord, margin, hidden = np.empty((4, columns)), np.empty(columns), np.empty(columns, np.bool_)
    _locate_row(world, view, clip, coord)
    _hide_row(triangle, coord, lookup, hidden)
    if lookup.mode == MASK:
        _mask_row(texels, size, coord, hidden, result.shadow[row], margin)
    else:
        _depth_row(texels, size, coord, hidden, lookup, result.shadow[row], margin)
    if lookup.keep:
        _keep_row(triangle, coord, size, margin, row, result)


@kernel
def _project(
    triangle: Indices,
    varyings: Floats,
    view: Floats,
    clip: Floats,
    texels: Texels,
    size: float,
    lookup: Lookup,
    result: Projected,
) -> None:
    for row in prange(triangle.shape[0]):
        _project_row(triangle[row], varyings[row], view, clip, texels, size, lookup, row, result)


def project(
    triangle: NDArray[np.int32],
    varyings: Floats,
    view_from_world: Floats,
    clip_from_view: Floats,
    image: Floats,
    lookup: Lookup,
) -> Projected:
    """Project a map (S, S) from a light with these matrices onto what the camera sees.

    triangle (H, W), varyings (H, W, 3 or more): those of the `Surface`.
    """
    height, width = triangle.shape
    kept = (height, width) if lookup.keep else (0, 0)
    shapes = ((*kept, 3), (height, width), kept, kept)
    result = Projected(*memory.arrays([(np.float64, shape) for shape in shapes]))
    size = float(len(image))
    _project(triangle, varyings, view_from_world, clip_from_view, image.reshape(-1), size, lookup, result)
    return result
