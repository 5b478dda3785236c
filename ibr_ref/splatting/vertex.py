"""Stage vertex: every valid reference pixel becomes a point, placed in the window, given a width, and lit (section 3.3).

What kernels take: normals (P, 3), their codes; eye (4,); colors (n, 3), of the points from the one with the index `base` on.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ibr_ref.array_types import Bools, Bytes, Floats, Indices, Lanes, Vector3, Vector4
from ibr_ref.jit import LANES, device, kernel, prange
from ibr_ref.pipeline.lighting import homogeneous, light_wave, lit_channel
from ibr_ref.pipeline.waves import lanes
from ibr_ref.splatting.buffers import Law, Lighting, Reference, Vertices, View
from ibr_ref.splatting.normals import decoded
from ibr_ref.splatting.unproject import normalized_x, normalized_y, transform, view_point

_PARTS = 32  # into which a block of image rows is cut, for the threads


@device
def splat_width(law: Law, d: float) -> tuple[float, float]:
    """W_s at the distance d, clamped, and the law's denominator there."""
    alpha, beta, gamma, delta, least, most = law
    denominator = beta * (d * d) + gamma * d + delta
    width = alpha / denominator
    width = width if width < most else most
    return (width if width > least else least), denominator


@device
def _row(matrix: Floats, i: int) -> Vector4:
    """A row of a (4, 4) matrix as scalars: the loop over lanes must not read an array that it might be changing."""
    return matrix[i, 0], matrix[i, 1], matrix[i, 2], matrix[i, 3]


@device
def transform4(
    row0: Vector4, row1: Vector4, row2: Vector4, row3: Vector4, x: float, y: float, z: float, w: float
) -> Vector4:
    """A (4, 4) matrix, by rows, applied to (x, y, z, w); w = 1 leaves the products of the last column exact."""
    return (
        row0[0] * x + row0[1] * y + row0[2] * z + row0[3] * w,
        row1[0] * x + row1[1] * y + row1[2] * z + row1[3] * w,
        row2[0] * x + row2[1] * y + row2[2] * z + row2[3] * w,
        row3[0] * x + row3[1] * y + row3[2] * z + row3[3] * w,
    )


@device
def distance(eye: Vector3, p: Vector3) -> float:
    """From the eye to a point."""
    x, y, z = p[0] - eye[0], p[1] - eye[1], p[2] - eye[2]
    return np.sqrt(x * x + y * y + z * z)


@device
def _store(
    window_x: Lanes, window_y: Lanes, window_z: Lanes, width: Lanes, count: int, first: int, vertices: Vertices
) -> None:
    """Copy a wave's lanes to their vertices."""
    xs, ys, depths, widths = vertices
    for lane in range(count):
        xs[first + lane], ys[first + lane] = window_x[lane], window_y[lane]
        depths[first + lane], widths[first + lane] = window_z[lane], width[lane]


@device
def _place_rows(
    reference: Reference, view: View, law: Law, first_row: int, last_row: int, base: int, vertices: Vertices
) -> bool:
    """Place the points of the image rows [first_row, last_row); whether the law has a positive denominator for all.

    The loops over lanes have no branches, and write to arrays that are made here: LLVM turns them into SIMD.
    """
    m, v, c, k = reference.world_from_view, view.view_from_world, view.clip_from_view, reference.intrinsics
    m0, m1, m2 = _row(m, 0), _row(m, 1), _row(m, 2)
    v0, v1, v2, v3 = _row(v, 0), _row(v, 1), _row(v, 2), _row(v, 3)
    c0, c1, c2, c3 = _row(c, 0), _row(c, 1), _row(c, 2), _row(c, 3)
    eye = (view.eye[0], view.eye[1], view.eye[2])
    f_x, skew, center_x, f_y, center_y = k[0, 0], k[0, 1], k[0, 2], k[1, 1], k[1, 2]
    pixels, depths, row_starts = reference.pixels, reference.depth, reference.row_starts
    depth, x_n, x, y, z = lanes(), lanes(), lanes(), lanes(), lanes()
    window_x, window_y, window_z, width, flaw, flaws = lanes(), lanes(), lanes(), lanes(), lanes(), 0.0
    for row in range(first_row, last_row):
        y_n, start = normalized_y(f_y, center_y, row), np.int32(row * reference.columns)
        for first in range(row_starts[row], row_starts[row + 1], LANES):
            count = min(LANES, row_starts[row + 1] - first)
            for lane in range(count):
                pixel = pixels[first + lane]
                depth[lane] = depths[pixel]
                x_n[lane] = normalized_x(f_x, skew, center_x, np.float64(pixel - start), y_n)
            for lane in range(count):
                p_x, p_y, p_z = view_point(reference.perspective, x_n[lane], y_n, depth[lane])
                x[lane] = transform(m0, p_x, p_y, p_z)
                y[lane] = transform(m1, p_x, p_y, p_z)
                z[lane] = transform(m2, p_x, p_y, p_z)
            for lane in range(count):
                p = (x[lane], y[lane], z[lane])
                view_x, view_y, view_z, view_w = transform4(v0, v1, v2, v3, p[0], p[1], p[2], 1.0)
                clip_x, clip_y, clip_z, clip_w = transform4(c0, c1, c2, c3, view_x, view_y, view_z, view_w)
                kept = (clip_w > 0.0) & (clip_z >= 0.0) & (clip_z <= clip_w)
                d = distance(eye, p) if view.perspective else -view_z
                w, denominator = splat_width(law, d)
                window_x[lane] = (clip_x / clip_w + 1.0) / 2.0 * view.width if kept else np.nan
                window_y[lane] = (1.0 - clip_y / clip_w) / 2.0 * view.height if kept else np.nan
                window_z[lane] = clip_z / clip_w if kept else np.nan
                width[lane] = w if kept else 0.0
                flaw[lane] = 1.0 if kept & (not denominator > 0.0) else 0.0
            for lane in range(count):
                flaws += flaw[lane]
            _store(window_x, window_y, window_z, width, count, first - base, vertices)
    return flaws == 0.0


