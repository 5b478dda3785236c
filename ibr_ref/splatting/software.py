"""The paper's comparison (tables 1 and 2): the same job in software, a plain loop, one point after another on one thread.

Each point is unprojected, transformed, given its width, lit and drawn before the next one is looked at. The operations of a
point are those of the stages, in the same order: the same bits. What differs is that no loop runs over lanes, no work is
shared out to threads, and points that nobody will see are lit too, as in the paper's vertex stage.

What kernels take: normals (P, 3), their codes; eye (4,); picture (H, W, 3).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ibr_ref.array_types import Bytes, Floats, Vector3, Vector4
from ibr_ref.jit import device, routine
from ibr_ref.pipeline.lighting import homogeneous, lit_channel, towards
from ibr_ref.pipeline.merge import passes
from ibr_ref.pipeline.points import Target, covers, snapped, span
from ibr_ref.splatting.buffers import Law, Lighting, Reference, Vertices, View
from ibr_ref.splatting.normals import decoded
from ibr_ref.splatting.unproject import normalized_x, normalized_y, transform, view_point
from ibr_ref.splatting.vertex import distance, splat_width


@device
def _world(reference: Reference, row: int, pixel: int) -> Vector3:
    """T_R->W: a pixel's point."""
    k, m = reference.intrinsics, reference.world_from_view
    y_n = normalized_y(k[1, 1], k[1, 2], row)
    x_n = normalized_x(k[0, 0], k[0, 1], k[0, 2], np.float64(pixel - row * reference.columns), y_n)
    x, y, z = view_point(reference.perspective, x_n, y_n, reference.depth[pixel])
    return transform(m[0], x, y, z), transform(m[1], x, y, z), transform(m[2], x, y, z)


@device
def _times(m: Floats, p: Vector4) -> Vector4:
    """A (4, 4) matrix applied to a homogeneous point, each row summed from left to right."""
    return (
        m[0, 0] * p[0] + m[0, 1] * p[1] + m[0, 2] * p[2] + m[0, 3] * p[3],
        m[1, 0] * p[0] + m[1, 1] * p[1] + m[1, 2] * p[2] + m[1, 3] * p[3],
        m[2, 0] * p[0] + m[2, 1] * p[1] + m[2, 2] * p[2] + m[2, 3] * p[3],
        m[3, 0] * p[0] + m[3, 1] * p[1] + m[3, 2] * p[2] + m[3, 3] * p[3],
    )


@device
def place_point(view: View, law: Law, p: Vector3) -> tuple[float, float, float, float, float]:
    """Window x, y, depth, the width, and the law's denominator; NaN and width 0 for a point that is dropped."""
    p_view = _times(view.view_from_world, (p[0], p[1], p[2], 1.0))
    x, y, z, w = _times(view.clip_from_view, p_view)
    if not (w > 0.0 and 0.0 <= z <= w):
        return np.nan, np.nan, np.nan, 0.0, 1.0
    d = distance((view.eye[0], view.eye[1], view.eye[2]), p) if view.perspective else -p_view[2]
    width, denominator = splat_width(law, d)
    return (x / w + 1.0) / 2.0 * view.width, (1.0 - y / w) / 2.0 * view.height, z / w, width, denominator


@device
def _power(base: float, exponent: int) -> float:
    """By repeated squaring, lowest bit first."""
    result = 1.0
    while exponent > 0:
        if exponent & 1:
            result *= base
        base *= base
        exponent >>= 1
    return result


@device
def _highlight(lighting: Lighting, normal: Vector3, cosine: float, l: Vector3, v: Vector3) -> float:
    """specular max(0, r.v)^exponent where n.l > 0."""
    specular = lighting.phong[2]
    if not (specular > 0.0 and cosine > 0.0):
        return 0.0
    twice = 2.0 * cosine
    reflected = (
        (twice * normal[0] - l[0]) * v[0] + (twice * normal[1] - l[1]) * v[1] + (twice * normal[2] - l[2]) * v[2]
    )
    return specular * 1.0 * _power(reflected if reflected > 0.0 else 0.0, lighting.exponent)


