"""Elliptical weighted averages: what a reference pixel's Gaussian becomes in the view (Zwicker et al. 2001, section 4).

A point carries a Gaussian of the standard deviation `footprint` in pixels of its reference image: the surface's local
parametrization is that image itself. It lies on the tangent plane that the 8-bit normal n gives. With d the line of sight
through the pixel (depth 1), M the linear part of T_R->W and e_u = M dP/du at a constant depth, the point moves by

    P_u = e_u - d (n.e_u)/(n.d)

as u grows by a pixel and it stays on the plane; P_v likewise. The derivative of the projection makes these the columns of
the Jacobian J (2 x 2), from reference pixels to window pixels, and the splat has the covariance

    C = footprint^2 J J^T + low_pass^2 I

with a low-pass filter of the picture's own pixels, which keeps what is smaller than a pixel from flickering. Its weight at
the centre is footprint^2 |det J|/sqrt(det C), 1 where the filter does nothing: that of the footprint and the filter, each of
unit volume, convolved. Where n is nearly at right angles to d the plane is turned until their cosine is LEAST_COSINE, and
where a side of the ellipse's box would exceed `most` pixels the ellipse is shrunk, both axes alike.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ibr_ref.array_types import Bytes, Floats, Vector3, Vector4
from ibr_ref.jit import device, kernel, prange
from ibr_ref.pipeline.ellipses import Ellipses
from ibr_ref.pipeline.memory import arrays
from ibr_ref.splatting.buffers import Reference, Vertices, View
from ibr_ref.splatting.normals import decoded
from ibr_ref.splatting.unproject import normalized_x, normalized_y, transform, view_point

LEAST_COSINE = 0.5
"""Of the angle between normal and line of sight: the footprint stretches twofold at most. At the rim of an object, and
where depths come in steps, normals are turned away almost entirely; splats as long as these say stand out as spikes
(kettle, nine references: 7.1 % of its pixels too many with a cosine of 0.2, 5.9 % with 0.5; the same decibels)."""

LEAST_AMPLITUDE = 2.0**-20
"""Splats seen from their edge weigh nothing; so little is left to them that a pixel that they alone cover has a colour."""


class Filter(NamedTuple):
    """The Gaussians, in standard deviations, and how far they reach."""

    footprint: float
    """Reference pixels, > 0."""
    low_pass: float
    """Pixels of the picture, > 0."""
    cutoff: float
    """Standard deviations, > 0."""
    most: float
    """Pixels: the largest side of an ellipse's box, >= 2 cutoff low_pass."""


def ellipses_for(vertices: Vertices) -> Ellipses:
    """Room for as many splats as there are points, at the points' own places."""
    room = arrays([(np.float64, (len(vertices.x),))] * 5)
    return Ellipses(vertices.x, vertices.y, vertices.depth, *room)


@device
def _linear(m: Floats, x: float, y: float, z: float) -> Vector3:
    """A direction under the linear part of a (4, 4) matrix."""
    return (
        m[0, 0] * x + m[0, 1] * y + m[0, 2] * z,
        m[1, 0] * x + m[1, 1] * y + m[1, 2] * z,
        m[2, 0] * x + m[2, 1] * y + m[2, 2] * z,
    )


@device
def _dot(a: Vector3, b: Vector3) -> float:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@device
def _along_plane(step: Vector3, sight: Vector3, normal: Vector3, facing: float) -> Vector3:
    """A step in the image, taken on the tangent plane."""
    way = _dot(normal, step) / facing
    return step[0] - sight[0] * way, step[1] - sight[1] * way, step[2] - sight[2] * way


@device
def surface_steps(
    reference: Reference, normal: Vector3, x_n: float, y_n: float, depth: float
) -> tuple[Vector3, Vector3]:
    """P_u and P_v: the world-space steps on the tangent plane to the next pixel on the right, and below."""
    k, m = reference.intrinsics, reference.world_from_view
    scale = depth if reference.perspective else 1.0
    step_u = _linear(m, scale / k[0, 0], 0.0, 0.0)
    step_v = _linear(m, -scale * k[0, 1] / (k[0, 0] * k[1, 1]), -scale / k[1, 1], 0.0)
    sight = _linear(m, x_n, -y_n, -1.0) if reference.perspective else _linear(m, 0.0, 0.0, -1.0)
    facing = min(_dot(normal, sight), -LEAST_COSINE * np.sqrt(_dot(sight, sight)))
    return _along_plane(step_u, sight, normal, facing), _along_plane(step_v, sight, normal, facing)


@device
def _clip_step(view: View, step: Vector3) -> Vector3:
    """Derivative of clip x, y, w along a world-space step."""
    v = _linear(view.view_from_world, step[0], step[1], step[2])
    c = view.clip_from_view
    return (
        c[0, 0] * v[0] + c[0, 1] * v[1] + c[0, 2] * v[2],
        c[1, 0] * v[0] + c[1, 1] * v[1] + c[1, 2] * v[2],
        c[3, 0] * v[0] + c[3, 1] * v[1] + c[3, 2] * v[2],
    )


