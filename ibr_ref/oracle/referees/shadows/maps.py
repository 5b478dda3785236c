"""Stage maps: what a map of the caster alone may be, texel by texel."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from ibr_ref.array_types import Bools, Floats, Ints
from ibr_ref.oracle.accept.bounded import Bounded
from ibr_ref.oracle.accept.coverage import Fragments, fragments
from ibr_ref.oracle.accept.seams import owners
from ibr_ref.oracle.accept.winners import Winners, winners
from ibr_ref.oracle.device import UNIT, Device
from ibr_ref.oracle.referees.shadows.clipping import clipped
from ibr_ref.oracle.referees.shadows.transform import Lens, placed
from ibr_ref.oracle.referees.shadows.varyings import Triangles, linear

VISIBLE = 1.0 / 255.0
"""A step of what is shown: alternatives that differ by less are not counted as undecided."""


@dataclass(frozen=True, eq=False)
class Map:
    """What is fetched: the map as the reference (or, replayed, the port) has it, and what else a texel may be."""

    firm: Bounded
    """(S, S) with the decisions that were made."""
    low: Floats
    """(S, S) the least of all legal texels."""
    high: Floats
    spoiled: Bools
    """(S, S) the port's texel is no number: `firm` has the reference's."""

    @classmethod
    def of(cls, firm: Bounded, spoiled: Bools | None = None) -> Map:
        """A map without open decisions."""
        return cls(firm, firm.low, firm.high, np.zeros(firm.value.shape, np.bool_) if spoiled is None else spoiled)


@dataclass(frozen=True, eq=False)
class Drawn:
    """Fragments of the caster in a window."""

    found: Fragments
    pixel: Ints
    depth: Bounded | None
    winners: Winners | None
    """Of a map of depths."""
    covered: tuple[Bools, Bools]
    """(S, S) each: certainly, possibly."""
    wild: bool
    """A plane may or may not cut it: anything is legal."""


def names_of(points: Sequence[Bounded]) -> Ints:
    """(V,) one number for vertices that are one point."""
    return np.unique(np.stack([p.value for p in points], axis=1), axis=0, return_inverse=True)[1].reshape(-1)


def drawn(case: Any, lens: Lens, offset: Sequence[Bounded], size: int) -> Drawn:
    """The caster at an offset, in a window of size x size."""
    points = placed(case.scene, offset)
    triangles = np.asarray(case.scene.caster.triangles)
    cut = clipped(lens.clip_of(points), triangles, names_of(points), size, size)
    found = fragments(cut.x, cut.y, size, size)
    owned = owners(found, cut.names, size)
    pixel = found.rows * size + found.columns
    possible, certain = np.zeros(size * size, np.bool_), np.zeros(size * size, np.bool_)
    possible[pixel] = True
    certain[pixel[owned.drawn]] = True
    if cut.wild:
        possible[:], certain[:] = True, False
    covered = certain.reshape(size, size), possible.reshape(size, size)
    if case.params.content == "mask":
        return Drawn(found, pixel, None, None, covered, cut.wild)
    (depth,) = linear(Triangles.of(cut.x, cut.y, size, size, cut.setups), found, [cut.z])
    depth = depth.widened(cut.z.device.depth_step)
    won = winners(pixel, owned.drawn, depth.low, depth.high, size * size, owner=owned.owner)
    return Drawn(found, pixel, depth, won, covered, cut.wild)


def counts(covered: Bools, k: int) -> Floats:
    """(S, S) of k x k samples a texel, as a share."""
    size = len(covered) // k
    return np.asarray(covered.reshape(size, k, size, k).sum(axis=(1, 3)) / float(k * k))


def rendered(case: Any, lens: Lens, offset: Sequence[Bounded], reference: Floats) -> Map:
    """The map that is drawn for the object at an offset; reference (S, S): as the reference has it."""
    size, device = int(case.params.map_size), offset[0].device
    if case.params.content == "mask":
        k = int(case.params.map_samples)
        low, high = (counts(each, k) for each in drawn(case, lens, offset, k * size).covered)
        none = np.zeros(reference.shape, np.bool_)
        return Map(Bounded(reference, np.zeros_like(reference), device), low, high, none)
    found = drawn(case, lens, offset, size)
    return _depths(found, reference, device)


def _depths(found: Drawn, reference: Floats, device: Device) -> Map:
    assert found.depth is not None
    assert found.winners is not None
    shown, flat = found.winners.possible, reference.reshape(-1)
    pixel, depth = found.pixel[shown], found.depth[shown]
    low, high = _hull(found, flat.size)
    off = np.abs(depth.value - flat[pixel])
    nearest, error = np.full(flat.size, np.inf), np.zeros(flat.size)
    np.minimum.at(nearest, pixel, off)
    mine = off == nearest[pixel]
    np.maximum.at(error, pixel[mine], np.minimum(depth.error[mine], 1.0))  # depths lie in [0, 1]
    error[flat == 1.0] = 0.0
    firm = Bounded(reference, error.reshape(reference.shape), device)
    low, high = (a.reshape(reference.shape) for a in (low, high))
    none = np.zeros(reference.shape, np.bool_)
    return Map(firm, np.minimum(low, firm.low), np.maximum(high, firm.high), none)


def _hull(found: Drawn, texels: int) -> tuple[Floats, Floats]:
    """(texels,) each: the least and the largest legal depth."""
    assert found.depth is not None
    assert found.winners is not None
    shown = found.winners.possible
    pixel, depth = found.pixel[shown], found.depth[shown]
    low, high = np.ones(texels), np.where(found.winners.empty, 1.0, 0.0)
    np.minimum.at(low, pixel, np.maximum(depth.low, 0.0))
    np.maximum.at(high, pixel, np.minimum(depth.high, 1.0))
    return (np.zeros(texels), np.ones(texels)) if found.wild else (low, high)


def allows(case: Any, lens: Lens, offset: Sequence[Bounded], image: Floats) -> tuple[Bools, Bools, Floats]:
    """(S, S) each, of a port's own map: whether it is legal, whether another outcome is, and the width of what is."""
    size, device = int(case.params.map_size), offset[0].device
    if case.params.content == "mask":
        k = int(case.params.map_samples)
        low, high = (counts(each, k) for each in drawn(case, lens, offset, k * size).covered)
        with np.errstate(invalid="ignore"):
            share = np.rint(image * (k * k)) / (k * k)
            # A count over k^2, as a quotient or a product with a rounded inverse.
            whole = np.abs(image - share) <= (device.quotient + device.operation) * UNIT
            return whole & (low <= share) & (share <= high), low < high, np.zeros(image.shape)
    found = drawn(case, lens, offset, size)
    assert found.depth is not None
    assert found.winners is not None
    shown = found.winners.possible
    pixel, depth = found.pixel[shown], found.depth[shown]
    flat = image.reshape(-1)
    legal = (found.winners.empty & (flat == 1.0)) | found.wild
    legal[pixel[depth.allows(flat[pixel])]] = True
    width = np.zeros(flat.size)
    np.maximum.at(width, pixel, 2.0 * depth.error)
    low, high = _hull(found, flat.size)
    undecided = high - low > width + VISIBLE
    return legal.reshape(image.shape), undecided.reshape(image.shape), width.reshape(image.shape)
