"""method="exact" against closed forms, and against the height field in rational numbers."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import Phase, given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose
from numpy.typing import NDArray

from ibr_ref import Camera
from ibr_ref.io import Frame
from tests.displacement.height_field import Ray, first_inside, paper_ray, volume_ray
from tests.displacement.scenes import SCALE, Array, camera, frame, noise, parallel_camera, patch_eye, square

ROUNDING = 1e-13
"""Of a hit on a ray that meets the surface at an angle: positions are sums of a few numbers below 10."""

CAMERAS = {
    "perspective": camera(),
    "orthographic": parallel_camera(eye=(-0.6, 1.4, 0.6)),
    "grazing": camera(eye=(2.0, -1.5, 0.3), vertical_fov=24.0),
}
each_camera = pytest.mark.parametrize("view", CAMERAS.values(), ids=CAMERAS)


def rays(view: Camera, result: Frame) -> tuple[NDArray[np.int64], Array, Array]:
    """Of all covered pixels: (row, column), and the ray's points on h = 1 and h = 0, in float64."""
    pixels = np.argwhere(result.stages["raster.face"] >= 0)
    c = result.stages["raster.patch"][tuple(pixels.T)].astype(np.float64)
    eye = patch_eye(view)
    v = eye[:3] - eye[3] * c
    return pixels, c + v * ((1 - c[:, 2:]) / v[:, 2:]), c - v * (c[:, 2:] / v[:, 2:])


def hits(result: Frame, pixels: NDArray[np.int64]) -> Array:
    return result.stages["march.hit"][tuple(pixels.T)].astype(np.float64)


def entry(top: Array, bottom: Array, low: Any, high: Any) -> tuple[Array, Array]:
    """t at which each ray enters the box [low, high] (u, v, h), and leaves it: the slab method."""
    with np.errstate(divide="ignore", invalid="ignore"):
        a, b = (np.array(low) - top) / (bottom - top), (np.array(high) - top) / (bottom - top)
    return np.nanmax(np.fmin(a, b), axis=1), np.nanmin(np.fmax(a, b), axis=1)


@each_camera
@pytest.mark.parametrize(("size", "height"), [((1, 1), 0.5), ((5, 3), 0.37), ((1, 6), 1.0)])
def test_a_plane_is_a_box_with_walls_at_the_border(view: Camera, size: tuple[int, int], height: float) -> None:
    """Constant height: the hit is the entry into [0, 1]^2 x [0, height], through its roof or through a wall."""
    result = frame(square(np.full(size, height)), view, method="exact")
    pixels, top, bottom = rays(view, result)
    first, last = entry(top, bottom, (0, 0, 0), (1, 1, height))
    found = hits(result, pixels)
    clear = abs(last - first) > 1e-9  # past the box's edges, but for rounding
    assert clear.mean() > 0.99
    assert (np.isfinite(found[:, 0]) == (first < last))[clear].all()
    met = clear & (first < last)
    assert_allclose(found[met], (top + first[:, None] * (bottom - top))[met], rtol=0, atol=ROUNDING)
    on_wall = met & (found[:, 2] < height - 1e-9)
    assert on_wall.sum() > 40
    border = np.minimum(abs(found[on_wall, :2]), abs(1 - found[on_wall, :2])).min(axis=1)
    assert border.max() <= ROUNDING, "walls stand on the border"
    steep = result.stages["march.steep"][tuple(pixels.T)]
    assert (steep == (found[:, 2] > 0.1))[on_wall].all(), "outside the map nothing was there one step before"


