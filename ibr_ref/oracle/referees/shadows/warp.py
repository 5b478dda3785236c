"""Stage warp: grids between grids, and images warped from one to the other."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ibr_ref.oracle.accept.bounded import Bounded, exact, lerp, stored
from ibr_ref.oracle.accept.coverage import Fragments, fragments
from ibr_ref.oracle.accept.fetch import Texture, fetch
from ibr_ref.oracle.referees.shadows.places import Place, fraction_in, located
from ibr_ref.oracle.referees.shadows.varyings import Triangles, linear

Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Source:
    """An image to warp, (S, S), and its grid (R, C, 2)."""

    image: Bounded
    grid: Bounded


def between(first: Bounded, second: Bounded, share: Bounded) -> Bounded:
    """Two grids' lerp."""
    return lerp(first, second, share)


def place_of(
    lines: Sequence[Bounded], at: Sequence[Bounded], cell: NDArray[np.int64] | None, fraction: Floats | None
) -> list[tuple[Place, Place]]:
    """Where along x and y an object may be among the lines (3,) of the maps, the likeliest first.

    cell, fraction (2,): a port's own.
    """
    axes: list[list[Place]] = []
    for k, line in enumerate(lines):
        found = located(line, at[k])
        if cell is not None:
            found = [Place(int(cell[k]), fraction_in(line, at[k], int(cell[k])))]
        if fraction is not None:
            found = [Place(place.cell, stored(fraction[k], at[k].device, place.fraction)) for place in found]
        axes.append(found)
    return [(x, y) for x in axes[0] for y in axes[1]]


def warped(alternatives: Sequence[Bounded]) -> Bounded:
    """The first one's value, and an error that covers all."""
    first = alternatives[0]
    error = first.error
    for other in alternatives[1:]:
        error = np.maximum(error, np.abs(other.value - first.value) + other.error)
    return Bounded(first.value, error, first.device)


def pair(sources: Sequence[Source], share: Bounded, target: Bounded, nearest: bool) -> Bounded:
    """Two images, both warped to the grid `target` and mixed, or the nearer one alone: (S, S).

    The mesh covers the whole map: its border is the map's, so that there is no pixel outside, whatever is snapped.
    """
    size = len(sources[0].image.value)
    mesh = mesh_of(target, size)
    if not nearest:
        images = [mesh.warped(source) for source in sources]
        return lerp(images[0], images[1], share)
    nearer = int(share.value >= 0.5)
    open_ = abs(float(share.value) - 0.5) <= float(share.error)
    return warped([mesh.warped(sources[n]) for n in ((nearer, 1 - nearer) if open_ else (nearer,))])


@dataclass(frozen=True, eq=False)
class Mesh:
    """A grid's triangles in the window of a map, and all pixels that each may cover."""

    found: Fragments
    triangles: Triangles
    size: int
    last: NDArray[np.int64]
    """(S S) the fragment that the reference shows."""

    def coordinates(self, grid: Bounded) -> list[Bounded]:
        """(n,) u and v of the fragments."""
        corners = grid_corners(grid)
        return linear(self.triangles, self.found, [corners[..., 0], corners[..., 1]])

    def warped(self, source: Source) -> Bounded:
        """An image with its grid as texture coordinates."""
        u, v = self.coordinates(source.grid)
        device = u.device
        value = fetch(Texture(source.image.value), u, v)
        if np.any(source.image.error > 0.0):
            error = np.broadcast_to(source.image.error, source.image.value.shape)
            value = value.widened(fetch(Texture(error), u, v).high)
        pixel = self.found.rows * self.size + self.found.columns
        shown = value.value[self.last]
        error = np.zeros(self.size * self.size)
        np.maximum.at(error, pixel, np.abs(value.value - shown[pixel]) + value.error)
        shape = self.size, self.size
        return Bounded(shown.reshape(shape), error.reshape(shape), device)


def mesh_of(target: Bounded, size: int) -> Mesh:
    """The triangles of a grid (R, C, 2). Corners go from [0, 1] to [-1, 1] and from there to the window."""
    device = target.device
    one, two, half = exact(1.0, device), exact(2.0, device), exact(size / 2.0, device)
    corners = grid_corners(target)
    window = (corners * two - one + one) * half
    # The reference snaps S G' itself.
    placed = Bounded(corners.value * size, window.error, device)
    x, y = placed[..., 0], placed[..., 1]
    found = fragments(x, y, size, size)
    return Mesh(found, Triangles.of(x, y, size, size), size, _last(found, size))


def _last(found: Fragments, size: int) -> NDArray[np.int64]:
    """(S S) by pixel, of the fragments inside their triangle the last one, else the one that is least outside."""
    pixel = found.rows * size + found.columns
    inside = np.nan_to_num(np.minimum(found.weights.min(axis=1), 0.0), nan=-np.inf, neginf=-np.inf)
    order = np.lexsort((found.triangle, inside, pixel))
    last = np.zeros(size * size, np.int64)
    last[pixel[order]] = order
    return last


def grid_corners(grid: Bounded) -> Bounded:
    """(2 (R-1) (C-1), 3, 2) corners of a grid's triangles, in the order in which they are drawn."""
    error = np.broadcast_to(grid.error, grid.value.shape)
    return replace(grid, value=_corners(grid.value), error=_corners(error))


def _corners(grid: Floats) -> Floats:
    a, b, c, d = grid[:-1, :-1], grid[:-1, 1:], grid[1:, 1:], grid[1:, :-1]
    return np.stack([a, b, c, a, c, d], axis=2).reshape(-1, 3, 2)
