"""Stage maps: shadow maps of the caster alone, as the light sees it (sections 2.1 and 3.2.2).

A map is rendered with the light at its centre and the object moved: only where one stands relative to the other counts.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ibr_ref.array_types import Bytes, Floats
from ibr_ref.jit import device, kernel, prange
from ibr_ref.pipeline.clip import clip_triangles
from ibr_ref.pipeline.triangles import Triangles, set_up
from ibr_ref.pipeline.visibility import covered, visible
from ibr_ref.shadows.vertex import place, to_clip

MOST_SAMPLES = 15
"""Largest k: the k x k samples of a texel are counted in a byte."""


class View(NamedTuple):
    """What the maps are rendered of: the caster's model, the axes that it moves along, and the light's two matrices."""

    vertices: Floats
    """(V, 3) in model space."""
    triangles: NDArray[np.int32]
    """(T, 3)."""
    axes: Floats
    """(2, 3) unit vectors in world space."""
    view_from_world: Floats
    clip_from_view: Floats
    """(4, 4) each; the projection is square."""


def positions(low: Floats, high: Floats, light: Floats) -> Floats:
    """(3, 3, 2) the object's offsets for the nine maps, [j, i] = (x_i, y_j), from three (2,) pairs along the two axes.

    The middle one is the light's own coordinate, clamped into the range; where it falls on an end, the range's middle.
    """
    axes = []
    for least, most, own in zip(low.tolist(), high.tolist(), light.tolist(), strict=True):
        middle = min(max(own, least), most)
        axes.append((least, (least + most) / 2.0 if middle in (least, most) else middle, most))
    return np.stack(np.meshgrid(*axes), axis=-1)


def levels(k: int) -> Floats:
    """(256,) coverage by the count of a texel's samples: count / k^2."""
    return np.arange(256) / float(k * k)


def values(texels: NDArray[Any], k: int) -> Floats:
    """A map's texels as numbers from 0 to 1: the coverage that counts of k x k samples stand for, or depths."""
    return levels(k)[texels] if texels.dtype == np.uint8 else np.asarray(texels, np.float64)


def _triangles(view: View, offset: Floats, size: int) -> Triangles:
    """The caster's triangles in a window of size x size."""
    clip = to_clip(place(view.vertices, view.axes, offset), view.view_from_world, view.clip_from_view)
    return set_up(clip_triangles(clip, np.empty((len(clip), 0)), view.triangles, size, size), size, size)


@device
def _count_row(samples: Bytes, k: int, row: int, counts: Bytes) -> None:
    """A row of counts (S, S), of samples (k S, k S) that are 0 or 1."""
    for column in range(counts.shape[1]):
        total = 0
        for i in range(k):
            for j in range(k):
                total += samples[row * k + i, column * k + j]
        counts[row, column] = total


@kernel
def _count(samples: Bytes, k: int, counts: Bytes) -> None:
    """All rows."""
    for row in prange(counts.shape[0]):
        _count_row(samples, k, row, counts)


def mask(view: View, offset: Floats, size: int, k: int) -> NDArray[np.uint8]:
    """(S, S) how many of a texel's k x k samples the caster covers: its silhouette.

    The samples are the pixel centres of a window of k S x k S.
    """
    samples = covered(_triangles(view, offset, k * size), k * size, k * size)
    if k == 1:
        return samples
    counts = np.empty((size, size), np.uint8)
    _count(samples, k, counts)
    return counts


def depth(view: View, offset: Floats, size: int) -> Floats:
    """(S, S) window depth of the caster; 1 where it is not."""
    return visible(_triangles(view, offset, size), size, size).depth


def projected_boxes(view: View, positions: Floats) -> Floats | None:
    """(3, 3, 2, 2) [u or v][low, high] of the corners of the caster's triangles in the nine maps, within them or not.

    None where a corner is not in front of the light at one of the positions (3, 3, 2).
    """
    boxes, corners = [], view.vertices[np.unique(view.triangles)]
    for offset in positions.reshape(-1, 2):
        clip = to_clip(place(corners, view.axes, offset), view.view_from_world, view.clip_from_view)
        if not (clip[:, 3] > 0.0).all():
            return None
        u, v = 0.5 + 0.5 * clip[:, 0] / clip[:, 3], 0.5 - 0.5 * clip[:, 1] / clip[:, 3]
        boxes.append([(u.min(), u.max()), (v.min(), v.max())])
    return np.array(boxes).reshape(3, 3, 2, 2)
