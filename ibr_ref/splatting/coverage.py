"""What a frame shows of its reference images: coverage, overdraw, and holes.

A hole is a pixel inside the union of the projected quads of neighbouring reference pixels, not across a jump, that no
splat covers: there the surface is known, and only the splats are too small.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ibr_ref.pipeline.clip import clip_triangles
from ibr_ref.pipeline.transform import transformed
from ibr_ref.pipeline.triangles import set_up
from ibr_ref.pipeline.visibility import visible
from ibr_ref.splatting.buffers import Reference, View
from ibr_ref.splatting.normals import JUMP, valid_mask
from ibr_ref.splatting.unproject import world_points

_BLOCK_PIXELS = 1 << 17


class Coverage(NamedTuple):
    """What `coverage` reports."""

    covered: NDArray[np.bool_]
    """(H, W): some splat shows."""
    surface: NDArray[np.bool_]
    """(H, W): inside the union of the projected quads."""
    overdraw: NDArray[np.int32]
    """(H, W): all splats that cover the pixel."""

    @property
    def coverage(self) -> float:
        """Share of the picture's pixels that show a splat."""
        return float(self.covered.mean())

    @property
    def holes(self) -> NDArray[np.bool_]:
        """(H, W): inside the union, but no splat shows."""
        return self.surface & ~self.covered

    @property
    def hole_share(self) -> float:
        """Holes as a share of the union; 0 where there is none."""
        return float(self.holes.sum()) / max(1, int(self.surface.sum()))

    @property
    def mean_overdraw(self) -> float:
        """Splats a covered pixel, on average; 0 where none is covered."""
        return float(self.overdraw.sum()) / max(1, int(self.covered.sum()))


def surface_pixels(references: list[Reference], view: View) -> NDArray[np.bool_]:
    """(H, W) the union of the projected quads of all reference images."""
    width, height = int(view.width), int(view.height)
    inside = np.zeros((height, width), np.bool_)
    for reference in references:
        clip = transformed(view.clip_from_view, transformed(view.view_from_world, world_points(reference)))
        valid = valid_mask(reference)
        rows, columns = len(reference.row_starts) - 1, reference.columns
        step = max(1, _BLOCK_PIXELS // columns)
        for first in range(0, rows - 1, step):
            triangles = _quads(reference.depth, valid, columns, first, min(rows - 1, first + step))
            clipped = clip_triangles(clip, np.empty((len(clip), 0)), triangles, width, height)
            inside |= visible(set_up(clipped, width, height), width, height).triangle >= 0
    return inside


def _quads(
    depth: NDArray[np.float64], valid: NDArray[np.bool_], columns: int, first: int, last: int
) -> NDArray[np.int32]:
    """(T, 3) two triangles for each quad of neighbouring pixels with its upper row in [first, last), not across a jump."""
    rows, across = np.mgrid[first:last, 0 : columns - 1]
    a = (rows * columns + across).reshape(-1)
    corners = (a, a + 1, a + 1 + columns, a + columns)
    whole = np.ones(len(a), np.bool_)
    for i in range(4):
        p, q = corners[i], corners[(i + 1) % 4]
        whole &= valid[p] & (abs(depth[p] - depth[q]) <= JUMP * np.minimum(depth[p], depth[q]))
    a, b, c, d = (corner[whole] for corner in corners)
    return np.concatenate([np.stack([a, b, c], axis=1), np.stack([a, c, d], axis=1)]).astype(np.int32)
