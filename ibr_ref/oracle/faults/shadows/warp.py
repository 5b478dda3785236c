"""Bugs in one warp of a map from grid to grid: its mesh, its fetches."""

from __future__ import annotations

import numpy as np

from ibr_ref.oracle.faults.bugs import Bugs
from ibr_ref.oracle.programs.program import Bools, Floats, Ints
from ibr_ref.oracle.programs.shadows.port import Port
from ibr_ref.oracle.programs.shadows.raster import Raster
from ibr_ref.oracle.programs.shadows.sampler import Sampler

WARP = Bugs("warp", only=("warp",))


@WARP.add("warp-grids-exchanged")
class _GridsExchanged(Port):
    """Source and target of the warp are exchanged."""

    def warp(self, image: Floats, source: Floats, target: Floats) -> Floats:
        return super().warp(image, target, source)


@WARP.add("warp-other-diagonal")
class _OtherDiagonal(Port):
    """Cells are cut along the other diagonal."""

    def halves(self, columns: int) -> list[Ints]:
        return [np.array([0, 1, columns]), np.array([1, columns + 1, columns])]


@WARP.add("warp-last-column-left-out")
class _LastColumn(Port):
    """The loop over the cells of a row ends one early."""

    def mesh(self, rows: int, columns: int) -> Ints:
        mesh = super().mesh(rows, columns).reshape(rows - 1, columns - 1, 2, 3)
        return mesh[:, :-1].reshape(-1, 3)


@WARP.add("warp-corners-aligned")
class _CornersAligned(Port):
    """Positions are scaled by S - 1."""

    def texels(self, points: Floats, size: int) -> Floats:
        return super().texels(points, size - 1)


class _Strict(Raster):
    def inside(self, edge: Ints, owned: Bools) -> Bools:
        return edge > 0


@WARP.add("warp-no-fill-rule", small=True)
class _Holes(Port):
    """Pixel centres on an edge belong to no triangle: holes along diagonals."""

    warp_raster = _Strict


class _NoHalf(Sampler):
    def position(self, u: Floats, size: int) -> Floats:
        return self.do.multiply(u, size)


@WARP.add("warp-half-a-texel")
class _HalfTexel(Port):
    """Fetches from texel u S, not u S - 0.5."""

    warp_sampler = _NoHalf


class _Nearest(Sampler):
    def bilinear(self, image: Floats, u: Floats, v: Floats) -> Floats:
        return self.nearest(image, u, v)


@WARP.add("warp-nearest-fetch")
class _NearestFetch(Port):
    """The nearest texel is fetched."""

    warp_sampler = _Nearest


class _Repeat(Sampler):
    def wrap(self, index: Ints, size: int) -> Ints:
        return np.mod(index, size)


@WARP.add("warp-repeat", small=True)
class _Repeated(Port):
    """Fetches wrap around the map's border."""

    warp_sampler = _Repeat


class _OneLess(Sampler):
    def wrap(self, index: Ints, size: int) -> Ints:
        return np.clip(index, 0, size - 2)


@WARP.add("warp-clamp-one-early", small=True)
class _ClampEarly(Port):
    """Fetches are clamped to S - 2."""

    warp_sampler = _OneLess


@WARP.add("warp-whole-texels")
class _WholeTexels(Port):
    """The meshes' corners are rounded to whole texels."""

    def texels(self, points: Floats, size: int) -> Floats:
        return np.rint(super().texels(points, size))
