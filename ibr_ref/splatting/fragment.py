"""Stage resolve: the colour of each pixel's winner.

Points are lit in the vertex stage, as in the paper; here that is done for those alone that are seen, which gives the same
colours sooner.

What kernels take: normals (P, 3), their codes; eye (4,); splat (H, W) the winners, spans (H, 2), color (H, W, 3), background
(3,); in functions of a row, or a part of it, winners (W,) and color (W, 3); stored (P, 3) and pixels (V,) of `Reference`.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ibr_ref.array_types import Bytes, Floats, Indices
from ibr_ref.jit import device, kernel, prange
from ibr_ref.splatting.buffers import Lighting, Reference, View
from ibr_ref.splatting.vertex import light_pixels


@device
def _resolve_stored(stored: Floats, pixels: Indices, first: int, winners: Indices, color: Floats) -> None:
    """Without a light the winners of this image in a row of the picture have its own colours."""
    count = len(pixels)
    for column in range(len(winners)):
        i = winners[column] - first
        if 0 <= i < count:
            pixel = np.uint32(pixels[np.uint32(i)])
            color[column, 0], color[column, 1], color[column, 2] = stored[pixel, 0], stored[pixel, 1], stored[pixel, 2]


@device
def _resolve_lit(
    reference: Reference, normals: Bytes, lighting: Lighting, eye: Floats, first: int, winners: Indices, color: Floats
) -> None:
    """The winners of this image in a row of the picture are gathered, lit together, and put where they are seen."""
    pixels, count = reference.pixels, len(reference.pixels)
    seen, columns = np.empty(len(winners), np.int32), np.empty(len(winners), np.int32)
    shown = 0
    for column in range(len(winners)):
        i = winners[column] - first
        if 0 <= i < count:
            seen[shown], columns[shown] = pixels[np.uint32(i)], column
            shown += 1
    colors = np.empty((shown, 3))
    light_pixels(reference, normals, lighting, eye, seen[:shown], colors)
    for i in range(shown):
        column = columns[i]
        color[column, 0], color[column, 1], color[column, 2] = colors[i, 0], colors[i, 1], colors[i, 2]


@device
def _resolve_row(
    reference: Reference, normals: Bytes, lighting: Lighting, eye: Floats, first: int, winners: Indices, color: Floats
) -> None:
    if lighting.lit:
        _resolve_lit(reference, normals, lighting, eye, first, winners, color)
    else:
        _resolve_stored(reference.color, reference.pixels, first, winners, color)


@device
def _clear_row(background: Floats, color: Floats) -> None:
    for column in range(len(color)):
        color[column, 0], color[column, 1], color[column, 2] = background[0], background[1], background[2]


@kernel
def clear(background: Floats, color: Floats) -> None:
    """The background (3,) everywhere in the picture (H, W, 3)."""
    for row in prange(len(color)):
        _clear_row(background, color[row])


@device
def _span(winners: Indices) -> tuple[int, int]:
    first, stop = 0, len(winners)
    while first < stop and winners[first] < 0:
        first += 1
    while first < stop and winners[stop - 1] < 0:
        stop -= 1
    return first, stop


@kernel
def _occupied(splat: Indices, spans: Indices) -> None:
    for row in prange(len(splat)):
        spans[row, 0], spans[row, 1] = _span(splat[row])


def occupied(splat: NDArray[np.int32]) -> NDArray[np.int32]:
    """(H, 2) the columns [first, stop) of each row of the winners (H, W) beside which there are none."""
    spans = np.empty((len(splat), 2), np.int32)
    _occupied(splat, spans)
    return spans


@kernel
def _resolve(
    reference: Reference,
    normals: Bytes,
    lighting: Lighting,
    eye: Floats,
    first: int,
    splat: Indices,
    spans: Indices,
    color: Floats,
) -> None:
    for row in prange(len(splat)):
        start, stop = spans[row, 0], spans[row, 1]
        if start < stop:
            _resolve_row(reference, normals, lighting, eye, first, splat[row, start:stop], color[row, start:stop])


def resolve(
    reference: Reference,
    normals: NDArray[np.uint8],
    lighting: Lighting,
    view: View,
    first: int,
    splat: NDArray[np.int32],
    spans: NDArray[np.int32],
    color: NDArray[np.float64],
) -> None:
    """Write the colours (H, W, 3) of the pixels whose winner (H, W) is a point of this image; `first` is its first one.

    spans: of the winners, as `occupied` gives them: each of many small images looks at no more of the picture.
    """
    _resolve(reference, normals, lighting, view.eye, first, splat, spans, color)
