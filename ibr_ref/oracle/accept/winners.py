"""The depth test where depths and coverage are not exact: which candidates may be what a pixel shows."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ibr_ref.array_types import Bools, Floats


@dataclass(frozen=True, eq=False)
class Winners:
    """What may be shown."""

    possible: Bools
    """(n,) whether the candidate may win its pixel."""
    sure: Bools
    """(n,) whether it must."""
    empty: Bools
    """(pixels,) whether the pixel may show nothing."""


def winners(
    pixel: NDArray[np.int64],
    certain: Bools,
    low: Floats,
    high: Floats,
    pixels: int,
    *,
    owner: NDArray[np.int64] | None = None,
) -> Winners:
    """Judge candidates (n,) for pixels (their index), with depths in [low, high], by the depth test LESS against 1.

    certain: the candidate is drawn at the pixel whatever the device does. Candidates of one `owner` at a pixel are
    alternative outcomes of one fragment, of which one comes about: they do not hide each other, and hide others only as
    far as all of them do (give each of them `certain` if one of them is drawn in any case). A candidate may win if no
    other fragment is certainly nearer; ties may go either way, because equal depths of one device need not be equal on
    another.
    """
    count = len(pixel)
    owner = np.arange(count) if owner is None else owner
    order = np.lexsort((owner, pixel))
    fresh = np.ones(count, np.bool_)
    fresh[1:] = (pixel[order][1:] != pixel[order][:-1]) | (owner[order][1:] != owner[order][:-1])
    group = np.empty(count, np.int64)
    group[order] = np.cumsum(fresh) - 1
    groups = int(fresh.sum())
    farthest, nearest = np.full(groups, -np.inf), np.full(groups, np.inf)
    drawn, group_pixel = np.ones(groups, np.bool_), np.empty(groups, np.int64)
    np.maximum.at(farthest, group, high)
    np.minimum.at(nearest, group, low)
    np.logical_and.at(drawn, group, certain)
    group_pixel[group] = pixel
    blocking = np.where(drawn & (farthest < 1.0), farthest, np.inf)
    first, second = _two_smallest(group_pixel, blocking, pixels)
    others = np.where(first[group_pixel] == blocking, second[group_pixel], first[group_pixel])
    possible = (low <= others[group]) & (low < 1.0)
    rivals = np.zeros(pixels, np.int64)
    may = np.zeros(groups, np.bool_)
    np.logical_or.at(may, group, possible)
    np.add.at(rivals, group_pixel, may)
    empty = ~np.isfinite(first)
    sure = possible & drawn[group] & (rivals[pixel] == 1) & ~empty[pixel]
    return Winners(possible=possible, sure=sure, empty=empty)


def _two_smallest(pixel: NDArray[np.int64], values: Floats, pixels: int) -> tuple[Floats, Floats]:
    """Of each pixel's values; inf where there are fewer."""
    order = np.lexsort((values, pixel))
    sorted_pixel = pixel[order]
    starts = np.flatnonzero(np.r_[True, sorted_pixel[1:] != sorted_pixel[:-1]]) if len(pixel) else np.empty(0, np.int64)
    first, second = np.full(pixels, np.inf), np.full(pixels, np.inf)
    first[sorted_pixel[starts]] = values[order][starts]
    follows = starts + 1
    has = follows < len(order)
    has[has] = sorted_pixel[follows[has]] == sorted_pixel[starts[has]]
    second[sorted_pixel[starts[has]]] = values[order][follows[has]]
    return first, second
