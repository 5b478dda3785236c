"""Curves and rings: what they interpolate, and which way they turn."""

from __future__ import annotations

import numpy as np
import pytest

from ibr_ref.models.loft import capped, joined, looped, turn
from ibr_ref.models.sweep import ellipses, spline, straight, tube
from tests.models.surfaces import assert_closed, volumes

KNOTS = np.array([(0.0, 1.0), (2.0, -1.0), (2.5, 4.0), (7.0, 0.5)])


def test_a_spline_passes_through_its_knots() -> None:
    np.testing.assert_array_equal(spline(KNOTS, 13)[::4], KNOTS)


def test_a_spline_through_even_points_of_a_line_is_the_line() -> None:
    line = np.stack([np.arange(5.0), 3.0 - 2.0 * np.arange(5.0)], axis=1)
    even = np.linspace(0.0, 4.0, 33)
    np.testing.assert_allclose(spline(line, 33), np.stack([even, 3.0 - 2.0 * even], axis=1), atol=1e-15)


def test_a_spline_is_smooth_at_its_knots() -> None:
    """Its slopes there are half the differences of the knots around, from either side."""
    step = 1e-6
    count = round(3 / step) + 1
    curve = spline(KNOTS, count)
    at = (count - 1) // 3
    before, after = curve[at] - curve[at - 1], curve[at + 1] - curve[at]
    np.testing.assert_allclose(before / step, (KNOTS[2] - KNOTS[0]) / 2.0, atol=1e-4)
    np.testing.assert_allclose(after / step, (KNOTS[2] - KNOTS[0]) / 2.0, atol=1e-4)


@pytest.mark.parametrize("end", [(0.0, 0.0, 2.0), (0.0, 0.0, -2.0), (3.0, 1.0, -1.0)])
def test_a_tube_is_round_square_to_its_path_and_wound_outward(end: tuple[float, float, float]) -> None:
    path = straight((0.0, 0.0, 0.0), end, [0.0, 0.25, 1.0])
    rings = tube(path, [0.1, 0.2, 0.1], (0.0, 1.0, 0.0), 16)
    away = rings - path[:, None]
    np.testing.assert_allclose(np.linalg.norm(away, axis=2), [[0.1] * 16, [0.2] * 16, [0.1] * 16], rtol=1e-14)
    np.testing.assert_allclose(away @ np.array(end), 0.0, atol=1e-14)
    mesh = capped(rings, path[0], path[-1], (1, 1, 1))
    assert_closed(mesh)
    length, area = np.linalg.norm(end), 8.0 * np.sin(np.pi / 8.0)
    mean = 0.25 * (0.1 * 0.1 + 0.1 * 0.2 + 0.2 * 0.2) / 3.0 + 0.75 * (0.1 * 0.1 + 0.1 * 0.2 + 0.2 * 0.2) / 3.0
    assert volumes(mesh) == pytest.approx([length * area * mean], rel=1e-12)


def test_two_radii_are_those_across_and_square_to_it() -> None:
    path = straight((0.0, 0.0, 0.0), (0.0, 0.0, 1.0), [0.0, 1.0])
    (ring, _) = tube(path, [(0.3, 0.1), (0.3, 0.1)], (0.0, 1.0, 0.0), 4)
    np.testing.assert_allclose(ring, [(0.3, 0, 0), (0, 0.1, 0), (-0.3, 0, 0), (0, -0.1, 0)], atol=1e-16)


def test_an_ellipse_begins_at_its_first_axis() -> None:
    origin, first_axis, second_axis = np.array([[(0, 0, 0)], [(2, 0, 0)], [(0, 5, 0)]])
    ((first, second, *_),) = ellipses(origin, first_axis, second_axis, 4)
    np.testing.assert_allclose([first, second], [(2, 0, 0), (0, 5, 0)], atol=1e-15)


def test_a_loop_is_closed_and_wound_outward() -> None:
    """At every height its section is a ring of 12-gons, whose area is 3/pi of the circles'; so is the volume."""
    x, y = turn(12).T[:, :, None]
    c, s = turn(6).T
    rings = np.stack([(2.0 + c) * x, (2.0 + c) * y, -s + 0.0 * x], axis=2)
    mesh = looped(rings, (0, 0, 1))
    assert_closed(mesh)
    assert len(np.asarray(mesh.triangles)) == 2 * 12 * 6
    hexagon = 1.5 * np.sqrt(3.0)
    assert volumes(mesh) == pytest.approx([3.0 / np.pi * 2.0 * np.pi * 2.0 * hexagon], rel=1e-14)


def test_colours_by_ring_and_joined_parts() -> None:
    path = straight((0.0, 0.0, 0.0), (0.0, 0.0, 1.0), [0.0, 1.0])
    rings = tube(path, [1.0, 1.0], (0.0, 1.0, 0.0), 3)
    striped = capped(rings, path[0], path[1], [(1, 0, 0), (0, 0, 1)])
    np.testing.assert_array_equal(striped.color, [(1, 0, 0)] * 4 + [(0, 0, 1)] * 4)
    both = joined([striped, capped(rings, path[0], path[1], (0, 1, 0))])
    np.testing.assert_array_equal(np.asarray(both.color)[8:], [(0, 1, 0)] * 8)
    np.testing.assert_array_equal(np.asarray(both.triangles)[12:], np.asarray(striped.triangles) + 8)
    assert len(volumes(both)) == 2
