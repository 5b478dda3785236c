"""Stage maps: what a map of the caster alone may be, texel by texel."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from ibr_ref.affine.rows import UNIT
from ibr_ref.array_types import Bools, Floats, Ints
from ibr_ref.oracle.accept.bounded import Bounded
from ibr_ref.oracle.accept.coverage import Fragments
from ibr_ref.oracle.accept.winners import Winners
from ibr_ref.oracle.device import Device
from ibr_ref.oracle.programs.shadows.raster import Raster
from ibr_ref.oracle.referees.shadows.drawing import Pass, names_of, pixels_of
from ibr_ref.oracle.referees.shadows.model import Model
from ibr_ref.oracle.referees.shadows.transform import centered

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
    drawn: Bounded
    """(S, S) all that a texel may be that is not empty."""
    vacant: Bools
    """(S, S) texels that may be empty, whatever `drawn` is."""

    @classmethod
    def of(cls, firm: Bounded, spoiled: Bools | None = None) -> Map:
        """A map without open decisions."""
        none = np.zeros(firm.value.shape, np.bool_)
        return cls(firm, firm.low, firm.high, none if spoiled is None else spoiled, firm, none)


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


def drawn(model: Model, raster: Raster, clip: Sequence[Any]) -> Drawn:
    """The caster in a window, of clip coordinates (V,)."""
    case, mask = model.case, model.case.params.content == "mask"
    size = int(model.program.params.map_size) * (int(model.program.params.map_samples) if mask else 1)
    caster, window = case.scene.caster, Pass(model, raster, size, size)
    cut = window.cut([model.bounded(x) for x in clip], np.asarray(caster.triangles), names_of(caster.vertices))
    found = window.cover(cut.x, cut.y)
    owned = window.owners(found, cut.names)
    pixel = pixels_of(found, size)
    possible, certain = np.zeros(size * size, np.bool_), np.zeros(size * size, np.bool_)
    possible[pixel] = True
    certain[pixel[owned.drawn]] = True
    if cut.wild:
        possible[:], certain[:] = True, False
    covered = certain.reshape(size, size), possible.reshape(size, size)
    if mask:
        return Drawn(found, pixel, None, None, covered, cut.wild)
    varyings = window.varyings(cut)
    depth = model.bounded(model.machine.depth(varyings.linear(found, model.number(cut.z))))
    won = window.winners(pixel, owned.drawn, depth, owned.owner)
    return Drawn(found, pixel, depth, won, covered, cut.wild)


def counts(covered: Bools, k: int) -> Floats:
    """(S, S) of k x k samples a texel, as a share."""
    size = len(covered) // k
    return np.asarray(covered.reshape(size, k, size, k).sum(axis=(1, 3)) / float(k * k))


def rendered(model: Model, raster: Raster, clip: Sequence[Any], reference: Floats) -> Map:
    """The map that is drawn of the caster; reference (S, S): as exact arithmetic has it."""
    found = drawn(model, raster, clip)
    if model.case.params.content == "mask":
        low, high = (counts(each, int(model.program.params.map_samples)) for each in found.covered)
        none = np.zeros(reference.shape, np.bool_)
        firm = Bounded(reference, np.zeros_like(reference), model.device)
        return Map(firm, low, high, none, centered(low, high, model.device), none)
    return _depths(found, reference, model.device)


def hull(model: Model, raster: Raster, clip: Sequence[Any]) -> Bounded:
    """(S, S) all that the texels may be, and what lies between."""
    found, size = drawn(model, raster, clip), int(model.program.params.map_size)
    if model.case.params.content == "mask":
        low, high = (counts(each, int(model.program.params.map_samples)) for each in found.covered)
        share = centered(low, high, model.device)
        return Bounded(share.value, share.error + quotient_of_counts(model.device) * high, model.device)
    low, high = (end.reshape(size, size) for end in _hull(found, size * size))
    return centered(low, high, model.device)


def quotient_of_counts(device: Device) -> float:
    """Relative error of a count over k^2, as a quotient or a product with a rounded inverse."""
    return (device.quotient + device.operation) * UNIT


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
    low, high = np.minimum(low, firm.low), np.maximum(high, firm.high)
    deepest = np.where(flat < 1.0, firm.high.reshape(-1), 0.0)
    np.maximum.at(deepest, pixel, np.minimum(depth.high, 1.0))
    deepest, empty = deepest.reshape(reference.shape), found.winners.empty.reshape(reference.shape)
    deepest = np.where((deepest == 0.0) | found.wild, 1.0, deepest)
    return Map(
        firm, low, high, none, centered(np.maximum(low, 0.0), np.minimum(deepest, 1.0), device), empty | found.wild
    )


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


def allows(model: Model, raster: Raster, clip: Sequence[Any], image: Floats) -> tuple[Bools, Bools, Floats]:
    """(S, S) each, of a port's own map: whether it is legal, whether another outcome is, and the width of what is."""
    found, device = drawn(model, raster, clip), model.device
    if model.case.params.content == "mask":
        k = int(model.program.params.map_samples)
        low, high = (counts(each, k) for each in found.covered)
        with np.errstate(invalid="ignore"):
            share = np.rint(image * (k * k)) / (k * k)
            whole = np.abs(image - share) <= quotient_of_counts(device)
            return whole & (low <= share) & (share <= high), low < high, np.zeros(image.shape)
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
