"""Stage controls: where the same feature of the shadow is in each of the nine maps.

The paper places the control points by hand and names automatic placement as the open problem (section 5). A placement is
valid if the border of every grid lies on the border of the map, so that the mesh covers it, and no triangle is folded, in
the nine grids and in all that are interpolated between them.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ibr_ref.array_types import Floats
from ibr_ref.pipeline.triangles import SUBPIXELS
from ibr_ref.shadows.draw import grid_triangles

_LEAST_GAP = 1.0 / 64.0
"""Between the lines of a grid, as a share of the map."""

_LEAST_PRESSED = 1.0 / 256.0
"""The same of lines that are pressed to the border."""

_PADDING = 1.0 / 64.0
"""Around the silhouette, so that its outline is not on the border of a cell."""


def regular(rows: int, columns: int) -> Floats:
    """(R, C, 2) evenly spaced points: the grid of a warp that changes nothing."""
    return _crossing(np.linspace(0.0, 1.0, columns), np.linspace(0.0, 1.0, rows))


def _crossing(u: Floats, v: Floats) -> Floats:
    return np.stack(np.meshgrid(u, v), axis=-1)


def folded(grid: Floats) -> int | None:
    """Index of the first triangle of a grid whose area is not positive, in the order in which they are drawn, if any."""
    a, b, c = np.moveaxis(grid_triangles(grid), 1, 0)
    area = (b[:, 0] - a[:, 0]) * (c[:, 1] - a[:, 1]) - (b[:, 1] - a[:, 1]) * (c[:, 0] - a[:, 0])
    bad = np.flatnonzero(~(area > 0.0))
    return int(bad[0]) if len(bad) else None


def on_lattice(controls: Floats, size: int) -> Floats:
    """The points moved to the 1/256 texel to which windows are snapped: warps to their own grids then change nothing."""
    steps = float(size * SUBPIXELS)
    return np.rint(controls * steps) / steps


def identity(images: Floats, rows: int, columns: int, boxes: Floats | None = None) -> Floats:
    """(3, 3, R, C, 2) regular grids: the maps are mixed where they are."""
    return np.broadcast_to(regular(rows, columns), (3, 3, rows, columns, 2)).copy()


def bounds(images: Floats, rows: int, columns: int, boxes: Floats | None = None) -> Floats:
    """(3, 3, R, C, 2) grids whose inner lines divide the silhouette's bounding box; their outer ones are the border.

    Lines stay lines between the maps, so that nothing folds. For a map without a silhouette its own one of `boxes`
    (`projected_boxes`) is taken; where there is none, all grids are `identity`.
    """
    found = [[_bounding_box(image) for image in line] for line in images]
    if boxes is not None:
        found = [[b or _as_box(boxes[j, i]) for i, b in enumerate(line)] for j, line in enumerate(found)]
    if any(box is None for line in found for box in line):
        return identity(images, rows, columns)
    grids = [[_crossing(_lines(*box[0], columns), _lines(*box[1], rows)) for box in line if box] for line in found]
    return np.array(grids)


def _as_box(ends: Floats) -> tuple[tuple[float, float], tuple[float, float]]:
    (u0, u1), (v0, v1) = np.minimum(np.maximum(ends, 0.0), 1.0).tolist()
    return (u0, u1), (v0, v1)


def along(boxes: Floats, rows: int, columns: int) -> Floats:
    """(3, 3, R, C, 2) grids whose inner lines divide the caster's own box in each map, wherever it reaches to.

    boxes (3, 3, 2, 2): [u or v][low, high] of `projected_boxes`. Lines beyond the map's border are pressed to it, so that
    the others mark the same of the caster in all maps.
    """
    grids = [[_crossing(_pressed(u, columns), _pressed(v, rows)) for u, v in line] for line in boxes]
    return np.array(grids)


def _pressed(ends: Floats, count: int) -> Floats:
    """`count` coordinates from 0 to 1, the inner ones evenly from one end to the other where inside."""
    low, high = ends.tolist()
    inner = count - 2
    if inner < 2:
        return _lines(min(max(low, 0.0), 1.0), min(max(high, 0.0), 1.0), count)
    gap = min(_LEAST_PRESSED, 1.0 / (2 * count))
    lines, last = [0.0], 0.0
    for i, line in enumerate(np.linspace(low - _PADDING, high + _PADDING, inner).tolist()):
        last = min(max(line, last + gap), 1.0 - gap * (inner - i))
        lines.append(last)
    return np.array([*lines, 1.0])


def _bounding_box(image: Floats) -> tuple[tuple[float, float], tuple[float, float]] | None:
    """((u0, u1), (v0, v1)) of what is not empty; the lookups of a mask or of 1 - depth are > 0 there."""
    size = len(image)
    rows, columns = np.flatnonzero((image > 0.0).any(axis=1)), np.flatnonzero((image > 0.0).any(axis=0))
    if not len(rows):
        return None
    return (columns[0] / size, (columns[-1] + 1) / size), (rows[0] / size, (rows[-1] + 1) / size)


def _lines(low: float, high: float, count: int) -> Floats:
    """`count` coordinates from 0 to 1, the inner ones evenly from `low` to `high` (one: in the middle), well apart."""
    inner = count - 2
    if inner < 1:
        return np.linspace(0.0, 1.0, count)
    gap = min(_LEAST_GAP, 1.0 / (2 * count))
    low, high = (low + high) / 2.0 if inner == 1 else low - _PADDING, high + _PADDING
    low = min(max(low, gap), 1.0 - gap * inner)
    high = min(max(high, low + gap * (inner - 1)), 1.0 - gap)
    return np.concatenate([[0.0], np.linspace(low, high, inner), [1.0]])


def turned(controls: Floats) -> Floats:
    """Grids (3, 3, C, R, 2) as grids (3, 3, R, C, 2) whose rows go across: a quarter turn, so that areas stay positive."""
    return np.ascontiguousarray(controls[:, :, ::-1].swapaxes(2, 3))


PLACEMENTS: dict[str, Callable[[Floats, int, int, Floats | None], Floats]] = {"bounds": bounds, "identity": identity}
"""The automatic placements, by name: (3, 3, S, S) silhouettes, R and C to (3, 3, R, C, 2) controls."""


def place(name: str, images: Floats, rows: int, columns: int, boxes: Floats | None = None) -> Floats:
    """Controls (3, 3, R, C, 2) by one of `PLACEMENTS`, on the lattice of the window.

    images (3, 3, S, S): silhouettes, 0 where empty and above it elsewhere. boxes as in `bounds`.
    """
    return on_lattice(PLACEMENTS[name](images, rows, columns, boxes), images.shape[2])
