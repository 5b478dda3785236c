"""Bugs of parallax mapping."""

from __future__ import annotations

from ibr_ref.oracle.faults.bugs import Bugs
from ibr_ref.oracle.programs.displacement.case import Floats, Patch, Vector
from ibr_ref.oracle.programs.displacement.march import Rays
from ibr_ref.oracle.programs.displacement.searches.below import Found
from ibr_ref.oracle.programs.displacement.searches.welsh import Welsh

WELSH = Bugs("march")
ONLY = ("welsh",)


@WELSH.add("no offset limiting", only=ONLY)
class _Unlimited(Welsh):
    """The way to the eye is divided by its height: parallax mapping as Kaneko 2001 has it."""

    def limited(self, raised: Floats, along: Floats, length: Floats) -> Floats:
        return self.do.multiply(raised, along)


@WELSH.add("height with a bias of a half", only=ONLY)
class _Biased(Welsh):
    """The height is read as H - 1/2: what lies in the middle does not move."""

    def read(self, height: Floats) -> Floats:
        return self.do.subtract(height, 0.5)


@WELSH.add("length of the way in patch space", only=ONLY)
class _PatchLength(Welsh):
    """The way to the eye is normalized in (u, v, h), where lengths mean nothing."""

    def length(self, patch: Patch, rays: Rays) -> Floats:
        way = [rays.way[0], rays.way[1], 1.0]
        return self.do.root(self.do.dot(way, way))


@WELSH.add("length along the polygon", only=ONLY)
class _FlatLength(Welsh):
    """The way to the eye is normalized without its height."""

    def length(self, patch: Patch, rays: Rays) -> Floats:
        way = self.combined([patch.edge_u, patch.edge_v], [-x for x in rays.way[:2]])
        return self.do.root(self.do.dot(way, way))


@WELSH.add("offset taken twice", only=ONLY)
class _Twice(Welsh):
    """A second step from the first one's end, by the height there: iterated parallax mapping."""

    def place(self, patch: Patch, rays: Rays, found: Found) -> Vector:
        u, v, h = super().place(patch, rays, found)
        return super().place(patch, Rays([u, v, h], rays.way), found)


@WELSH.add("height in 8 bits", small=True, only=ONLY)
class _Bytes(Welsh):
    """The fetched height goes through an 8-bit channel."""

    def read(self, height: Floats) -> Floats:
        return self.do.divide(self.do.whole(self.do.add(self.do.multiply(height, 255.0), 0.5)), 255.0)
