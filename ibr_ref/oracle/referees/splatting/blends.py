"""Ellipses at pixels: what a port may have averaged, its weight, how many, and the colours of that."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from ibr_ref.array_types import Bools, Floats, Ints
from ibr_ref.oracle.arithmetic.number import Number
from ibr_ref.oracle.judgement import Handed
from ibr_ref.oracle.pipeline.blends import Blended, blended
from ibr_ref.oracle.referees.outcomes import stored
from ibr_ref.oracle.referees.splatting.model import Branch, Model, Placed
from ibr_ref.oracle.referees.splatting.table import Table, joined_columns

SUMS = ("raster.weight", "raster.blended")
"""Arrays of ellipses."""


def sums(model: Model, points: Table, placed: Placed, pixel: Ints, splat: Ints) -> Blended:
    """What may be added up of outcomes (r,): a pixel, and the nearest splat there, -1 none."""
    names = np.where(splat >= 0, np.asarray(model.program.names(points.image, np.maximum(splat, 0)), np.int64), -1)
    found = blended(model.program, placed, pixel, splat, names)
    model.machine.run.rows += len(found.of)
    return found


@dataclass(frozen=True, eq=False)
class Averages:
    """m outcomes."""

    row: Ints
    """(m,) the pixel and its nearest splat, among those asked for."""
    lost: Bools
    """(m,) not all of that pixel are here."""
    color: Number
    """(m, 3)."""
    shown: Bools
    """(m,) whether anything is; elsewhere the background."""


def averages(found: Blended, model: Model, branches: list[Branch], weight: Floats | None) -> Averages:
    """Colours of outcomes; weight (m,): the port's own sums, which it divides by, NaN where there are none."""
    low, high = _hull(branches)
    middle = Number(model.machine, 0.5 * (low + high), 0.5 * (high - low))
    of, count = found.of, len(found.row)
    colors = middle[found.splat]
    channels = [model.machine.of(model.program.averaged(found.share, c, of, count)) for c in colors.T]
    average, lost = joined_columns(channels), found.lost
    if weight is not None:
        average = _divided(model, found, average, weight)
    average = average.off_by(np.where(lost, np.inf, 0.0)[:, None])
    return Averages(found.row, lost, average, np.asarray(found.count > 0))


def _hull(branches: list[Branch]) -> tuple[Floats, Floats]:
    """(V, 3) ends of all that points may look like."""
    low, high = branches[0].color.low, branches[0].color.high
    for branch in branches[1:]:
        legal = branch.legal[:, None]
        low = np.where(legal, np.fmin(low, branch.color.low), low)
        high = np.where(legal, np.fmax(high, branch.color.high), high)
    return low, high


def _divided(model: Model, found: Blended, average: Number, weight: Floats) -> Number:
    """By the port's own sums, where they are none of these."""
    others = np.isfinite(weight) & (weight > 0.0) & ~found.weight.allows(weight)
    if not others.any():
        return average
    do = model.machine
    scale = do.where(others, do.divide(found.weight, stored(do, np.where(others, weight, 1.0))), 1.0)
    return joined_columns([do.least(do.multiply(c, scale), 1.0) for c in average.T])


def own_weight(handed: Handed) -> Floats | None:
    """(P,) that was handed in."""
    return np.asarray(handed["raster.weight"], np.float64).reshape(-1) if "raster.weight" in handed else None


def that_agree(found: Blended, pixel: Ints, weight: Floats) -> Blended:
    """Of the outcomes those that have the port's own sums (P,), or all of a pixel where none has."""
    pixels = pixel[found.row]
    fits = found.weight.allows(weight[pixels])
    left = np.zeros(len(weight), np.bool_)
    left[pixels[fits]] = True
    kept = fits | ~left[pixels]
    number = np.cumsum(kept) - 1
    some = kept[found.of]
    return replace(
        found,
        row=found.row[kept],
        lost=found.lost[kept],
        weight=found.weight[np.flatnonzero(kept)],
        count=found.count[kept],
        of=number[found.of[some]],
        splat=found.splat[some],
        share=found.share[np.flatnonzero(some)],
    )
