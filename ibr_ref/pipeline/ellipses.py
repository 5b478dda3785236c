"""Elliptical Gaussian splats, averaged with normalized weights (Zwicker et al. 2001, "Surface splatting", section 5).

A splat with the covariance C around the window position c, rounded to 1/256 pixel, has at a pixel's centre, d away, the
squared radius q = d^T C^-1 d and the weight a exp(-q/2); it covers the pixel if q <= cutoff^2, inside the ellipse's box.
Two passes. The first finds the nearest of the splats that cover a pixel: the depth test of `points`. The second adds up
weights and weighted colours of those that are no farther behind it than a share of its distance, which stands for the
modified A-buffer of the paper: one surface is blended, what lies behind it is not. Sums run in submission order, whatever
the number of threads: each band of rows belongs to one of them.

Arrays: colors (N, 3); spans, members and starts as in `points.Shares`, members of one band alone where a band is drawn.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ibr_ref.array_types import Floats, Indices, Ints
from ibr_ref.jit import device, kernel, prange
from ibr_ref.pipeline.bands import stride_of
from ibr_ref.pipeline.memory import arrays
from ibr_ref.pipeline.merge import passes
from ibr_ref.pipeline.points import BAND_ROWS, Shares, Spans, share_out, snapped

MOST_CUTOFF = 8.0
"""Standard deviations: `gaussian` is exact to a few units in the last place up to there."""

_DEGREE = 14


class Ellipses(NamedTuple):
    """What is drawn, one row a splat. A dropped one: NaN for its centre."""

    x: Floats
    """(N,) window x of the centres."""
    y: Floats
    """(N,) window y."""
    depth: Floats
    """(N,) window depth, <= 1."""
    distance: Floats
    """(N,) along the view axis, > 0: what the tolerance is a share of."""
    xx: Floats
    """(N,) covariance, square pixels."""
    xy: Floats
    yy: Floats
    amplitude: Floats
    """(N,) weight at the centre, > 0."""


class Blend(NamedTuple):
    """The buffers that are drawn into; those that only the stages need have no rows where these are not kept."""

    splat: NDArray[np.int32]
    """(H, W) index of the nearest; -1 none."""
    depth: Floats
    """(H, W) its window depth; 1 where none is."""
    distance: Floats
    """(H, W) its distance along the view axis; -infinite where none is."""
    weight: Floats
    """(H, W) sum of the weights."""
    color: Floats
    """(H, W, 3) sum of the weighted colours."""
    overdraw: NDArray[np.int32]
    """(H, W) or (0, W): all splats that cover the pixel."""
    second: Floats
    """(H, W) or (0, W): second-smallest window depth of those; infinite with fewer than two."""
    blended: NDArray[np.int32]
    """(H, W) or (0, W): those whose weights are summed."""
    top: int
    """The row of the picture that the buffers begin with."""


def blend_for(width: int, height: int, keep: bool, top: int = 0) -> Blend:
    """Cleared buffers for `height` rows of a picture from `top` on; with `keep` those of the stages too."""
    picture, noted = (height, width), (height if keep else 0, width)
    splat, depth, distance, weight, color = arrays(
        [(np.int32, picture), *[(np.float64, picture)] * 3, (np.float64, (*picture, 3))]
    )
    overdraw, second, blended = arrays([(np.int32, noted), (np.float64, noted), (np.int32, noted)])
    blend = Blend(splat, depth, distance, weight, color, overdraw, second, blended, top)
    for name, value in {"splat": -1, "depth": 1.0, "distance": -np.inf, "second": np.inf}.items():
        getattr(blend, name).fill(value)
    for name in ("weight", "color", "overdraw", "blended"):
        getattr(blend, name).fill(0)
    return blend


@device
def gaussian(q: float) -> float:
    """exp(-q/2) for 0 <= q <= MOST_CUTOFF^2: the same bits everywhere, which no library's exp promises.

    The series of exp(q/128), then six squarings, then the inverse.
    """
    x, term, total = q / 128.0, 1.0, 1.0
    for n in range(1, _DEGREE + 1):
        term = term * x / n
        total += term
    for _ in range(6):
        total *= total
    return 1.0 / total


@device
def squared_radius(dx: float, dy: float, xx: float, xy: float, yy: float, determinant: float) -> float:
    """d^T C^-1 d."""
    return (yy * (dx * dx) - 2.0 * xy * (dx * dy) + xx * (dy * dy)) / determinant


@device
def _note(row: int, column: int, z: float, target: Blend) -> None:
    """For the stages: how many cover a pixel, and the second-nearest of all. Before the depth test, which moves `depth`."""
    if target.overdraw[row, column] > 0:
        target.second[row, column] = min(target.second[row, column], max(z, target.depth[row, column]))
    target.overdraw[row, column] += 1


@device
def _test(row: int, column: int, z: float, distance: float, index: np.int32, target: Blend) -> None:
    """Depth test and write."""
    if passes(z, target.depth[row, column]):
        target.depth[row, column], target.distance[row, column] = z, distance
        target.splat[row, column] = index


@device
def _nearest_band(
    ellipses: Ellipses, spans: Spans, members: Indices, cutoff: float, first_row: int, base: int, target: Blend
) -> None:
    """First pass over the rows of a band from first_row on."""
    last_row = min(target.splat.shape[0], first_row + BAND_ROWS)
    most = cutoff * cutoff
    for i in members:
        x, y, z = snapped(ellipses.x[i]), snapped(ellipses.y[i]), ellipses.depth[i]
        xx, xy, yy = ellipses.xx[i], ellipses.xy[i], ellipses.yy[i]
        determinant = xx * yy - xy * xy
        for row in range(max(spans.top[i], first_row), min(spans.stop[i], last_row)):
            for column in range(spans.left[i], spans.right[i]):
                if squared_radius(column + 0.5 - x, row + target.top + 0.5 - y, xx, xy, yy, determinant) <= most:
                    if len(target.overdraw) > 0:
                        _note(row, column, z, target)
                    _test(row, column, z, ellipses.distance[i], np.int32(base + i), target)


@kernel
def _nearest(
    ellipses: Ellipses, spans: Spans, members: Indices, starts: Ints, cutoff: float, base: int, target: Blend
) -> None:
    """First pass."""
    bands = len(starts) - 1
    stride = stride_of(bands)
    for turn in prange(bands):
        band = (turn * stride) % bands
        rows = band * BAND_ROWS
        _nearest_band(ellipses, spans, members[starts[band] : starts[band + 1]], cutoff, rows, base, target)


@device
def _add(row: int, column: int, weight: float, colors: Floats, i: int, target: Blend) -> None:
    """One splat's weight and colour at a pixel."""
    target.weight[row, column] += weight
    for channel in range(3):
        target.color[row, column, channel] += weight * colors[i, channel]
    if len(target.blended) > 0:
        target.blended[row, column] += 1