def profile_entry(top: Array, bottom: Array, knots: Array, heights: Array) -> Array:
    """t at which each ray first is below the height that depends on u alone, linear between knots; NaN: never.

    Along the ray H - h is linear between the ray's crossings of the knots, so that its first change of sign is found by
    the rule of three.
    """
    result = np.full(len(top), np.nan)
    for i, (b, a) in enumerate(zip(top, bottom, strict=True)):
        first, last = (float(t[0]) for t in entry(b[None, :2], a[None, :2], (0, 0), (1, 1)))
        first, last = max(first, 0.0), min(last, 1.0)
        crossings = (knots - b[0]) / (a[0] - b[0])
        ts = np.array([first, *np.sort(crossings[(crossings > first) & (crossings < last)]), last])
        inside = np.interp(b[0] + ts * (a[0] - b[0]), knots, heights) - (b[2] + ts * (a[2] - b[2]))
        if first >= last or not (inside > 0).any():
            continue
        k = int(np.argmax(inside > 0))
        result[i] = ts[0] if k == 0 else ts[k - 1] - inside[k - 1] * (ts[k] - ts[k - 1]) / (inside[k] - inside[k - 1])
    return result


PROFILES = {
    "a ramp": (np.arange(8) + 0.5) / 8,
    "a ramp that falls": 0.9 - 0.8 * (np.arange(8) + 0.5) / 8,
    "a box wall": np.where((np.arange(32) >= 12) & (np.arange(32) < 20), 0.75, 0.0),
    "a ridge": np.array([0.0, 0.0, 0.95, 0.0, 0.0]),
    "stairs": np.repeat([0.1, 0.3, 0.7, 0.9], 4),
}


@each_camera
@pytest.mark.parametrize("profile", PROFILES.values(), ids=PROFILES)
@pytest.mark.parametrize("rows", [1, 3])
def test_heights_along_u_alone_give_a_polygon(view: Camera, profile: Array, rows: int) -> None:
    """Linear between texel centres, constant in the half texels at the border: planes, met by the rule of three."""
    result = frame(square(np.tile(profile, (rows, 1))), view, method="exact")
    pixels, top, bottom = rays(view, result)
    knots = (np.arange(len(profile)) + 0.5) / len(profile)
    t = profile_entry(top, bottom, knots, profile)
    found = hits(result, pixels)
    on_surface = np.isfinite(found[:, 2]) & (found[:, 2] > 0)
    assert on_surface.sum() > 150
    assert (on_surface == np.isfinite(t)).all()
    assert_allclose(found[on_surface], (top + t[:, None] * (bottom - top))[on_surface], rtol=0, atol=10 * ROUNDING)


MOST_LINES = 30
"""Rays that cross more cells of a repeated map are left out: rational numbers are slow."""


def check_rational(result: Frame, view: Camera, heights: Array, interval: str = "paper", repeat: bool = False) -> int:
    """Every covered pixel against the first point inside in rational numbers; how many hit the surface.

    Rounding, 1e-15 in a height, moves the hit by that over the slope of H - h along the ray: 1e-10 allows for slopes down
    to 1e-5. (Rays that only touch the surface might go either way; none of these scenes has one.)
    """
    surface = 0
    for row, column in np.argwhere(result.stages["raster.face"] >= 0):
        c, found = result.stages["raster.patch"][row, column], result.stages["march.hit"][row, column]
        eye = patch_eye(view)
        ray = volume_ray(eye, c) if interval == "volume" else paper_ray(eye, c, bounded=not repeat)
        if ray is not None and crossings(ray, heights) > MOST_LINES:
            continue
        t = first_inside(heights, ray, repeat)
        expected = np.array([np.nan] * 3 if t is None or ray is None else [float(x) for x in ray.at(t)])
        depth = near_distance(view, expected)
        message = f"pixel {column}, {row}: found {found}, expected {expected}"
        if t is None or depth < -1e-12:
            assert not found[2] > 0, message
        elif depth > 1e-12:
            surface += 1
            assert_allclose(found, expected, rtol=0, atol=1e-10, err_msg=message)
    return surface


def crossings(ray: Ray, heights: Array) -> float:
    """About how many lines between cells a ray crosses."""
    (columns, rows), spans = heights.shape[::-1], [abs(float(b - a)) for a, b in zip(ray.start, ray.end, strict=True)]
    return spans[0] * columns + spans[1] * rows


