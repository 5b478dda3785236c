"""Bugs of the raster stage."""

from __future__ import annotations

import numpy as np

from ibr_ref.oracle.faults.bugs import Bugs
from ibr_ref.oracle.programs.splatting.case import Bools, Floats, Ints, Vector
from ibr_ref.oracle.programs.splatting.port import Port
from ibr_ref.oracle.programs.splatting.raster import Fragments, Splats

RASTER = Bugs("raster")


@RASTER.add("size-as-radius")
class _SizeAsRadius(Port):
    """The width is taken as the half width."""

    def half(self, width: Floats) -> Floats:
        return width


@RASTER.add("closed-borders")
class _ClosedBorders(Port):
    """Centres on the right and lower borders are covered: <= for <."""

    def end_before(self, high: Floats) -> Floats:
        return np.floor(high - 0.5) + 1.0


@RASTER.add("flipped-borders")
class _FlippedBorders(Port):
    """Rows are drawn upside down and flipped on read-back: the upper border is open, the lower one closed."""

    def span_of_rows(self, center: Floats, half: Floats, count: int) -> tuple[Floats, Floats]:
        first, end = self.span(count - center, half, count)
        return count - end, count - first


@RASTER.add("center-of-the-pixel")
class _CenterOfThePixel(Port):
    """Splats are moved to the middle of the pixel that holds their centre."""

    def snapped(self, window: Floats) -> Floats:
        return np.floor(window) + 0.5


@RASTER.add("eighths-of-pixels")
class _EighthsOfPixels(Port):
    """Centres are snapped to 1/8 pixel."""

    def snapped(self, window: Floats) -> Floats:
        return np.rint(8.0 * window) / 8.0


@RASTER.add("at-least-one-pixel")
class _AtLeastOnePixel(Port):
    """Splats below one pixel are drawn one pixel wide."""

    def size(self, width: Floats) -> Floats:
        return np.maximum(width, 1.0)


@RASTER.add("an-eighth-beside")
class _AnEighthBeside(Port):
    """Point sprites lie 1/8 pixel to the right of and below their points, as softpipe draws them: quads do not."""

    def borders(self, center: Floats, half: Floats) -> tuple[Floats, Floats]:
        low, high = super().borders(center, half)
        return low + 0.125, high + 0.125


@RASTER.add("less-or-equal", hidden="points that tie are twins, of the same colour")
class _LessOrEqual(Port):
    """On a tie the later splat wins: LEQUAL."""

    def passes(self, new: Floats, old: Floats) -> Bools:
        return new <= old


@RASTER.add("no-depth-test")
class _NoDepthTest(Port):
    """The last splat wins, whatever its depth."""

    def passes(self, new: Floats, old: Floats) -> Bools:
        return np.ones(np.shape(new), np.bool_)


@RASTER.add("depth-of-sixteen-bits", small=True)
class _DepthOfSixteenBits(Port):
    """The depth buffer has 16 bits."""

    def stored_depth(self, depth: Floats) -> Floats:
        return np.floor(65535.0 * depth + 0.5) / 65535.0


@RASTER.add("squares-for-discs")
class _SquaresForDiscs(Port):
    """Discs are drawn as squares."""

    def in_disc(self, splats: Splats, fragments: Fragments) -> Bools:
        return np.ones(len(fragments.splat), np.bool_)


@RASTER.add("disc-half-percent-smaller", small=True)
class _DiscHalfPercentSmaller(Port):
    """The disc's radius is 0.5 % too small."""

    def squared_radius(self, width: Floats) -> Floats:
        return 0.990025 * super().squared_radius(width)


@RASTER.add("numbered-by-image")
class _NumberedByImage(Port):
    """Winners are numbered from 0 in every image: gl_VertexID without the first vertex of the draw."""

    def names(self, image: Ints, vertex: Ints) -> Ints:
        return vertex - np.searchsorted(image, image[vertex])


@RASTER.add("overdraw-of-winners", hidden="nothing but the check reads raster.overdraw")
class _OverdrawOfWinners(Port):
    """Overdraw counts the splats that pass the depth test, not all that cover the pixel: the test is early."""

    def counted(self, passes: Bools) -> Bools:
        return passes


@RASTER.add("last-row-undrawn")
class _LastRowUndrawn(Port):
    """The scissor ends one row too high."""

    def span_of_rows(self, center: Floats, half: Floats, count: int) -> tuple[Floats, Floats]:
        return super().span_of_rows(center, half, count - 1)


@RASTER.add("last-splat-undrawn", small=True)
class _LastSplatUndrawn(Port):
    """The last splat is left out: count − 1 for count in the draw."""

    def splats(self, vertex: Ints, window: Vector, width: Floats, depth: Floats) -> Splats:
        return Splats._make(values[:-1] for values in super().splats(vertex, window, width, depth))