@device
def _add_band(
    ellipses: Ellipses, colors: Floats, spans: Spans, members: Indices, cutoff: float, tolerance: float, first_row: int,
    target: Blend,
) -> None:  # fmt: skip
    """Second pass over the rows of a band from first_row on."""
    last_row = min(target.splat.shape[0], first_row + BAND_ROWS)
    most, reach = cutoff * cutoff, 1.0 + tolerance
    for i in members:
        x, y, distance = snapped(ellipses.x[i]), snapped(ellipses.y[i]), ellipses.distance[i]
        xx, xy, yy = ellipses.xx[i], ellipses.xy[i], ellipses.yy[i]
        determinant = xx * yy - xy * xy
        for row in range(max(spans.top[i], first_row), min(spans.stop[i], last_row)):
            for column in range(spans.left[i], spans.right[i]):
                q = squared_radius(column + 0.5 - x, row + target.top + 0.5 - y, xx, xy, yy, determinant)
                if q <= most and distance <= reach * target.distance[row, column]:
                    _add(row, column, ellipses.amplitude[i] * gaussian(q), colors, i, target)


@kernel
def _accumulate(
    ellipses: Ellipses, colors: Floats, spans: Spans, members: Indices, starts: Ints, cutoff: float, tolerance: float,
    target: Blend,
) -> None:  # fmt: skip
    """Second pass."""
    bands = len(starts) - 1
    stride = stride_of(bands)
    for turn in prange(bands):
        band = (turn * stride) % bands
        rows = band * BAND_ROWS
        _add_band(ellipses, colors, spans, members[starts[band] : starts[band + 1]], cutoff, tolerance, rows, target)


def draw_nearest(ellipses: Ellipses, cutoff: float, base: int, target: Blend) -> None:
    """First pass: the depth test, over what has been drawn before; the first splat has the index `base` there."""
    _nearest(ellipses, *_shares(ellipses, cutoff, target), cutoff, base, target)


def accumulate(ellipses: Ellipses, colors: Floats, cutoff: float, tolerance: float, target: Blend) -> None:
    """Second pass, once the first is through with all splats: add up those of one surface; colors (N, 3)."""
    _accumulate(ellipses, colors, *_shares(ellipses, cutoff, target), cutoff, tolerance, target)


def _shares(ellipses: Ellipses, cutoff: float, target: Blend) -> Shares:
    rows, columns = target.splat.shape
    width, height = 2.0 * cutoff * np.sqrt(ellipses.xx), 2.0 * cutoff * np.sqrt(ellipses.yy)
    return share_out(ellipses.x, ellipses.y, width, height, columns, rows, target.top)


@device
def _normalize_row(background: Floats, weight: Floats, color: Floats) -> None:
    """background (3,), weight (W,), color (W, 3)."""
    for column in range(len(weight)):
        shown = weight[column] > 0.0
        for channel in range(3):
            total = color[column, channel] / (weight[column] if shown else 1.0)
            color[column, channel] = min(total, 1.0) if shown else background[channel]


@kernel
def normalize(background: Floats, weight: Floats, color: Floats) -> None:
    """Sums of weighted colours (H, W, 3) become averages; the background (3,) where nothing was added: weight (H, W)."""
    for row in prange(len(weight)):
        _normalize_row(background, weight[row], color[row])
