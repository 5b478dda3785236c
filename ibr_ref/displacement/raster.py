"""Stage raster: the fragments of a band of rows, and the points of a polygon's base face."""

from __future__ import annotations

from ibr_ref.jit import device, kernel, prange
from ibr_ref.pipeline.triangles import columns_in_row, edges_in_row, fill_depth, fill_varyings


@device
def count_fragments(triangles, width, first_row, last_row):
    """Fragments of all triangles in the rows [first_row, last_row)."""
    count = 0
    for t in range(len(triangles.source)):
        for row in range(max(first_row, triangles.rows[t, 0]), min(last_row, triangles.rows[t, 1])):
            first, stop = columns_in_row(edges_in_row(triangles.x[t], triangles.y[t], row), width)
            count += stop - first
    return count


@device
def rasterize(triangles, faces, width, first_row, last_row, with_depth, fragments):
    """Stage raster: the fragments of a band, triangle by triangle."""
    count = 0
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


@device
def _points_of_row(triangles, width, row, points):
    for t in range(len(triangles.source)):
        if triangles.rows[t, 0] <= row < triangles.rows[t, 1]:
            edges = edges_in_row(triangles.x[t], triangles.y[t], row)
            first, stop = columns_in_row(edges, width)
            fill_varyings(edges, first, stop, triangles.varyings[t], triangles.w[t], points, row * width + first)


@kernel
def base_points(triangles, width, rows, points):
    """Stage raster for a base face alone, whose triangles share no pixel: points (3, P), one a pixel."""
    for row in prange(rows):
        _points_of_row(triangles, width, row, points)
