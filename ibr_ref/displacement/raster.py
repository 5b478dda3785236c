"""Stage raster: the fragments of a band of rows, or of all bands of a polygon's base face beforehand."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ibr_ref.array_types import Indices, Ints
from ibr_ref.displacement.buffers import Fragments, Hits
from ibr_ref.jit import LANES, device, kernel, prange
from ibr_ref.pipeline.triangles import Triangles, columns_in_row, edges_in_row, fill_depth, fill_varyings


class Covered(NamedTuple):
    """The fragments of a whole picture, band after band, each band from a multiple of LANES on."""

    fragments: Fragments
    """Between the bands there are points of NaN, of no pixel (-1)."""
    bands: Ints
    """(B, 2) the first fragment of each band, and how many it has."""


@device
def count_fragments(triangles: Triangles, width: int, first_row: int, last_row: int) -> int:
    """Fragments of all triangles in the rows [first_row, last_row)."""
    count = 0
    for t in range(len(triangles.source)):
        for row in range(max(first_row, triangles.rows[t, 0]), min(last_row, triangles.rows[t, 1])):
            first, stop = columns_in_row(edges_in_row(triangles.x[t], triangles.y[t], row), width)
            count += stop - first
    return count


@device
def rasterize(
    triangles: Triangles, faces: Indices, width: int, first_row: int, last_row: int, with_depth: bool,
    fragments: Fragments, start: int,
) -> None:  # fmt: skip
    """Stage raster: the fragments of a band, triangle by triangle, from the element `start` on. faces: (Q,) of the quads."""
    count = start
    for t in range(len(triangles.source)):
        face, w, varyings = faces[triangles.source[t] // 2], triangles.w[t], triangles.varyings[t]
        for row in range(max(first_row, triangles.rows[t, 0]), min(last_row, triangles.rows[t, 1])):
            edges = edges_in_row(triangles.x[t], triangles.y[t], row)
            first, stop = columns_in_row(edges, width)
            fill_varyings(edges, first, stop, varyings, w, fragments.patch, count)
            if with_depth:
                fill_depth(edges, first, stop, triangles.z[t], fragments.depth, count)
            for column in range(first, stop):
                fragments.pixel[count] = row * width + column
                fragments.face[count] = face
                count += 1


@kernel
def _count(triangles: Triangles, width: int, rows: int, band_rows: int, bands: Ints) -> None:
    for band in prange(len(bands)):
        first_row = band * band_rows
        bands[band, 1] = count_fragments(triangles, width, first_row, min(rows, first_row + band_rows))


@kernel
def _cover(
    triangles: Triangles, faces: Indices, width: int, rows: int, band_rows: int, with_depth: bool,
    bands: Ints, fragments: Fragments,
) -> None:  # fmt: skip
    for band in prange(len(bands)):
        first_row = band * band_rows
        last_row = min(rows, first_row + band_rows)
        rasterize(triangles, faces, width, first_row, last_row, with_depth, fragments, bands[band, 0])


def cover(triangles: Triangles, faces: Indices, width: int, rows: int, band_rows: int, with_depth: bool) -> Covered:
    """Stage raster of a whole picture of so many columns and rows, in bands of so many rows."""
    bands = np.empty(((rows + band_rows - 1) // band_rows, 2), np.int64)
    _count(triangles, width, rows, band_rows, bands)
    ends = np.cumsum((bands[:, 1] + LANES - 1) // LANES * LANES)
    bands[:, 0] = np.append(0, ends[:-1])
    size = int(ends[-1])
    pixel, face = np.full(size, -1, np.int64), np.empty(size, np.int32)
    fragments = Fragments(pixel, face, np.full((3, size), np.nan), np.empty(size))
    _cover(triangles, faces, width, rows, band_rows, with_depth, bands, fragments)
    return Covered(fragments, bands)


@device
def take_fragments(covered: Fragments, start: int, count: int, fragments: Fragments) -> None:
    """A band's fragments, of those of all bands."""
    for i in range(count):
        fragments.pixel[i], fragments.face[i] = covered.pixel[start + i], covered.face[start + i]
        fragments.depth[i] = covered.depth[start + i]
        for k in range(3):
            fragments.patch[k, i] = covered.patch[k, start + i]


@device
def take_hits(found: Hits, start: int, count: int, hits: Hits) -> None:
    """And its hits, where a search has been through all bands before."""
    for i in range(count):
        j = start + i
        hits.linear_index[i], hits.hit_index[i] = found.linear_index[j], found.hit_index[j]
        hits.u[i], hits.v[i], hits.h[i] = found.u[j], found.v[j], found.h[j]
        hits.height_before[i] = found.height_before[j]
        hits.margin[i], hits.domain_margin[i] = found.margin[j], found.domain_margin[j]
