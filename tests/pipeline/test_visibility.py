"""Meshes with a depth buffer: winners and depths against every triangle by itself, and a mesh of real size."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp
from numpy.typing import NDArray

from ibr_ref.pipeline.clip import clip_triangles
from ibr_ref.pipeline.triangles import Triangles, set_up
from ibr_ref.pipeline.visibility import interpolate, visible
from ibr_ref.scene import Camera

WIDTH, HEIGHT = 40, 37  # the last band is not full


def prepared(clip: NDArray[np.float64], varyings: NDArray[np.float64], indices: NDArray[np.int32]) -> Triangles:
    return set_up(clip_triangles(clip, varyings, indices, WIDTH, HEIGHT), WIDTH, HEIGHT)


def only(triangles: Triangles, t: int) -> Triangles:
    return Triangles(*(np.ascontiguousarray(array[t : t + 1]) for array in triangles))


def vertices(count: int) -> st.SearchStrategy[NDArray[np.float64]]:
    """Clip-space vertices around the picture, some behind the near plane; depths from few values, so that they tie."""
    xy = hnp.arrays(np.float64, (count, 2), elements=st.integers(-48, 48).map(lambda k: k / 32))
    z = hnp.arrays(np.float64, (count, 1), elements=st.sampled_from([-0.25, 0.25, 0.5, 0.5, 0.75, 1.0, 1.5]))
    return st.tuples(xy, z).map(lambda parts: np.concatenate([*parts, np.ones((count, 1))], axis=1))


@settings(max_examples=60, deadline=None, derandomize=True)
@given(vertices(18))
def test_the_nearest_triangle_wins_and_ties_go_to_the_earlier_one(clip: NDArray[np.float64]) -> None:
    indices = np.arange(18, dtype=np.int32).reshape(6, 3)
    triangles = prepared(clip, clip[:, :1].copy(), indices)
    seen = visible(triangles, WIDTH, HEIGHT)
    winner = np.full((HEIGHT, WIDTH), -1)
    depth = np.ones((HEIGHT, WIDTH))
    for t in range(len(triangles.source)):
        alone = visible(only(triangles, t), WIDTH, HEIGHT)
        nearer = (alone.triangle == 0) & (alone.depth < depth)
        winner[nearer], depth[nearer] = t, alone.depth[nearer]
    assert np.array_equal(seen.triangle, winner)
    assert np.array_equal(seen.depth, depth)


@settings(max_examples=30, deadline=None, derandomize=True)
@given(vertices(9))
def test_varyings_are_those_of_the_winner(clip: NDArray[np.float64]) -> None:
    """The varyings are the clip position itself: over w they give back the pixel centre, within the snapping."""
    clip[:, 3] = np.maximum(clip[:, 2], 0.5)
    triangles = prepared(clip, clip.copy(), np.arange(9, dtype=np.int32).reshape(3, 3))
    seen = visible(triangles, WIDTH, HEIGHT)
    position = interpolate(triangles, seen.triangle)
    shown = seen.triangle >= 0
    assert np.isnan(position[~shown]).all()
    for t in np.unique(seen.triangle[shown]):
        here = seen.triangle == t
        alone = interpolate(only(triangles, t), np.where(here, 0, -1).astype(np.int32))
        assert np.array_equal(alone[here], position[here])


def plane(cells: int) -> tuple[NDArray[np.float64], NDArray[np.int32]]:
    """A unit square of cells x cells quads."""
    rows, columns = np.mgrid[0 : cells + 1, 0 : cells + 1] / cells
    points = np.stack([columns - 0.5, rows - 0.5, np.zeros_like(rows)], axis=-1).reshape(-1, 3)
    corner = np.arange(cells * (cells + 1)).reshape(cells, cells + 1)[:, :-1].reshape(-1)
    across, along = corner + 1, corner + cells + 1
    quads = np.concatenate([np.stack([corner, across, along + 1], 1), np.stack([corner, along + 1, along], 1)])
    return points, quads.astype(np.int32)


def test_a_hundred_thousand_triangles_at_1920_x_1080() -> None:
    """A finely divided square covers what two triangles cover, but for the pixels that snapping gains or loses."""
    camera = Camera.look_at(eye=(0.5, -0.9, 0.8), target=(0, 0, 0), near=0.1, far=10, width=1920, height=1080)
    pictures = []
    for cells in (1, 224):
        points, indices = plane(cells)
        clip = np.concatenate([points, np.ones((len(points), 1))], axis=1) @ camera.clip_from_world.T
        triangles = set_up(clip_triangles(clip, points, indices, 1920, 1080), 1920, 1080)
        seen = visible(triangles, 1920, 1080)
        pictures.append((len(indices), seen, interpolate(triangles, seen.triangle)))
    (_, coarse, coarse_points), (count, fine, fine_points) = pictures
    assert count == 100_352
    both = (coarse.triangle >= 0) & (fine.triangle >= 0)
    assert ((coarse.triangle >= 0) != (fine.triangle >= 0)).sum() <= 40, "only along the outline"
    assert both.mean() > 0.2
    # A vertex is snapped by at most 1/512 pixel; a pixel is 0.003 of the square or less.
    assert abs(coarse.depth - fine.depth)[both].max() < 1e-4
    assert abs(coarse_points - fine_points)[both].max() < 1e-4


def test_nothing_to_draw() -> None:
    empty = prepared(np.zeros((0, 4)), np.zeros((0, 2)), np.zeros((0, 3), np.int32))
    seen = visible(empty, WIDTH, HEIGHT)
    assert (seen.triangle == -1).all()
    assert (seen.depth == 1.0).all()
    assert np.isnan(interpolate(empty, seen.triangle)).all()


@pytest.mark.parametrize("z", [0.5, 1.0])
def test_only_depths_below_one_are_shown(z: float) -> None:
    """At the far plane the weights E_i / E sum to 1 only within rounding: a pixel may show 1 - 2^-53, but never 1."""
    clip = np.array([[-1.0, -1, z, 1], [3, -1, z, 1], [-1, 3, z, 1]])
    seen = visible(prepared(clip, clip, np.array([[0, 1, 2]], np.int32)), WIDTH, HEIGHT)
    assert np.array_equal(seen.triangle >= 0, seen.depth < 1.0)
    assert (seen.triangle == 0).all() == (z == 0.5)
    assert abs(seen.depth - z).max() < 1e-15
