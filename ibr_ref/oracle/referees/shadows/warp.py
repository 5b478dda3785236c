"""Stage warp: grids between grids, and images warped from one to the other."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ibr_ref.array_types import Floats
from ibr_ref.oracle.accept.bounded import Bounded, exact, lerp, stored
from ibr_ref.oracle.accept.coverage import Fragments, fragments
from ibr_ref.oracle.accept.fetch import Texture, fetch
from ibr_ref.oracle.referees.shadows.places import Place, fraction_in, located
from ibr_ref.oracle.referees.shadows.varyings import Triangles, linear


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


def pair(sources: Sequence[Source], share: Bounded, target: Bounded, nearest: bool, nothing: float) -> Bounded:
    """Two images, both warped to the grid `target` and mixed, or the nearer one alone: (S, S).

    nothing: what is shown outside the mesh. The reference's covers the whole map, whatever is snapped; a port's need not.
    """
    size = len(sources[0].image.value)
    mesh = mesh_of(target, size)
    if not nearest:
        images = [mesh.warped(source, nothing) for source in sources]
        return lerp(images[0], images[1], share)
    nearer = int(share.value >= 0.5)
    open_ = abs(float(share.value) - 0.5) <= float(share.error)
    return warped([mesh.warped(sources[n], nothing) for n in ((nearer, 1 - nearer) if open_ else (nearer,))])


@dataclass(frozen=True, eq=False)
class Mesh:
    """A grid's triangles in the window of a map, and all pixels that each may cover."""

    found: Fragments
    triangles: Triangles
    size: int
    last: NDArray[np.int64]
    """(S S) the fragment that the reference shows; -1 none."""
    open: NDArray[np.bool_]
    """(S S) whether a pixel near the mesh's border may be on its other side."""

    def coordinates(self, grid: Bounded) -> list[Bounded]:
        """(n,) u and v of the fragments."""
        corners = grid_corners(grid)
        return linear(self.triangles, self.found, [corners[..., 0], corners[..., 1]])

    def warped(self, source: Source, nothing: float) -> Bounded:
        """An image with its grid as texture coordinates; nothing: outside the mesh."""
        u, v = self.coordinates(source.grid)
        device = u.device
        value = fetch(Texture(source.image.value), u, v)
        if np.any(source.image.error > 0.0):
            error = np.broadcast_to(source.image.error, source.image.value.shape)
            value = value.widened(fetch(Texture(error), u, v).high)
        pixel = self.found.rows * self.size + self.found.columns
        shown = np.append(value.value, nothing)[self.last]
        error = np.where(self.open, np.abs(nothing - shown), 0.0)
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
    border = _on_border(*target.value.shape[:2])
    return Mesh(found, Triangles.of(x, y, size, size), size, *_shown(found, border, size))


def _shown(found: Fragments, border: NDArray[np.bool_], size: int) -> tuple[NDArray[np.int64], NDArray[np.bool_]]:
    """(S S) by pixel, of the fragments inside their triangle the last one; and whether the mesh's border may pass it.

    A pixel of which none is inside lies on an edge between triangles, and has the one that is least outside; or beyond the
    border (T, 3), by the edges of triangles, and has none.
    """
    pixel = found.rows * size + found.columns
    inside = np.nan_to_num(np.minimum(found.weights.min(axis=1), 0.0), nan=-np.inf, neginf=-np.inf)
    beyond: NDArray[np.bool_] = np.any((found.weights < 0.0) & border[found.triangle], axis=1)
    order = np.lexsort((found.triangle, inside, ~beyond, pixel))
    last = np.full(size * size, -1, np.int64)
    last[pixel[order]] = np.where(beyond[order], -1, order)
    loose = ~(found.inside | ~border[found.triangle]).all(axis=1)
    near = np.zeros(size * size, np.bool_)
    near[pixel[loose]] = True
    near[pixel[found.certain]] = False
    return last, near


def _on_border(rows: int, columns: int) -> NDArray[np.bool_]:
    """(2 (R-1) (C-1), 3) which edges of a grid's triangles, each opposite its corner, have no other triangle beyond."""
    number = np.arange(rows * columns, dtype=np.float64).reshape(rows, columns, 1)
    corners = _corners(np.repeat(number, 2, axis=2))[..., 0].astype(np.int64)
    edges = np.sort(np.stack([corners[:, [(i + 1) % 3, (i + 2) % 3]] for i in range(3)], axis=1), axis=2)
    _, index, count = np.unique(edges.reshape(-1, 2), axis=0, return_inverse=True, return_counts=True)
    return np.asarray(count == 1, np.bool_)[index.reshape(-1)].reshape(-1, 3)


def grid_corners(grid: Bounded) -> Bounded:
    """(2 (R-1) (C-1), 3, 2) corners of a grid's triangles, in the order in which they are drawn."""
    error = np.broadcast_to(grid.error, grid.value.shape)
    return replace(grid, value=_corners(grid.value), error=_corners(error))


def _corners(grid: Floats) -> Floats:
    a, b, c, d = grid[:-1, :-1], grid[:-1, 1:], grid[1:, 1:], grid[1:, :-1]
    return np.stack([a, b, c, a, c, d], axis=2).reshape(-1, 3, 2)
