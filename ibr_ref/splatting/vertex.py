"""Stage vertex: every valid reference pixel becomes a point, placed in the window, given a width, and lit (section 3.3).

Points run in waves of up to LANES pixels of one image row: without branches, so that LLVM turns the loops into SIMD.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ibr_ref.jit import LANES, device, kernel, prange
from ibr_ref.pipeline.lighting import lit_channel, phong
from ibr_ref.splatting.buffers import Law, Lighting, Reference, Vertices, View
from ibr_ref.splatting.normals import decoded
from ibr_ref.splatting.unproject import normalized_x, normalized_y, transform, view_point, world_point

_PARTS = 32  # into which a block of image rows is cut, for the threads


@device
def splat_width(law, d):
    """W_s at the distance d, clamped, and the law's denominator there."""
    denominator = law.beta * (d * d) + law.gamma * d + law.delta
    width = law.alpha / denominator
    width = width if width < law.most else law.most
    return (width if width > law.least else law.least), denominator


@device
def _row(matrix, i):
    """A row of a (4, 4) matrix as scalars: the loop over lanes must not read an array that it might be changing."""
    return matrix[i, 0], matrix[i, 1], matrix[i, 2], matrix[i, 3]


@device
def _project(row, x, y, z, w):
    return row[0] * x + row[1] * y + row[2] * z + row[3] * w


@device
def _place_wave(reference, view, law, row, first, count, base, vertices):
    """Place up to LANES points of an image row; whether the law has a positive denominator for all of them."""
    m = reference.world_from_view
    m0, m1, m2 = _row(m, 0), _row(m, 1), _row(m, 2)
    v = view.view_from_world
    v0, v1, v2, v3 = _row(v, 0), _row(v, 1), _row(v, 2), _row(v, 3)
    c = view.clip_from_view
    c0, c1, c2, c3 = _row(c, 0), _row(c, 1), _row(c, 2), _row(c, 3)
    eye_x, eye_y, eye_z = view.eye[0], view.eye[1], view.eye[2]
    y_n = normalized_y(reference.intrinsics, row)
    f_x, skew, center_x = reference.intrinsics[0, 0], reference.intrinsics[0, 1], reference.intrinsics[0, 2]
    start = np.int32(row * reference.columns)
    x_n, depth, x, y, z = np.empty(LANES), np.empty(LANES), np.empty(LANES), np.empty(LANES), np.empty(LANES)
    window_x, window_y, window_z = np.empty(LANES), np.empty(LANES), np.empty(LANES)
    width, flaw = np.empty(LANES), np.empty(LANES)
    for lane in range(count):
        pixel = reference.pixels[first + lane]
        depth[lane] = reference.depth[pixel]
        x_n[lane] = np.float64(pixel - start)
    for lane in range(count):
        p_x, p_y, p_z = view_point(
            reference.perspective, normalized_x(f_x, skew, center_x, x_n[lane], y_n), y_n, depth[lane]
        )
        x[lane] = transform(m0, p_x, p_y, p_z)
        y[lane] = transform(m1, p_x, p_y, p_z)
        z[lane] = transform(m2, p_x, p_y, p_z)
    for lane in range(count):
        p_x, p_y, p_z = x[lane], y[lane], z[lane]
        view_x, view_y = transform(v0, p_x, p_y, p_z), transform(v1, p_x, p_y, p_z)
        view_z, view_w = transform(v2, p_x, p_y, p_z), transform(v3, p_x, p_y, p_z)
        clip_x, clip_y = _project(c0, view_x, view_y, view_z, view_w), _project(c1, view_x, view_y, view_z, view_w)
        clip_z, clip_w = _project(c2, view_x, view_y, view_z, view_w), _project(c3, view_x, view_y, view_z, view_w)
        kept = (clip_w > 0.0) & (clip_z >= 0.0) & (clip_z <= clip_w)
        q_x, q_y, q_z = p_x - eye_x, p_y - eye_y, p_z - eye_z
        d = np.sqrt(q_x * q_x + q_y * q_y + q_z * q_z) if view.perspective else -view_z
        w, denominator = splat_width(law, d)
        window_x[lane] = (clip_x / clip_w + 1.0) / 2.0 * view.width if kept else np.nan
        window_y[lane] = (1.0 - clip_y / clip_w) / 2.0 * view.height if kept else np.nan
        window_z[lane] = clip_z / clip_w if kept else np.nan
        width[lane] = w if kept else 0.0
        flaw[lane] = 1.0 if kept & (not denominator > 0.0) else 0.0
    flaws = 0.0
    for lane in range(count):
        i = first + lane - base
        vertices.window[i, 0] = window_x[lane]
        vertices.window[i, 1] = window_y[lane]
        vertices.depth[i] = window_z[lane]
        vertices.width[i] = width[lane]
        flaws += flaw[lane]
    return flaws == 0.0


@device
def _place_rows(reference, view, law, first_row, last_row, base, vertices):
    sound = True
    for row in range(first_row, last_row):
        stop = reference.row_starts[row + 1]
        for first in range(reference.row_starts[row], stop, LANES):
            count = min(LANES, stop - first)
            sound &= _place_wave(reference, view, law, row, first, count, base, vertices)
    return sound


@kernel
def _place(reference, view, law, first_row, last_row, vertices, sound):
    base = reference.row_starts[first_row]
    chunk = (last_row - first_row + _PARTS - 1) // _PARTS
    for part in prange(_PARTS):
        first = min(last_row, first_row + part * chunk)
        last = min(last_row, first + chunk)
        sound[part] = _place_rows(reference, view, law, first, last, base, vertices)


def place(reference: Reference, view: View, law: Law, first_row: int, last_row: int, vertices: Vertices) -> bool:
    """Place the points of the image rows [first_row, last_row); whether the law is sound for all of them."""
    sound = np.empty(_PARTS, np.bool_)
    _place(reference, view, law, first_row, last_row, vertices, sound)
    return bool(sound.all())


@device
def vertex_color(reference, normals, lighting, eye, pixel):
    """Colour of a reference pixel's point: lit by its 8-bit normal, or as it is stored."""
    r, g, b = reference.color[pixel, 0], reference.color[pixel, 1], reference.color[pixel, 2]
    if not lighting.lit:
        return r, g, b
    x, y, z = world_point(reference, pixel)
    nx, ny, nz = decoded(normals, pixel)
    ambient, diffuse, specular = lighting.phong[0], lighting.phong[1], lighting.phong[2]
    bright, shine, _ = phong(lighting.light, eye, x, y, z, nx, ny, nz, diffuse, specular, lighting.exponent, 1.0)
    return (
        lit_channel(r, ambient, bright, shine),
        lit_channel(g, ambient, bright, shine),
        lit_channel(b, ambient, bright, shine),
    )


@device
def _color_row(reference, normals, lighting, eye, row, colors):
    for i in range(reference.row_starts[row], reference.row_starts[row + 1]):
        colors[i, 0], colors[i, 1], colors[i, 2] = vertex_color(reference, normals, lighting, eye, reference.pixels[i])


@kernel
def _colors(reference, normals, lighting, eye, colors):
    for row in prange(len(reference.row_starts) - 1):
        _color_row(reference, normals, lighting, eye, row, colors)


def color_vertices(
    reference: Reference, normals: NDArray[np.uint8], lighting: Lighting, view: View, colors: NDArray[np.float64]
) -> None:
    """Colours (V, 3) of all points of a reference image."""
    _colors(reference, normals, lighting, view.eye, colors)
