"""Soft shadows by convolution (Soler & Sillion 1998): the occluder's image convolved with the light's, by FFT.

Where light, occluder and receiver lie in parallel planes, at h = 0, o and r, the share of the light that a point of the
receiver at place x does not see is exact, a convolution of two images on the occluder's plane (their section 3),

    S(x) = 1/|L| integral over l in L of M(x + l (1/o - 1/r)) dl:

the occluder's mask M, and the light's image L, scaled by the distances. For other scenes it is applied to planes that
stand for them (their section 4): the caster for one halfway between its nearest and its farthest point; the receivers for
several, evenly spaced in 1/r, as the light's image grows with it, and a point takes the mix of the two around it. Not
built is their subdivision of the occluder into clusters. FFTs are SciPy's: their last bits may differ between machines.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ibr_ref.array_types import Floats, Indices
from ibr_ref.jit import device, kernel, prange
from ibr_ref.pipeline import memory
from ibr_ref.pipeline.sampling import clamped, footprint, lerp, mix
from ibr_ref.shadows.maps import MOST_SAMPLES, View, levels, mask
from ibr_ref.shadows.parallel import Frame, Window, clip_from_view


def light_image(half_edges: Floats, window: Window, size: int, scale: float) -> Floats:
    """(K, K), K odd: how much of the light, scaled to the places of a map (S, S), lies in each texel around its centre.

    Rendered as everything is, with 15 x 15 samples a texel; the sum is 1. A light too small to be seen is one texel.
    """
    odd = size - 1 + size % 2
    middle = (window.low + window.high) / 2.0
    half_window = (window.high - window.low) / 2.0 * (odd / size)
    around = Window(middle - half_window, middle + half_window, 0.5, 2.0)
    a, b = half_edges * scale
    corners = [middle + u * a + v * b for u, v in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
    vertices = np.array([(x, y, -1.0) for x, y in corners])
    triangles = np.array([(0, 1, 2), (0, 2, 3)], np.int32)
    view = View(vertices, triangles, np.zeros((2, 3)), np.eye(4), clip_from_view(around))
    image = levels(MOST_SAMPLES)[mask(view, np.zeros(2), odd, MOST_SAMPLES)]
    centre, seen = odd // 2, np.argwhere(image > 0.0)
    if not len(seen):
        return np.ones((1, 1))
    reach = int(np.abs(seen - centre).max())
    image = image[centre - reach : centre + reach + 1, centre - reach : centre + reach + 1]
    return np.asarray(image / image.sum())


def plane_distances(distances: Floats, occluder: float, count: int) -> Floats:
    """(P,) distances of the planes that stand for receivers at the given ones, beyond the occluder's; one: the middle."""
    beyond = distances[distances > occluder]
    if not len(beyond):
        return np.full(count, 2.0 * occluder)
    first, last = 1.0 / float(beyond.max()), 1.0 / float(beyond.min())
    shares = (np.arange(count) + 0.5) if count == 1 else np.arange(count) / (count - 1)
    return np.asarray(1.0 / (first * (1.0 - shares) + last * shares))


def convolved(occluder: Floats, frame: Frame, window: Window, distance: float, planes: Floats) -> Floats:
    """(P, S, S) the shadow on each plane of receivers, of an occluder's mask (S, S) at a distance."""
    from scipy.signal import fftconvolve  # loads half of SciPy, which other shadows need not wait for

    lights = [light_image(frame.half_edges, window, len(occluder), 1.0 / distance - 1.0 / plane) for plane in planes]
    return np.stack([np.clip(fftconvolve(occluder, light, mode="same"), 0.0, 1.0) for light in lights])


@device
def _between_planes(inverse: float, first: float, last: float, count: int) -> tuple[int, float]:
    """The plane below a distance (inverted, as the planes are), and the share of the next one."""
    if count == 1:
        return 0, 0.0
    place = clamped((inverse - first) / (last - first) * (count - 1), 0.0, count - 1.0)
    below = min(int(place), count - 2)
    return below, place - below


@device
def _look_up_row(
    triangle: Indices,
    world: Floats,
    view: Floats,
    caster: int,
    low: Floats,
    high: Floats,
    occluder: float,
    ends: tuple[float, float],
    images: Floats,
    size: float,
    shadow: Floats,
) -> None:
    """A row: triangle (W,), world (W, 3 or more), view (4, 4), low, high (2,), images (P, S S), into shadow (W,)."""
    first, last = ends
    for i in range(len(shadow)):
        shadow[i] = 0.0
        if triangle[i] < 0 or triangle[i] >= caster:
            continue
        x, y, z = world[i, 0], world[i, 1], world[i, 2]
        h = -(view[2, 0] * x + view[2, 1] * y + view[2, 2] * z + view[2, 3])
        if h <= occluder:
            continue
        s = (view[0, 0] * x + view[0, 1] * y + view[0, 2] * z + view[0, 3]) / h
        t = (view[1, 0] * x + view[1, 1] * y + view[1, 2] * z + view[1, 3]) / h
        u, v = (s - low[0]) / (high[0] - low[0]), (high[1] - t) / (high[1] - low[1])
        if u < 0.0 or u > 1.0 or v < 0.0 or v > 1.0:
            continue
        below, share = _between_planes(1.0 / h, first, last, len(images))
        i00, i10, i01, i11, fx, fy = footprint(u, v, size, size, None)
        shadow[i] = mix(images[below], i00, i10, i01, i11, fx, fy)
        if share > 0.0:
            shadow[i] = lerp(shadow[i], mix(images[below + 1], i00, i10, i01, i11, fx, fy), share)


@kernel
def _look_up(
    triangle: Indices,
    varyings: Floats,
    view: Floats,
    caster: int,
    low: Floats,
    high: Floats,
    occluder: float,
    ends: tuple[float, float],
    images: Floats,
    size: float,
    shadow: Floats,
) -> None:
    """All rows of `look_up`; the images flat, (P, S S)."""
    for row in prange(len(shadow)):
        _look_up_row(triangle[row], varyings[row], view, caster, low, high, occluder, ends, images, size, shadow[row])


def look_up(
    triangle: NDArray[np.int32],
    varyings: Floats,
    caster: int,
    frame: Frame,
    window: Window,
    distance: float,
    planes: Floats,
    images: Floats,
) -> Floats:
    """(H, W) the shadow of what the camera sees, from the images (P, S, S) of the planes.

    triangle (H, W), varyings (H, W, 3 or more): those of the `Surface`; triangles from index `caster` on are lit, and so is
    what lies before the occluder's plane.
    """
    (shadow,) = memory.arrays([(np.float64, triangle.shape)])
    flat, size = images.reshape(len(images), -1), float(images.shape[1])
    ends = 1.0 / float(planes[0]), 1.0 / float(planes[-1])
    view = frame.view_from_world
    _look_up(triangle, varyings, view, caster, window.low, window.high, distance, ends, flat, size, shadow)
    return shadow