@kernel
def _place(
    reference: Reference, view: View, law: Law, first_row: int, last_row: int, vertices: Vertices, sound: Bools
) -> None:
    """All rows, in parts; sound (_PARTS,): of each, whether the law's denominator is positive."""
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
def light_pixels(
    reference: Reference, normals: Bytes, lighting: Lighting, eye_array: Floats, pixels: Indices, colors: Floats
) -> None:
    """Colours (n, 3) of the points of some pixels (n,) of a reference image: Phong with its colour and 8-bit normal."""
    albedo, depths, width = reference.color, reference.depth, np.float64(reference.columns)
    k, m, perspective = reference.intrinsics, reference.world_from_view, reference.perspective
    m0, m1, m2 = _row(m, 0), _row(m, 1), _row(m, 2)
    f_x, skew, center_x, f_y, center_y = k[0, 0], k[0, 1], k[0, 2], k[1, 1], k[1, 2]
    light, eye = homogeneous(lighting.light), homogeneous(eye_array)
    ambient, diffuse, specular = lighting.phong[0], lighting.phong[1], lighting.phong[2]
    index, x, y, z, nx, ny, nz = lanes(), lanes(), lanes(), lanes(), lanes(), lanes(), lanes()
    lit, cosine, power, shine, channel = lanes(), lanes(), lanes(), lanes(), lanes()
    for lane in range(LANES):
        lit[lane], shine[lane], index[lane] = 1.0, 0.0, 0.0
    for first in range(0, len(pixels), LANES):
        count = min(LANES, len(pixels) - first)
        for lane in range(count):  # the rest of the last wave is lit once more, and left
            pixel = np.uint32(pixels[first + lane])
            index[lane], z[lane] = np.float64(pixel), depths[pixel]
            nx[lane], ny[lane], nz[lane] = normals[pixel, 0], normals[pixel, 1], normals[pixel, 2]
        for lane in range(LANES):
            row = np.floor(index[lane] / width)  # exact: integers below 2^31
            y_n = normalized_y(f_y, center_y, row)
            x_n = normalized_x(f_x, skew, center_x, index[lane] - row * width, y_n)
            p_x, p_y, p_z = view_point(perspective, x_n, y_n, z[lane])
            x[lane], y[lane] = transform(m0, p_x, p_y, p_z), transform(m1, p_x, p_y, p_z)
            z[lane] = transform(m2, p_x, p_y, p_z)
        for lane in range(LANES):
            nx[lane], ny[lane], nz[lane] = decoded(nx[lane], ny[lane], nz[lane])
        light_wave(light, eye, specular, lighting.exponent, x, y, z, nx, ny, nz, lit, cosine, power, shine)
        for c in range(3):
            for lane in range(count):
                channel[lane] = albedo[np.uint32(pixels[first + lane]), c]
            for lane in range(LANES):
                bright = diffuse * (cosine[lane] if cosine[lane] > 0.0 else 0.0)
                channel[lane] = lit_channel(channel[lane], ambient, bright, shine[lane])
            for lane in range(count):
                colors[first + lane, c] = channel[lane]


@device
def _color_row(
    reference: Reference, normals: Bytes, lighting: Lighting, eye: Floats, row: int, base: int, colors: Floats
) -> None:
    first, stop = reference.row_starts[row], reference.row_starts[row + 1]
    pixels, stored = reference.pixels[first:stop], reference.color
    if lighting.lit:
        light_pixels(reference, normals, lighting, eye, pixels, colors[first - base : stop - base])
        return
    for i in range(len(pixels)):
        for channel in range(3):
            colors[first - base + i, channel] = stored[pixels[i], channel]


@kernel
def _colors(
    reference: Reference, normals: Bytes, lighting: Lighting, eye: Floats, first_row: int, last_row: int, colors: Floats
) -> None:
    base = reference.row_starts[first_row]
    for turn in prange(last_row - first_row):
        _color_row(reference, normals, lighting, eye, first_row + turn, base, colors)


def color_vertices(
    reference: Reference,
    normals: NDArray[np.uint8],
    lighting: Lighting,
    view: View,
    first_row: int,
    last_row: int,
    colors: NDArray[np.float64],
) -> None:
    """Colours (n, 3) of the points of the image rows [first_row, last_row)."""
    _colors(reference, normals, lighting, view.eye, first_row, last_row, colors)
