"""Polygons as triangles: as many as there must be, quick for many and for large ones, refused where they are none."""

from __future__ import annotations

import time

import numpy as np
import pytest

from ibr_ref.io.polygons import fan, strip, triangulated


def test_convex_polygons_stay_fans_from_their_first_corner():
    ring = np.array([(np.cos(a), np.sin(a), 0.0) for a in 2 * np.pi * np.arange(9) / 9])
    cut = triangulated(ring, np.arange(9), np.array([9]))
    np.testing.assert_array_equal(cut, [(0, k, k + 1) for k in range(1, 8)])


@pytest.mark.parametrize("turned", [False, True])
def test_n_corners_make_n_minus_2_triangles_with_all_edges(turned):
    """Corners on straight edges and at the ends of spikes too: neighbours have edges there."""
    corners = [
        (0, 0),
        (1, 0),
        (2, 0),
        (4, 0),
        (4, 3),
        (3, 3),
        (3, 1),
        (1, 1),
        (1, 3),
        (1, 5),
        (1, 3),
        (0, 3),
        (0, 2),
        (0, 1),
    ]
    points = np.array([(x, y, 0.0) for x, y in corners], np.float64)
    order = np.arange(len(points))[::-1] if turned else np.arange(len(points))
    cut = triangulated(points, order, np.array([len(points)]))
    assert len(cut) == len(points) - 2
    edges = [(int(t[k - 1]), int(t[k])) for t in cut for k in range(3)]
    border = sorted(edge for edge in edges if edge[::-1] not in edges)
    assert border == sorted(zip(order.tolist(), np.roll(order, -1).tolist(), strict=True))


def test_polygons_keep_their_places_among_others():
    points = np.array([(0, 0, 0), (2, -1, 0), (0.5, 0, 0), (2, 1, 0), (1, 0, 5)], np.float64)
    cut = triangulated(points, np.array([4, 0, 1, 0, 1, 2, 3, 1, 3, 4]), np.array([3, 4, 3]))
    np.testing.assert_array_equal(cut[[0, 3]], [(4, 0, 1), (1, 3, 4)])
    assert {frozenset(t) for t in cut[1:3].tolist()} == {frozenset((0, 1, 2)), frozenset((0, 2, 3))}


@pytest.mark.parametrize("count", [4096, 65_536])
def test_large_concave_polygons_do_not_hang(count):
    x = np.arange(count // 2)
    comb = np.concatenate([np.stack([x, 0 * x, 0 * x], axis=1), np.stack([x, 1 + x % 2, 0 * x], axis=1)[::-1]])
    begin = time.process_time()
    cut = triangulated(comb.astype(np.float64), np.arange(count), np.array([count]))
    assert time.process_time() - begin < 30.0
    assert len(cut) == count - 2


def test_a_concave_polygon_beyond_all_reason_is_refused():
    count = 2**16 + 2
    zigzag = np.stack([np.arange(count) % 3, np.arange(count), 0 * np.arange(count)], axis=1)
    with pytest.raises(ValueError, match="found 65538 corners in polygon 1 of the file"):
        triangulated(zigzag.astype(np.float64), np.arange(count), np.array([count]))


def test_no_polygons_are_no_triangles():
    assert triangulated(np.zeros((3, 3)), np.zeros(0, np.int64), np.zeros(0, np.int64)).shape == (0, 3)


def test_strips_and_fans():
    np.testing.assert_array_equal(strip(np.array([7, 8, 9, 5, 6])), [(7, 8, 9), (8, 5, 9), (9, 5, 6)])
    np.testing.assert_array_equal(fan(np.array([7, 8, 9, 5])), [(8, 9, 7), (9, 5, 7)])
    assert len(strip(np.array([1, 2]))) == len(fan(np.array([1]))) == 0
