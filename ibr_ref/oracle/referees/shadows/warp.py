"""Stage warp: grids between grids, and images warped from one to the other."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ibr_ref.array_types import Ints
from ibr_ref.oracle.accept.bounded import Bounded
from ibr_ref.oracle.accept.coverage import Fragments
from ibr_ref.oracle.accept.seams import loose
from ibr_ref.oracle.arithmetic.number import Number
from ibr_ref.oracle.referees.shadows.drawing import Pass, Varyings
from ibr_ref.oracle.referees.shadows.model import Model
from ibr_ref.oracle.referees.shadows.varyings import Triangles


@dataclass(frozen=True, eq=False)
class Mesh:
    """A grid's triangles in the window of a map, and all pixels that each may cover."""

    found: Fragments
    varyings: Varyings
    corners: Ints
    """(T, 3) of the triangles."""
    size: int
    last: NDArray[np.int64]
    """(S S) the fragment that the reference shows; -1 none."""
    open: NDArray[np.bool_]
    """(S S) whether a pixel near the mesh's border may be on its other side."""

    def coordinates(self, grid: Number) -> list[Number]:
        """(n,) u and v of the fragments."""
        corners = grid.reshape(-1, 2)[self.corners]
        return [self.varyings.linear(self.found, corners[..., k]) for k in range(2)]

    def fetched(self, image: Number, grid: Number) -> Bounded:
        """(n,) of an image, with its grid as texture coordinates."""
        model = self.varyings.model
        u, v = self.coordinates(grid)
        sampler = model.program.warp_sampler(model.machine)
        lane = np.arange(len(self.found.triangle))

        def run(origin: Ints) -> dict[str, Any]:
            each = np.arange(len(origin))
            at = [Number(model.machine, c.value[origin], c.error[origin], {}, each) for c in (u, v)]
            return {"texel": model.machine.of(sampler.bilinear(image, *at))}

        with np.errstate(all="ignore"):
            found, lost = model.machine.follow(run, len(lane))
        low, high = np.full(len(lane), np.inf), np.full(len(lane), -np.inf)
        np.minimum.at(low, found["origin"], found["texel"].low)
        np.maximum.at(high, found["origin"], found["texel"].high)
        low[lost], high[lost] = 0.0, 1.0
        first = found["texel"].value[: len(lane)]  # of the paths that are taken first, each lane's
        return Bounded(first, np.maximum(high - first, first - low), model.device)

    def warped(self, image: Number, grid: Number) -> Bounded:
        """An image with its grid as texture coordinates."""
        value, nothing = self.fetched(image, grid), self.varyings.model.program.empty()
        pixel = self.found.rows * self.size + self.found.columns
        shown = np.append(value.value, nothing)[self.last]
        error = np.where(self.open, np.abs(nothing - shown), 0.0)
        np.maximum.at(error, pixel, np.abs(value.value - shown[pixel]) + value.error)
        shape = self.size, self.size
        return Bounded(shown.reshape(shape), error.reshape(shape), value.device)


def mesh_of(model: Model, target: Number, size: int) -> Mesh:
    """The triangles of a grid (R, C, 2) as the program has them."""
    program, raster = model.program, model.program.warp_raster(model.machine)
    corners = program.mesh(*target.shape[:2])
    at = model.bounded(program.texels(target, size).reshape(-1, 2)[corners])
    window = Pass(model, raster, size, size)
    shift = window.shift
    x, y = (Bounded(at.value[..., k] + shift, at.error[..., k], at.device) for k in range(2))
    found = window.cover(x, y)
    varyings = Varyings(model, raster, Triangles.of(x, y, size, size))
    return Mesh(found, varyings, corners, size, *_shown(found, corners, size))


def _shown(found: Fragments, corners: Ints, size: int) -> tuple[NDArray[np.int64], NDArray[np.bool_]]:
    """(S S) by pixel, of the fragments inside their triangle the last one; and whether the mesh's border may pass it.

    A pixel of which none is inside lies on an edge between triangles, and has the one that is least outside; or beyond the
    border, by the edges of triangles (T, 3), and has none.
    """
    border, pixel = _on_border(corners), found.rows * size + found.columns
    inside = np.nan_to_num(np.minimum(found.weights.min(axis=1), 0.0), nan=-np.inf, neginf=-np.inf)
    beyond: NDArray[np.bool_] = np.any((found.weights < 0.0) & border[found.triangle], axis=1)
    order = np.lexsort((found.triangle, inside, ~beyond, pixel))
    last = np.full(size * size, -1, np.int64)
    last[pixel[order]] = np.where(beyond[order], -1, order)
    near = np.zeros(size * size, np.bool_)
    near[pixel[loose(found, pixel, corners, np.ones(len(corners), np.bool_))]] = True
    near[pixel[found.certain]] = False
    return last, near


def _on_border(corners: Ints) -> NDArray[np.bool_]:
    """(T, 3) which edges of a mesh's triangles, each opposite its corner, have no other triangle beyond."""
    edges = np.sort(np.stack([corners[:, [(i + 1) % 3, (i + 2) % 3]] for i in range(3)], axis=1), axis=2)
    _, index, count = np.unique(edges.reshape(-1, 2), axis=0, return_inverse=True, return_counts=True)
    return np.asarray(count == 1, np.bool_)[index.reshape(-1)].reshape(-1, 3)
