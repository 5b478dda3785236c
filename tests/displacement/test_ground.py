"""What the method is for: shapes stick out, and the ground does not move (the paper's figure 3)."""

from __future__ import annotations

import numpy as np
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from ibr_ref import BasePolygon, Camera
from ibr_ref.io import Frame
from tests.displacement.scenes import block, camera, frame, square

BEGIN, END, SIZE = 20, 44, 64
HEIGHTS = block(SIZE, SIZE, BEGIN, END, 0.9)

SAME = 1e-12
"""A hit on the ground is C, taken up to h = 1 and down again: rounded to 1e-15, times the colour map's slope (7 texels)."""


def misses_the_box(polygon: BasePolygon, view: Camera, result: Frame) -> NDArray[np.bool_]:
    """Pixels of the base whose view ray, from the fragment up to h = 1, stays clear of the box and its walls.

    The raised texels' tent reaches half a texel beyond the outermost ground texel's centre: in u and v the box is
    [(begin - 1/2)/size, (end + 1/2)/size]. Slab method in world space.
    """
    c = result.stages["raster.patch"].astype(np.float64)
    scale = polygon.height_scale
    eye = view.eye[:3] / (1, 1, scale)
    ray = eye - c
    low, high = np.array([BEGIN - 0.5] * 2) / SIZE, np.array([END + 0.5] * 2) / SIZE
    with np.errstate(invalid="ignore"):
        a, b = (low - c[..., :2]) / ray[..., :2], (high - c[..., :2]) / ray[..., :2]
        first = np.minimum(a, b).max(axis=2)
        last = np.minimum(np.maximum(a, b).min(axis=2), 0.9 / ray[..., 2])
        clear = (first > last + 1e-9) | (last < 0)
    return clear & (result.stages["raster.face"] == 0)


eyes = st.tuples(st.floats(-1.0, 2.0), st.floats(-1.0, 2.0), st.floats(0.7, 2.0))
derandomized = settings(derandomize=True, deadline=None, max_examples=25)


@derandomized
@given(eyes, st.floats(0.01, 0.6), st.integers(1, 20), st.integers(0, 6))
def test_the_ground_stays_where_the_flat_texture_is_whatever_the_height_scale(
    eye: tuple[float, float, float], scale: float, linear_steps: int, binary_steps: int
) -> None:
    """Where the view ray meets no raised texel, the pixel is that of texture mapping; and the flat parts of relief
    mapping (d = 1, all that is not raised) have moved by v_uv/v_h: the shorter the height scale, the less."""
    polygon = square(HEIGHTS, height_scale=scale)
    view = camera(eye, target=(0.5, 0.5, 0.0), up=(0.1, 1.0, 0.2))
    flat = frame(polygon, view, method="texture")
    result = frame(polygon, view, linear_steps=linear_steps, binary_steps=binary_steps)
    ground = misses_the_box(polygon, view, result)
    assume(ground.sum() > 100)
    assert abs(result.color - flat.color)[ground].max() <= SAME
    assert abs(result.depth - flat.depth)[ground].max() <= SAME
    assert (result.stages["march.linear_index"][ground] == -1).all()
    assert (result.stages["march.hit_index"][ground] == linear_steps << binary_steps).all()
    assert (result.stages["march.hit"][ground][:, 2] == 0).all()


@derandomized
@given(eyes, st.floats(0.05, 0.6))
def test_relief_mapping_moves_the_ground(eye: tuple[float, float, float], scale: float) -> None:
    """Every flat pixel that is still on the map lies at d = 1, moved away from the eye by |v_uv|/v_h."""
    polygon = square(HEIGHTS, height_scale=scale)
    view = camera(eye, target=(0.5, 0.5, 0.0), up=(0.1, 1.0, 0.2))
    relief = frame(polygon, view, method="relief", linear_steps=50)
    hit = relief.stages["march.hit"]
    sunk = hit[..., 2] == -1.0
    assume(sunk.sum() > 50)
    c = relief.stages["raster.patch"][sunk]
    v = view.eye[:3] / (1, 1, scale) - c
    assert abs(c[:, :2] - hit[sunk][:, :2] - v[:, :2] / v[:, 2:]).max() <= SAME
    flat = frame(polygon, view, method="texture")
    oblique = np.hypot(v[:, 0], v[:, 1]) / v[:, 2] > 0.05
    inner = ((c[:, :2] > 0.11) & (c[:, :2] < 0.89) & (hit[sunk][:, :2] > 0.11) & (hit[sunk][:, :2] < 0.89)).all(axis=1)
    different = abs(relief.color - flat.color)[sunk].max(axis=1) > 1e-6
    assert different[oblique & inner].all(), "but in the half texels at the border, which have one colour"


def test_a_flat_map_is_texture_mapping() -> None:
    """Height 0 everywhere: not one pixel outside the polygon, the same picture inside."""
    polygon = square(np.zeros((4, 4)))
    flat, protruded = frame(polygon, camera(), method="texture"), frame(polygon, camera())
    assert abs(protruded.color - flat.color).max() <= SAME
    assert ((protruded.depth < 1) == (flat.depth < 1)).all()
    side = protruded.stages["raster.face"] > 0
    assert side.any()
    assert (protruded.stages["march.hit_index"][side] == -1).all()


def test_the_box_hides_ground_and_sticks_out_of_the_outline() -> None:
    """A box up to the border, seen from the side: pixels outside the polygon show it, on the side faces."""
    polygon = square(block(64, 64, 30, 64, 0.9))
    flat, result = frame(polygon, camera(), method="texture"), frame(polygon, camera())
    shown = result.stages["march.hit_index"] >= 0
    outside = shown & (flat.stages["raster.face"] < 0)
    assert outside.sum() > 60
    assert set(np.unique(result.stages["raster.face"][outside])) <= {1, 2, 3, 4}
    assert (result.stages["march.hit"][outside][:, 2] > 0).all()
