"""By how much a port's rasterization is shifted: for each wrong pixel the way to where the reference has what it has.

With v the varyings of the reference and J their differences per pixel on the same face, the shift s solves J s = v' - v in
the sense of least squares. A sample point half a pixel off shows as (0.5, 0.5) everywhere, other rounding as noise. Splats
have no varyings: of them it is the one shift of all sample points that explains most winners (`splats`).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ibr_ref.array_types import Bools, Bytes, Floats
from ibr_ref.oracle.examination import Examination
from ibr_ref.oracle.report import splats

VARYINGS = {"raster.patch": ("raster.face", "raster.patch_id"), "project.coord": ()}
"""Arrays of varyings, and what pixels of one face have in common; of several light samples the first is looked at."""

FARTHEST = 2.0
"""Pixels: what is farther off is no shift, but another thing."""

_MOST_LEFT = 0.1
"""Share of what differs that a shift may leave unexplained."""


@dataclass(frozen=True)
class Shift:
    """Of one array."""

    array: str
    pixels: Floats
    """(H, W, 2): columns and rows, in pixels; NaN where nothing is wrong, or no shift explains it."""
    wrong: int
    """Pixels that are wrong."""

    @property
    def explained(self) -> int:
        """How many of them a shift explains."""
        return int(np.isfinite(self.pixels[..., 0]).sum())

    @property
    def median(self) -> tuple[float, float]:
        """Across and down."""
        across, down = np.nanmedian(self.pixels.reshape(-1, 2), axis=0).tolist()
        return across, down

    @property
    def picture(self) -> Bytes:
        """(H, W, 3): grey is no shift, red grows to the right, green downwards; black where there is none."""
        known = np.isfinite(self.pixels).all(axis=-1)
        shown = np.zeros((*known.shape, 3), np.uint8)
        shown[known, :2] = np.clip(127.5 + 127.5 * self.pixels[known], 0.0, 255.0)
        shown[known, 2] = 127
        return shown


def shift(examination: Examination) -> Shift | None:
    """Of the varyings that are wrong; None: none are, or were not handed in, or no pixel is explained by any."""
    case, handed = examination.case, examination.handed
    for array in (*VARYINGS, splats.WINNER):
        judgement = next((j for j in examination.judgements if array in j.arrays), None)
        if judgement is None or not judgement.wrong.any() or array not in handed:
            continue
        wrong = _first_sample(judgement.wrong, 2)
        with np.errstate(all="ignore"):
            if array == splats.WINNER:
                pixels = splats.shifts(case, handed, wrong)
            else:
                ours, theirs = (_first_sample(np.asarray(a[array]), 3) for a in (case.frame.stages, handed))
                pixels = _shifts(ours, theirs, [np.asarray(case.frame.stages[name]) for name in VARYINGS[array]])
        pixels[~wrong] = np.nan
        found = Shift(array, pixels, int(wrong.sum()))
        return found if found.explained else None
    return None


def _first_sample(array: NDArray[Any], axes: int) -> NDArray[Any]:
    """Without a leading axis of light samples."""
    return array[0] if array.ndim > axes else array


def _shifts(ours: Floats, theirs: Floats, labels: list[NDArray[np.generic]]) -> Floats:
    """(H, W, 2) of all pixels."""
    across, down = _difference(ours, labels, 1), _difference(ours, labels, 0)
    off = theirs - ours
    aa, ab, bb = ((x * y).sum(axis=-1) for x, y in ((across, across), (across, down), (down, down)))
    a, b = (across * off).sum(axis=-1), (down * off).sum(axis=-1)
    determinant = aa * bb - ab * ab
    found = np.stack([(bb * a - ab * b) / determinant, (aa * b - ab * a) / determinant], axis=-1)
    left = off - found[..., :1] * across - found[..., 1:] * down
    near = (np.abs(found).max(axis=-1) <= FARTHEST) & (determinant > 0.0)
    small = (left * left).sum(axis=-1) <= _MOST_LEFT**2 * (off * off).sum(axis=-1)
    found[~np.asarray(near & small)] = np.nan
    return found


def _difference(values: Floats, labels: list[NDArray[np.generic]], axis: int) -> Floats:
    """Per pixel along an axis, to a neighbour on the same face; NaN where there is none."""
    ahead = np.roll(values, -1, axis) - values
    there: Bools = np.ones(values.shape[:2], np.bool_)
    for label in labels:
        there &= np.roll(label, -1, axis) == label
    last = [slice(None)] * 2
    last[axis] = slice(-1, None)
    there[tuple(last)] = False
    before, here = np.roll(ahead, 1, axis), np.roll(there, 1, axis)
    return np.where(there[..., None], ahead, np.where(here[..., None], before, np.nan))
