"""Bugs in where the object is as a sample of the light sees it, and in maps that are rendered for each sample."""

from __future__ import annotations

import numpy as np

from ibr_ref.oracle.faults.bugs import Bugs
from ibr_ref.oracle.faults.shadows.systems import MAPPED
from ibr_ref.oracle.programs.program import Bools, Floats, Vector
from ibr_ref.oracle.programs.shadows.port import Port
from ibr_ref.oracle.programs.shadows.raster import Raster

SAMPLES = Bugs("warp", only=("warp",))

PLACED = ("warp", "grid")
"""Where the object's place as a sample sees it matters."""

ANY_ORDER = "the sum of all samples is the same in any order"


@SAMPLES.add("warp-listed-by-distance", only=MAPPED, hidden=ANY_ORDER)
class _ByDistance(Port):
    """Samples that are listed are taken from the light's centre outwards."""

    def sample_places(self) -> Vector:
        places = super().sample_places()
        if not isinstance(self.params.light_samples, np.ndarray):
            return places
        return sorted(places, key=self._away)

    def _away(self, place: Floats) -> float:
        way = list(place - self.centre)
        return float(self.do.dot(way, way))


@SAMPLES.add("warp-sample-sign", only=PLACED)
class _SampleSign(Port):
    """The object moves with the sample of the light, not against it."""

    def place_of_object(self, place: Floats) -> Floats:
        return self.do.add(self.offset, self.displacement(place))


@SAMPLES.add("warp-world-xy", only=PLACED)
class _WorldXY(Port):
    """The sample's world x and y are taken for those on the axes."""

    def place_of_object(self, place: Floats) -> Floats:
        return self.do.subtract(self.offset, self.do.subtract(place, self.centre)[:2])


@SAMPLES.add("warp-samples-transposed", only=MAPPED, hidden="the sum of the samples is the same")
class _SamplesTransposed(Port):
    """Samples of the light are taken with i outer and j inner."""

    def steps(self) -> list[tuple[float, float]]:
        return [(y, x) for x, y in super().steps()]


@SAMPLES.add("warp-direct-from-centre", only=("direct",))
class _DirectFromCentre(Port):
    """Every sample's map is rendered from the light's centre."""

    def direct_map(self, place: Floats) -> Floats:
        return super().direct_map(self.centre)


class _Back(Raster):
    def passes(self, depth: Floats, held: Floats) -> Bools:
        return (held == 1.0) | (depth > held)


@SAMPLES.add("warp-direct-back-faces", only=("direct",))
class _DirectBack(Port):
    """Maps that are rendered for each sample keep the caster's farthest depths."""

    direct_raster = _Back


@SAMPLES.add("warp-direct-depth-truncated", only=("direct",), small=True)
class _DirectTruncated(Port):
    """Maps that are rendered for each sample hold depths truncated to bytes."""

    def direct_map(self, place: Floats) -> Floats:
        return np.floor(super().direct_map(place) * 255.0) / 255.0


@SAMPLES.add("warp-samples-not-moved", only=PLACED)
class _NotMoved(Port):
    """The map of the light's centre serves all samples."""

    def place_of_object(self, place: Floats) -> Floats:
        return 1.0 * self.offset
