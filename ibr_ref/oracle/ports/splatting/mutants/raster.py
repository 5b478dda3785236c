"""Bugs in stage 4."""
# An override does what its parent says, but for the fault in the class's docstring.
# ruff: noqa: D102

from __future__ import annotations

from typing import Any

import numpy as np

from ibr_ref.array_types import Bools, Floats
from ibr_ref.oracle.ports.splatting.atlas import Integers
from ibr_ref.oracle.ports.splatting.mutants.seeded import mutant
from ibr_ref.oracle.ports.splatting.raster import Fragments, Raster, Splats


class SizeAsRadius(Raster):
    """The width is taken as the half width."""

    def half(self, width: Floats) -> Floats:
        return width


class ClosedBorders(Raster):
    """Centres on the right and lower borders are covered: <= for <."""

    def end_before(self, high: Floats) -> Floats:
        return np.floor(high - 0.5) + 1.0


class FlippedBorders(Raster):
    """Rows are drawn upside down and flipped on read-back: the upper border is open, the lower one closed."""

    def span_of_rows(self, center: Floats, half: Floats, count: int) -> tuple[Integers, Integers]:
        first, end = self.span(count - center, half, count)
        return count - end, count - first


class CenterOfThePixel(Raster):
    """Splats are moved to the middle of the pixel that holds their centre."""

    def snapped(self, window: Floats) -> Floats:
        return np.floor(window) + 0.5


class EighthsOfPixels(Raster):
    """Centres are snapped to 1/8 pixel."""

    def snapped(self, window: Floats) -> Floats:
        return np.rint(8.0 * window) / 8.0


class AtLeastOnePixel(Raster):
    """Splats below one pixel are drawn one pixel wide."""

    def size(self, width: Floats) -> Floats:
        return np.maximum(width, 1.0)


class LessOrEqual(Raster):
    """On a tie the later splat wins: LEQUAL."""

    def passes(self, new: Floats, old: Floats) -> Bools:
        return new <= old


class NoDepthTest(Raster):
    """The last splat wins, whatever its depth."""

    def passes(self, new: Floats, old: Floats) -> Bools:
        return np.ones_like(new, bool)


class DepthOfSixteenBits(Raster):
    """The depth buffer has 16 bits."""

    def stored_depth(self, depth: Floats) -> Floats:
        return np.floor(65535.0 * depth + 0.5) / 65535.0


class SquaresForDiscs(Raster):
    """Discs are drawn as squares."""

    def in_disc(self, splats: Splats, fragments: Fragments) -> Bools:
        return np.ones(len(fragments.splat), bool)


class DiscHalfPercentSmaller(Raster):
    """The disc's radius is 0.5 % too small."""

    def squared_radius(self, width: Floats) -> Floats:
        return 0.990025 * super().squared_radius(width)


class NumberedByImage(Raster):
    """Winners are numbered from 0 in every image: gl_VertexID without the first vertex of the draw."""

    def names(self, vertices: dict[str, Any], vertex: Integers) -> Integers:
        image: Integers = vertices["vertex.source"][:, 0]
        return vertex - np.searchsorted(image, image[vertex])


class OverdrawOfWinners(Raster):
    """Overdraw counts the splats that pass the depth test, not all that cover the pixel: the test is early."""

    def counted(self, passes: Bools) -> Bools:
        return passes


class LastRowUndrawn(Raster):
    """The scissor ends one row too high."""

    def span_of_rows(self, center: Floats, half: Floats, count: int) -> tuple[Integers, Integers]:
        return super().span_of_rows(center, half, count - 1)


class LastSplatUndrawn(Raster):
    """The last splat is left out: count − 1 for count in the draw."""

    def splats(self, vertices: dict[str, Any]) -> Splats:
        return Splats._make(values[:-1] for values in super().splats(vertices))


MUTANTS = (
    mutant(SizeAsRadius),
    mutant(ClosedBorders),
    mutant(FlippedBorders),
    mutant(CenterOfThePixel),
    mutant(EighthsOfPixels),
    mutant(AtLeastOnePixel),
    mutant(LessOrEqual, hidden="points that tie are twins, of the same colour"),
    mutant(NoDepthTest),
    mutant(DepthOfSixteenBits, small=True),
    mutant(SquaresForDiscs),
    mutant(DiscHalfPercentSmaller, small=True),
    mutant(NumberedByImage),
    mutant(OverdrawOfWinners, hidden="nothing but the check reads raster.overdraw"),
    mutant(LastRowUndrawn),
    mutant(LastSplatUndrawn, small=True),
)