@device
def _light_point(
    reference: Reference, normals: Bytes, lighting: Lighting, eye: Floats, pixel: int, p: Vector3
) -> Vector3:
    """Phong with the pixel's colour and 8-bit normal; without a light its own colour."""
    albedo = reference.color[pixel]
    if not lighting.lit:
        return albedo[0], albedo[1], albedo[2]
    normal = decoded(normals[pixel, 0], normals[pixel, 1], normals[pixel, 2])
    l = towards(homogeneous(lighting.light), p[0], p[1], p[2])
    v = towards(homogeneous(eye), p[0], p[1], p[2])
    cosine = normal[0] * l[0] + normal[1] * l[1] + normal[2] * l[2]
    shine = _highlight(lighting, normal, cosine, l, v)
    ambient, bright = lighting.phong[0], lighting.phong[1] * (cosine if cosine > 0.0 else 0.0)
    return (
        lit_channel(albedo[0], ambient, bright, shine),
        lit_channel(albedo[1], ambient, bright, shine),
        lit_channel(albedo[2], ambient, bright, shine),
    )


@device
def _draw_point(
    x: float,
    y: float,
    z: float,
    width: float,
    disc: bool,
    index: np.int32,
    color: Vector3,
    target: Target,
    picture: Floats,
) -> None:
    """The depth test at every pixel that a splat covers, and its colour where it passes."""
    x, y = snapped(x), snapped(y)
    left, right = span(x, width, 0.0, np.float64(picture.shape[1]))
    top, stop = span(y, width, np.float64(target.top), np.float64(picture.shape[0]))
    noted = len(target.overdraw) > 0
    for row in range(top, stop):
        for column in range(left, right):
            if not covers(disc, column, row + target.top, x, y, width):
                continue
            stored = target.depth[row, column]
            if noted:
                if target.overdraw[row, column] > 0:
                    target.second[row, column] = min(target.second[row, column], max(z, stored))
                target.overdraw[row, column] += 1
            if passes(z, stored):
                target.depth[row, column], target.splat[row, column] = z, index
                picture[row, column, 0], picture[row, column, 1], picture[row, column, 2] = color


@routine
def _draw_all(
    reference: Reference,
    normals: Bytes,
    view: View,
    law: Law,
    lighting: Lighting,
    disc: bool,
    first: int,
    vertices: Vertices,
    target: Target,
    picture: Floats,
) -> int:
    """Every point of a reference image; the first row with a point for which the law is not sound, or -1."""
    keep = len(vertices.x) > 0
    for row in range(len(reference.row_starts) - 1):
        for at in range(reference.row_starts[row], reference.row_starts[row + 1]):
            pixel = reference.pixels[at]
            p = _world(reference, row, pixel)
            x, y, z, width, denominator = place_point(view, law, p)
            if not denominator > 0.0:
                return row
            if keep:
                vertices.x[at], vertices.y[at], vertices.depth[at], vertices.width[at] = x, y, z, width
            if width > 0.0:
                color = _light_point(reference, normals, lighting, view.eye, pixel, p)
                _draw_point(x, y, z, width, disc, np.int32(first + at), color, target, picture)
    return -1


def draw_all(
    reference: Reference,
    normals: NDArray[np.uint8],
    view: View,
    law: Law,
    lighting: Lighting,
    disc: bool,
    first: int,
    vertices: Vertices,
    target: Target,
    picture: NDArray[np.float64],
) -> int:
    """Draw the points of one image over what has been drawn, into the target and the picture (H, W, 3).

    The first point has the index `first`; `vertices` are kept where there is room for them. Returns the first row with a
    point in view for which the law's denominator is not positive, -1 if there is none.
    """
    return int(_draw_all(reference, normals, view, law, lighting, disc, first, vertices, target, picture))