def near_distance(view: Camera, p: Array) -> float:
    """How far a point of the patch space of `square` lies behind the near plane."""
    return float(-(view.view_from_world @ (p[0], p[1], p[2] * SCALE, 1.0))[2]) - view.near


BILINEAR = [[(0.1, 0.9), (0.8, 0.2)], [(0.0, 0.0), (0.0, 1.0)], [(1.0, 0.3), (0.3, 1.0)], [(0.2, 0.4), (0.6, 0.8)]]


@each_camera
@pytest.mark.parametrize("texels", BILINEAR)
def test_a_single_bilinear_cell_is_a_quadratic(view: Camera, texels: list[tuple[float, float]]) -> None:
    """2 x 2 texels: one cell between their centres, half a texel of constant height around it."""
    heights = np.array(texels)
    assert check_rational(frame(square(heights), view, method="exact"), view, heights) > 180


tiny_maps = st.tuples(st.integers(1, 5), st.integers(1, 5), st.integers(0, 10**6)).map(
    lambda size: np.round(noise(size[0], size[1], seed=size[2]) * 16) / 16
)
above = st.tuples(st.floats(-1.5, 2.5), st.floats(-1.5, 2.5), st.floats(0.3, 1.5))
targets = st.tuples(st.floats(0.2, 0.8), st.floats(0.2, 0.8), st.floats(0.0, 0.2))
few = settings(derandomize=True, deadline=None, max_examples=50, phases=[Phase.explicit, Phase.generate])


@few
@given(tiny_maps, above, targets, st.booleans())
def test_any_map_from_anywhere_above(heights: Array, eye: Any, target: Any, parallel: bool) -> None:
    view = (parallel_camera if parallel else camera)(eye, target, up=(0.1, 0.9, 0.3), width=7, height=5)
    check_rational(frame(square(heights), view, method="exact"), view, heights)


@few
@given(tiny_maps, above, targets, st.booleans())
def test_any_map_repeated(heights: Array, eye: Any, target: Any, parallel: bool) -> None:
    """The polygon is a window onto an endless plane of maps; heights at which every ray ends on some roof, or in a gap."""
    view = (parallel_camera if parallel else camera)(eye, target, up=(0.1, 0.9, 0.3), width=7, height=5)
    result = frame(square(heights, domain="repeat"), view, method="exact", faces="base")
    check_rational(result, view, heights, repeat=True)


around = st.tuples(st.floats(-0.6, 1.6), st.floats(-0.6, 1.6), st.floats(0.11, 0.6))
far_targets = st.tuples(st.floats(0.3, 0.7), st.floats(0.3, 0.7), st.floats(0.01, 0.1))


@few
@given(tiny_maps, around, far_targets, st.booleans())
def test_any_map_from_beside_or_inside_the_volume(heights: Array, eye: Any, target: Any, parallel: bool) -> None:
    """An eye in the solid itself sees nothing: the hit is at the eye, in front of the near plane."""
    view = (parallel_camera if parallel else camera)(eye, target, up=(0.1, 0.9, 0.3), width=7, height=5)
    check_rational(frame(square(heights), view, method="exact", interval="volume"), view, heights, interval="volume")


below = st.tuples(st.floats(-0.6, 1.6), st.floats(-0.6, 1.6), st.floats(-0.6, -0.05))


@few
@given(tiny_maps, below, far_targets, st.booleans())
def test_any_map_from_below(heights: Array, eye: Any, target: Any, parallel: bool) -> None:
    """The solid has an underside: a ray that enters the volume through h = 0 below a height > 0 starts inside."""
    view = (parallel_camera if parallel else camera)(eye, target, up=(0.1, 0.9, 0.3), width=7, height=5)
    check_rational(frame(square(heights), view, method="exact", interval="volume"), view, heights, interval="volume")
