"""The points of all reference images, in order, some of them at a time."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np

from ibr_ref.splatting.references import Prepared

BATCH_POINTS = 1 << 17
"""Points that are placed and drawn at a time, about: their arrays stay in the cache, and memory does not grow with them."""


class Rows(NamedTuple):
    """A range of rows of a reference image, and the indices [first, stop) of its points."""

    image: int
    first_row: int
    last_row: int
    first: int
    stop: int


def starts_of(references: Sequence[Prepared]) -> list[int]:
    """Index of the first point of each image, and the number of all."""
    starts: list[int] = np.cumsum([0] + [reference.points for reference in references]).tolist()
    return starts


def batches(references: Sequence[Prepared]) -> Iterator[list[Rows]]:
    """All points in order: rows of one image or several, with about BATCH_POINTS points together."""
    batch: list[Rows] = []
    for image, (prepared, start) in enumerate(zip(references, starts_of(references), strict=False)):
        row_starts, row = prepared.reference.row_starts, 0
        while row < len(row_starts) - 1:
            last = int(np.searchsorted(row_starts, row_starts[row] + BATCH_POINTS, side="right")) - 1
            last = max(last, row + 1)
            rows = Rows(image, row, last, start + int(row_starts[row]), start + int(row_starts[last]))
            if batch and rows.stop - batch[0].first > BATCH_POINTS:
                yield batch
                batch = []
            if rows.stop > rows.first:
                batch.append(rows)
            row = last
    yield batch