@device
def window_step(view: View, step: Vector3, window_x: float, window_y: float, clip_w: float) -> tuple[float, float]:
    """Derivative of the window position along a world-space step, pixels."""
    x, y, w = _clip_step(view, step)
    ndc_x, ndc_y = 2.0 * window_x / view.width - 1.0, 1.0 - 2.0 * window_y / view.height
    return (x - ndc_x * w) / clip_w / 2.0 * view.width, -(y - ndc_y * w) / clip_w / 2.0 * view.height


@device
def _shrink(filters: Filter, xx: float, yy: float) -> float:
    """What the footprint's variances are multiplied by, so that with the filter's the box is as large as is allowed."""
    side = filters.most / (2.0 * filters.cutoff)
    room = side * side - filters.low_pass * filters.low_pass
    largest = max(xx, yy)
    return room / largest if largest > room else 1.0


@device
def covariance(filters: Filter, x_u: float, y_u: float, x_v: float, y_v: float) -> Vector4:
    """xx, xy, yy of the splat, and its weight at the centre."""
    footprint, low_pass = filters.footprint * filters.footprint, filters.low_pass * filters.low_pass
    xx, xy, yy = x_u * x_u + x_v * x_v, x_u * y_u + x_v * y_v, y_u * y_u + y_v * y_v
    area = footprint * abs(x_u * y_v - x_v * y_u)
    # det(s J J^T + h I) = s^2 det(J)^2 + s h |J|^2 + h^2: nothing cancels.
    amplitude = area / np.sqrt(area * area + footprint * low_pass * (xx + yy) + low_pass * low_pass)
    xx, xy, yy = footprint * xx, footprint * xy, footprint * yy
    shrink = _shrink(filters, xx, yy)
    if not (shrink > 0.0 and amplitude <= 1.0):
        return low_pass, 0.0, low_pass, LEAST_AMPLITUDE
    return xx * shrink + low_pass, xy * shrink, yy * shrink + low_pass, max(amplitude, LEAST_AMPLITUDE)


@device
def _axis_distance(view: View, p: Vector3) -> float:
    """Along the view axis."""
    row = view.view_from_world[2]
    return -transform(row, p[0], p[1], p[2])


@device
def _footprint_row(
    reference: Reference,
    normals: Bytes,
    view: View,
    filters: Filter,
    row: int,
    base: int,
    vertices: Vertices,
    ellipses: Ellipses,
) -> None:
    """A row of the reference: normals (P, 3); base: the first of the points in vertices and ellipses."""
    k, m = reference.intrinsics, reference.world_from_view
    y_n = normalized_y(k[1, 1], k[1, 2], row)
    for at in range(reference.row_starts[row], reference.row_starts[row + 1]):
        i, pixel = at - base, reference.pixels[at]
        depth = reference.depth[pixel]
        x_n = normalized_x(k[0, 0], k[0, 1], k[0, 2], pixel - row * reference.columns, y_n)
        x, y, z = view_point(reference.perspective, x_n, y_n, depth)
        p = transform(m[0], x, y, z), transform(m[1], x, y, z), transform(m[2], x, y, z)
        distance = _axis_distance(view, p)
        normal = decoded(normals[pixel, 0], normals[pixel, 1], normals[pixel, 2])
        step_u, step_v = surface_steps(reference, normal, x_n, y_n, depth)
        clip_w = distance if view.perspective else 1.0
        x_u, y_u = window_step(view, step_u, vertices.x[i], vertices.y[i], clip_w)
        x_v, y_v = window_step(view, step_v, vertices.x[i], vertices.y[i], clip_w)
        xx, xy, yy, amplitude = covariance(filters, x_u, y_u, x_v, y_v)
        ellipses.distance[i], ellipses.amplitude[i] = distance, amplitude
        ellipses.xx[i], ellipses.xy[i], ellipses.yy[i] = xx, xy, yy
        if vertices.width[i] > 0.0:
            vertices.width[i] = 2.0 * filters.cutoff * np.sqrt(max(xx, yy))


@kernel
def _footprints(
    reference: Reference,
    normals: Bytes,
    view: View,
    filters: Filter,
    first_row: int,
    last_row: int,
    vertices: Vertices,
    ellipses: Ellipses,
) -> None:
    """All rows of `footprints`."""
    base = reference.row_starts[first_row]
    for turn in prange(last_row - first_row):
        _footprint_row(reference, normals, view, filters, first_row + turn, base, vertices, ellipses)


def footprints(
    reference: Reference,
    normals: NDArray[np.uint8],
    view: View,
    filters: Filter,
    first_row: int,
    last_row: int,
    vertices: Vertices,
    ellipses: Ellipses,
) -> None:
    """Fill in the ellipses of the points of the image rows [first_row, last_row), which are placed already.

    normals (P, 3): the codes of the reference's pixels. The width of a point becomes the larger side of its ellipse's box;
    a dropped one keeps 0.
    """
    _footprints(reference, normals, view, filters, first_row, last_row, vertices, ellipses)
