"""Stage atlas: the reference images packed into at most four textures, which is what a GPU binds (section 3.2).

Shelves from left to right and top to bottom, in input order; each page is cropped to what it holds.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

PAGES = 4
"""Textures at the most."""


def pack(sizes: Sequence[tuple[int, int]], limit: int) -> NDArray[np.int32]:
    """(N, 5) page, x, y, width, height of images of the sizes (width, height), on pages of at most limit x limit.

    Raises ValueError if they do not fit.
    """
    rects = np.empty((len(sizes), 5), np.int32)
    page = x = y = shelf = 0
    for i, (width, height) in enumerate(sizes):
        if max(width, height) > limit:
            raise ValueError(f"images[{i}]: found {width} x {height} pixels, allowed: max_atlas_size = {limit} a side")
        if x + width > limit:
            x, y, shelf = 0, y + shelf, 0
        if y + height > limit:
            page, x, y, shelf = page + 1, 0, 0, 0
        if page == PAGES:
            raise ValueError(
                f"images[{i}]: found no room in the atlas, allowed: what fits into {PAGES} pages of "
                f"{limit} x {limit} pixels (max_atlas_size), on shelves in input order"
            )
        rects[i] = page, x, y, width, height
        x, shelf = x + width, max(shelf, height)
    return rects


def fill(rects: NDArray[np.int32], maps: Sequence[NDArray[np.generic]]) -> tuple[NDArray[np.generic], ...]:
    """One array a page, from one map (H, W[, channels]) an image; 0 where no image is."""
    pages = []
    for page in range(int(rects[-1, 0]) + 1):
        held = np.flatnonzero(rects[:, 0] == page).tolist()
        right, bottom = (rects[held, 1:3] + rects[held, 3:5]).max(axis=0)
        texture = np.zeros((bottom, right, *maps[held[0]].shape[2:]), maps[held[0]].dtype)
        for i in held:
            x, y, width, height = rects[i, 1:]
            texture[y : y + height, x : x + width] = maps[i]
        pages.append(texture)
    return tuple(pages)
