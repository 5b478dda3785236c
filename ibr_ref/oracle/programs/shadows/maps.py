"""Stage 1: maps of the caster alone."""

from __future__ import annotations

from functools import reduce

import numpy as np

from ibr_ref.oracle.programs.program import Bools, Floats, Vector
from ibr_ref.oracle.programs.shadows.lights import Lights, Matrix
from ibr_ref.oracle.programs.shadows.raster import Fragments, Raster


class Maps(Lights):
    """The nine maps, and those of method "direct"."""

    def widened_range(self) -> list[Vector]:
        """Two ends of the offsets on x, and on y, so that every sample finds its place."""
        moves = reduce(self.do.greatest, [np.abs(self.displacement(place)) for place in self.places])
        low, high = (self.do.number(end) for end in np.transpose(self.scene.offset_range))
        return list(zip(self.do.subtract(low, moves), self.do.add(high, moves), strict=True))

    def middle(self, own: Floats, low: Floats, high: Floats) -> Floats:
        """Of the three offsets on one axis: the light's own where it lies between the ends, else the range's middle."""
        return self.do.pick(self.between_ends(own, low, high), lambda: own, lambda: self.halfway(low, high))

    def between_ends(self, own: Floats, low: Floats, high: Floats) -> Bools:
        """Whether the light's own coordinate lies in the range, and on neither end."""
        return (own > low) & (own < high)

    def halfway(self, low: Floats, high: Floats) -> Floats:
        """The range's middle."""
        return self.do.multiply(self.do.add(low, high), 0.5)

    def positions(self) -> Floats:
        """(3, 3, 2) the object's offsets, [j, i] = (x_i, y_j)."""
        own = self.on_axes(self.centre)
        x, y = ((low, self.middle(at, low, high), high) for at, (low, high) in zip(own, self.ends(), strict=True))
        return np.stack([np.stack([np.stack([a, b]) for a in x]) for b in y])

    def ends(self) -> list[Vector]:
        """Of the offsets, on x and y."""
        return self.widened_range()

    def nine_maps(self, positions: Floats) -> Floats:
        """(3, 3, S, S) of the caster from the light's centre."""
        return np.stack([np.stack([self.centre_map(offset) for offset in line]) for line in positions])

    def centre_map(self, offset: Floats) -> Floats:
        """(S, S) of the caster at an offset, from the light's centre."""
        return self.caster_map(self.map_raster(self.do), self.caster_clip(offset, self.light_view(self.centre)))

    def direct_map(self, place: Floats) -> Floats:
        """(S, S) of the caster where it is, as a sample sees it."""
        return self.caster_map(self.direct_raster(self.do), self.direct_clip(place))

    def direct_clip(self, place: Floats) -> Vector:
        """Of the caster where it is, or of one moved the opposite way from the centre: the sample sees the same."""
        clip = self.caster_clip(self.offset, self.light_view(place))
        return self.do.either(clip, lambda: self.moved_clip(place))

    def moved_clip(self, place: Floats) -> Vector:
        """From the centre, of the caster moved the opposite way."""
        return self.caster_clip(self.place_of_object(place), self.light_view(self.centre))

    def caster_vertices(self, offset: Floats) -> Vector:
        """Three (V,): v + x a + y b."""
        vertices = list(self.do.matrix(self.scene.caster.vertices).T)
        moved = [[self.do.multiply(offset[i], x) for x in self.axes[i]] for i in range(2)]
        return [self.do.sum([vertices[k], moved[0][k], moved[1][k]]) for k in range(3)]

    def caster_map(self, raster: Raster, clip: Vector) -> Floats:
        """(S, S) coverage or window depth of the caster, of clip coordinates (V,)."""
        if self.do.bounded:
            return self.do.caster_map(self, raster, clip)
        mask = self.params.content == "mask"
        fine = self.params.map_size * (self.params.map_samples if mask else 1)
        corners, _ = raster.clip(np.stack(clip, axis=-1)[np.asarray(self.scene.caster.triangles)])
        x, y, z = raster.window(corners, fine, fine)
        fragments = raster.cover(x, y, fine, fine)
        return self.coverage(fragments, fine) if mask else self.depths(raster, fragments, z, fine)

    def caster_clip(self, offset: Floats, view: Matrix) -> Vector:
        """Four (V,) of the caster at an offset."""
        return self.clip_coordinates(self.light_projection, view, self.caster_vertices(offset))

    def coverage(self, fragments: Fragments, fine: int) -> Floats:
        """(S, S) share of the k x k samples of a texel that are covered: masks have no depth test."""
        covered = np.zeros(fine * fine)
        covered[fragments.pixel] = 1.0
        return self.share(covered.reshape(fine, fine))

    def share(self, covered: Floats) -> Floats:
        """(S, S) of the samples (k S, k S) of each texel."""
        size, k = self.params.map_size, self.params.map_samples
        return self.do.divide(covered.reshape(size, k, size, k).sum(axis=(1, 3)), float(k * k))

    def depths(self, raster: Raster, fragments: Fragments, z: Floats, size: int) -> Floats:
        """(S, S) nearest window depths; 1 where empty."""
        depth = self.do.depth(raster.linear(fragments, z))
        return raster.nearest(fragments.pixel, depth, size * size)[1].reshape(size, size)
