"""Stage 1: maps of the caster alone."""

from __future__ import annotations

import numpy as np

from ibr_ref.array_types import Floats
from ibr_ref.oracle.ports.shadows.lights import Lights
from ibr_ref.oracle.ports.shadows.raster import Fragments, Raster


class Maps(Lights):
    """The nine maps, and those of method "direct"."""

    def widened_range(self) -> Floats:
        """(2, 2) ends of the offsets on x and y, so that every sample finds its place."""
        moves = np.abs([self.displacement(place) for place in self.places]).max(axis=0)
        low, high = self.ops.number(self.scene.offset_range).T
        return np.stack([self.ops.subtract(low, moves), self.ops.add(high, moves)], axis=1)

    def middle(self, own: float, low: float, high: float) -> float:
        """Of the three offsets on one axis: the light's own, where it lies between the ends."""
        own = min(max(own, low), high)
        return float(self.ops.multiply(self.ops.add(low, high), 0.5)) if own in (low, high) else own

    def positions(self) -> Floats:
        """(3, 3, 2) the object's offsets, [j, i] = (x_i, y_j)."""
        own = self.on_axes(self.centre)
        x, y = (
            (low, self.middle(float(at), low, high), high) for at, (low, high) in zip(own, self.ends(), strict=True)
        )
        return np.array([[(a, b) for a in x] for b in y])

    def ends(self) -> list[tuple[float, float]]:
        """Of the offsets, on x and y."""
        return [(float(low), float(high)) for low, high in self.widened_range()]

    def nine_maps(self, positions: Floats) -> Floats:
        """(3, 3, S, S) of the caster from the light's centre."""
        raster, view = self.map_raster(self.ops), self.light_view(self.centre)
        return np.stack([np.stack([self.caster_map(raster, offset, view) for offset in line]) for line in positions])

    def direct_map(self, place: Floats) -> Floats:
        """(S, S) of the caster where it is, as a sample sees it."""
        return self.caster_map(self.direct_raster(self.ops), self.offset, self.light_view(place))

    def caster_vertices(self, offset: Floats) -> list[Floats]:
        """Three (V,): v + x a + y b."""
        vertices = self.ops.number(self.scene.caster.vertices)
        moved = [self.ops.multiply(offset[i], self.axes[i]) for i in range(2)]
        return list(self.ops.sum([vertices, *moved]).T)

    def caster_map(self, raster: Raster, offset: Floats, view: Floats) -> Floats:
        """(S, S) coverage or window depth of the caster at an offset."""
        mask = self.params.content == "mask"
        fine = self.params.map_size * (self.params.map_samples if mask else 1)
        corners, _ = raster.clip(self.caster_corners(raster, offset, view))
        x, y, z = raster.window(corners, fine, fine)
        fragments = raster.cover(x, y, fine, fine)
        return self.coverage(fragments, fine) if mask else self.depths(raster, fragments, z, fine)

    def caster_corners(self, raster: Raster, offset: Floats, view: Floats) -> Floats:
        """(T, 3, 4) in clip space."""
        world = self.caster_vertices(offset)
        seen = raster.transform(view, [*world, np.ones_like(world[0])])
        clip = np.stack(raster.transform(self.clip_from_light, seen), axis=-1)
        corners: Floats = clip[np.asarray(self.scene.caster.triangles)]
        return corners

    def coverage(self, fragments: Fragments, fine: int) -> Floats:
        """(S, S) share of the k x k samples of a texel that are covered: masks have no depth test."""
        covered = np.zeros(fine * fine)
        covered[fragments.pixel] = 1.0
        size, k = self.params.map_size, self.params.map_samples
        counts = covered.reshape(size, k, size, k).sum(axis=(1, 3))
        return self.ops.divide(counts, float(k * k))

    def depths(self, raster: Raster, fragments: Fragments, z: Floats, size: int) -> Floats:
        """(S, S) nearest window depths; 1 where empty."""
        depth = self.ops.depth(raster.linear(fragments, z))
        return raster.nearest(fragments.pixel, depth, size * size)[1].reshape(size, size)
