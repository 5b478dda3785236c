"""The law of the splats' width found by regression; the paper sets it by hand (section 3.3).

A point needs the larger side of the bounding box of its reference pixel's quad in the view: its position, half a step
to its neighbours on its own surface to either side. The law alpha / (beta d^2 + gamma d + delta) with alpha = 1 is linear
in beta, gamma and delta if the *inverse* of the needed width is fitted. Plain least squares leave half the points too
small; the quantile regression here leaves 1 - tau of them: a linear programme, with beta, gamma, delta >= 0.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ibr_ref.array_types import Floats
from ibr_ref.pipeline.transform import transformed
from ibr_ref.splatting.buffers import Reference, View
from ibr_ref.splatting.normals import JUMP, valid_mask
from ibr_ref.splatting.unproject import world_points

MOST_SAMPLES = 4000
"""Points that the regression sees, evenly taken from all that are in view."""

GRAZING = 1.5
"""A quad counts with at most this many times the side of one that faces both cameras at the same place. Surfaces that the
reference saw at a grazing angle stretch without limit in another view; made wide enough for them, all splats at their
distance would cover each other many times over."""


class SplatLaw(NamedTuple):
    """W_s = alpha / (beta d^2 + gamma d + delta), d in world units, W_s in pixels."""

    alpha: float
    beta: float
    gamma: float
    delta: float

    def width(self, d: Floats) -> Floats:
        """W_s at the distances d, not clamped."""
        return self.alpha / (self.beta * (d * d) + self.gamma * d + self.delta)


def fit(distances: Floats, needed: Floats, tau: float, least: float, most: float) -> SplatLaw:
    """The law that is wide enough for the share tau of points at `distances` (n,) that need the widths `needed` (n,).

    needed is clamped to [least, most] first; the law stays at or below `most` at all distances given.
    """
    from scipy import sparse  # with scipy.optimize a quarter of a second, which whoever only draws need not wait for
    from scipy.optimize import linprog

    inverse = 1.0 / np.clip(needed, least, most)
    farthest = float(distances.max())
    x = distances / farthest
    count = len(x)
    powers = np.stack([x * x, x, np.ones(count)], axis=1)
    identity = sparse.identity(count, format="csr")
    nearest = float(x.min())
    solution = linprog(
        # A width too large is a law's denominator too small: its share may be tau.
        np.concatenate([np.zeros(3), np.full(count, 1.0 - tau), np.full(count, tau)]) / count,
        A_eq=sparse.hstack([sparse.csr_matrix(powers), identity, -identity], format="csr"),
        b_eq=inverse,
        A_ub=sparse.csr_matrix(([-nearest * nearest, -nearest, -1.0], ([0, 0, 0], [0, 1, 2])), (1, 3 + 2 * count)),
        b_ub=[-1.0 / most],
        bounds=(0.0, None),
        method="highs",
    )
    if not solution.success:
        raise ValueError(f"fit of the splat law: {solution.message}")
    beta, gamma, delta = (max(0.0, float(c)) for c in solution.x[:3])
    return SplatLaw(1.0, beta / (farthest * farthest), gamma / farthest, delta)


def needed_widths(reference: Reference, view: View, stride: int) -> tuple[Floats, Floats]:
    """Distance from the eye and needed width of every `stride`-th point that is in view and has neighbours, (n,) each."""
    pixels = reference.pixels[::stride].astype(np.int64)
    points, valid = world_points(reference), valid_mask(reference)
    across = _half_steps(reference, valid, points, pixels, 1)
    along = _half_steps(reference, valid, points, pixels, reference.columns)
    center = points[pixels]
    corners = [_projected(view, center + a + b) for a in across for b in along]
    x, y, w = (np.stack([corner[i] for corner in corners]) for i in range(3))
    side = np.maximum(x.max(axis=0) - x.min(axis=0), y.max(axis=0) - y.min(axis=0))
    seen_x, seen_y, seen_w = _projected(view, center)
    in_view = (seen_w > 0.0) & (seen_x >= 0.0) & (seen_x < view.width) & (seen_y >= 0.0) & (seen_y < view.height)
    in_view &= (w > 0.0).all(axis=0) & np.isfinite(side)
    facing = _facing_side(reference, view, pixels[in_view], w.mean(axis=0)[in_view])
    return _distances(view, center[in_view]), np.minimum(side[in_view], GRAZING * facing)


def _half_steps(
    reference: Reference, valid: NDArray[np.bool_], points: Floats, pixels: NDArray[np.int64], offset: int
) -> tuple[Floats, Floats]:
    """Half the way to the neighbours before and after along one axis, (n, 3) each; NaN where neither is on the surface.

    offset: 1 along rows, `columns` along columns. A missing neighbour is the other's mirror image.
    """
    rows, columns = len(reference.row_starts) - 1, reference.columns
    place, size = (pixels % columns, columns) if offset == 1 else (pixels // columns, rows)
    halves = []
    for direction, inside in ((-1, place > 0), (1, place + 1 < size)):
        other = np.where(inside, pixels + direction * offset, pixels)
        depth = reference.depth[pixels]
        near = inside & valid[other] & (abs(reference.depth[other] - depth) <= JUMP * depth)
        halves.append(np.where(near[:, None], 0.5 * (points[other] - points[pixels]), np.nan))
    before, after = halves
    return np.where(np.isnan(before), -after, before), np.where(np.isnan(after), -before, after)


def _projected(view: View, p: Floats) -> tuple[Floats, Floats, Floats]:
    """Window x, y and clip w of world points (n, 3)."""
    x, y, _, w = transformed(view.clip_from_view, transformed(view.view_from_world, p)).T
    with np.errstate(divide="ignore", invalid="ignore"):
        return (x / w + 1.0) / 2.0 * view.width, (1.0 - y / w) / 2.0 * view.height, w


def _distances(view: View, p: Floats) -> Floats:
    """The law's d for world points (n, 3)."""
    if not view.perspective:
        return -transformed(view.view_from_world, p)[:, 2]
    x, y, z = (p[:, axis] - view.eye[axis] for axis in range(3))
    result: Floats = np.sqrt(x * x + y * y + z * z)
    return result


def _facing_side(reference: Reference, view: View, pixels: NDArray[np.int64], w: Floats) -> Floats:
    """Side in the view of a reference pixel's quad that faces both cameras."""
    k = reference.intrinsics
    size = max(1.0 / abs(k[0, 0]), 1.0 / abs(k[1, 1])) * (reference.depth[pixels] if reference.perspective else 1.0)
    c = view.clip_from_view
    scale = max(abs(c[0, 0]) * view.width, abs(c[1, 1]) * view.height) / 2.0
    result: Floats = size * scale / w
    return result