@RASTER.add("farthest-wins")
class _FarthestWins(Port):
    """GREATER for LESS, of what is drawn at all."""

    def passes(self, new: Floats, old: Floats) -> Bools:
        return ((old == 1.0) & (new < old)) | ((old != 1.0) & (new > old))


@RASTER.add("first-wins")
class _FirstWins(Port):
    """What is drawn is never overdrawn: NOTEQUAL to nothing, in place of a depth test."""

    def passes(self, new: Floats, old: Floats) -> Bools:
        return (old == 1.0) & (new < 1.0)


@RASTER.add("nearer-by-a-margin", small=True)
class _NearerByAMargin(Port):
    """A splat must be nearer by 1/10000 to win: an epsilon against flicker."""

    def passes(self, new: Floats, old: Floats) -> Bools:
        return new < np.where(old == 1.0, old, old - 1e-4)


@RASTER.add("polygon-offset", hidden="the depths keep their order, hence the colours")
class _PolygonOffset(Port):
    """Depths are moved by 1/2^15: glPolygonOffset is left on."""

    def stored_depth(self, depth: Floats) -> Floats:
        return super().stored_depth(depth + 2.0**-15)


@RASTER.add("points-of-whole-pixels")
class _PointsOfWholePixels(Port):
    """Widths are rounded to whole pixels, at least one, as aliased points were in GL 1."""

    def size(self, width: Floats) -> Floats:
        return np.maximum(np.rint(width), 1.0)


@RASTER.add("small-splats-undrawn")
class _SmallSplatsUndrawn(Port):
    """Splats narrower than a pixel are left out as too small to see."""

    def size(self, width: Floats) -> Floats:
        return np.where(width < 1.0, 0.0, width)


@RASTER.add("rows-of-another-aspect")
class _RowsOfAnotherAspect(Port):
    """Quads are as high as wide in normalized device coordinates, not in pixels."""

    def span_of_rows(self, center: Floats, half: Floats, count: int) -> tuple[Floats, Floats]:
        return self.span(center, half * (self.scene.camera.height / self.scene.camera.width), count)


@RASTER.add("viewport-a-row-too-high")
class _ViewportARowTooHigh(Port):
    """The viewport begins one row too high."""

    def span_of_rows(self, center: Floats, half: Floats, count: int) -> tuple[Floats, Floats]:
        return super().span_of_rows(center - 1.0, half, count)


@RASTER.add("diamonds-for-discs")
class _DiamondsForDiscs(Port):
    """|dx| + |dy| ≤ w/2: the corners of the square are cut off straight."""

    def in_disc(self, splats: Splats, fragments: Fragments) -> Bools:
        splat = fragments.splat
        dx = np.abs(self.do.subtract(fragments.column + 0.5, splats.x[splat]))
        dy = np.abs(self.do.subtract(fragments.row + 0.5, splats.y[splat]))
        return self.do.add(dx, dy) <= 0.5 * splats.width[splat]


@RASTER.add("discs-from-the-corner")
class _DiscsFromTheCorner(Port):
    """The disc is measured from the pixels' upper left corners: gl_PointCoord half a pixel off."""

    def in_disc(self, splats: Splats, fragments: Fragments) -> Bools:
        moved = splats._replace(x=splats.x + 0.5, y=splats.y + 0.5)
        return super().in_disc(moved, fragments)


@RASTER.add("disc-half-percent-larger", small=True)
class _DiscHalfPercentLarger(Port):
    """The disc's radius is 0.5 % too large."""

    def squared_radius(self, width: Floats) -> Floats:
        return 1.010025 * super().squared_radius(width)


@RASTER.add("borders-a-subpixel-off", small=True)
class _BordersASubpixelOff(Port):
    """Both borders of a row lie one subpixel too low."""

    def span_of_rows(self, center: Floats, half: Floats, count: int) -> tuple[Floats, Floats]:
        return super().span_of_rows(center + 1.0 / 256.0, half, count)


@RASTER.add("last-column-undrawn", small=True)
class _LastColumnUndrawn(Port):
    """The scissor ends one column too early."""

    def spans(self, splats: Splats) -> tuple[tuple[Floats, Floats], tuple[Floats, Floats]]:
        camera, half = self.scene.camera, self.half(splats.width)
        return self.span(splats.x, half, camera.width - 1), self.span_of_rows(splats.y, half, camera.height)


@RASTER.add("first-splat-undrawn", small=True)
class _FirstSplatUndrawn(Port):
    """The draw begins with the second splat: a first vertex of 1."""

    def splats(self, vertex: Ints, window: Vector, width: Floats, depth: Floats) -> Splats:
        return Splats._make(values[1:] for values in super().splats(vertex, window, width, depth))
