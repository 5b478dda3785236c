"""More steps: what a finer search may change, on the lattice of integers, without any tolerance."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from ibr_ref.io import Frame
from tests.displacement.scenes import block, camera, frame, noise, parallel_camera, square
from tests.pipeline.texels import bilinear

VIEWS = {
    "perspective": camera(),
    "orthographic": parallel_camera(),
    "low": camera(eye=(1.2, -0.6, 0.1)),
    "inside": camera(eye=(0.5, 0.1, 0.2), target=(0.6, 0.9, 0.1)),
}
MAPS = {"noise": noise(20, 20), "a box": block(64, 64, 20, 44, 0.9), "spikes": noise(24, 24) ** 8}

derandomized = settings(derandomize=True, deadline=None, max_examples=30)
scenes = st.tuples(st.sampled_from(sorted(MAPS)), st.sampled_from(sorted(VIEWS)), st.sampled_from(["paper", "volume"]))
Choice = tuple[str, str, str]


def search(choice: Choice, linear_steps: int, binary_steps: int) -> Frame:
    heights, view, interval = choice
    return frame(
        square(MAPS[heights]), VIEWS[view], interval=interval, linear_steps=linear_steps, binary_steps=binary_steps
    )


def indices(result: Frame) -> tuple[NDArray[np.int32], NDArray[np.int32]]:
    """(linear, hit) of each pixel."""
    linear: Any = result.stages["march.linear_index"]
    hit: Any = result.stages["march.hit_index"]
    return linear, hit


@derandomized
@given(scenes, st.integers(1, 40), st.integers(0, 7))
def test_one_more_binary_step_moves_a_hit_by_half_a_lattice_step_at_most(choice: Choice, n: int, m: int) -> None:
    """The new lattice has twice the points: a hit at k is found at 2 k or at 2 k - 1. In t it moves by less than one old
    step, and never away from the eye. A last point on the plane of the polygon itself (k = K) may turn into a hit."""
    linear, hit = indices(search(choice, n, m))
    new_linear, new_hit = indices(search(choice, n, m + 1))
    found = linear >= 0
    behind = 2 * hit - new_hit
    assert (new_linear == linear)[found].all()
    assert np.isin(behind[found], (0, 1)).all()
    assert (behind[found & (linear == 0)] == 0).all()
    lattice = n << m
    changed = ~found & (new_linear >= 0)
    assert (new_hit[changed] == 2 * lattice - 1).all()
    unchanged = ~found & ~changed
    assert (new_hit == np.where(hit < 0, -1, 2 * hit))[unchanged].all()


@derandomized
@given(scenes, st.integers(1, 40), st.integers(0, 6))
def test_a_finer_linear_search_never_finds_a_hit_later(choice: Choice, n: int, m: int) -> None:
    """The samples of N steps are among those of 2 N. So 2 N stop at the same sample or before, and the hit, refined by the
    same number of halvings (then finer by one), is not behind the old one in t."""
    linear, hit = indices(search(choice, n, m))
    new_linear, new_hit = indices(search(choice, 2 * n, m))
    found = linear >= 0
    assert (new_linear >= 0)[found].all()
    assert (new_linear <= 2 * linear)[found].all()
    assert (new_hit <= 2 * hit)[found].all()
    assert (new_hit < 2 * (n << m))[new_linear >= 0].all()


@derandomized
@given(scenes, st.integers(1, 40), st.integers(0, 6))
def test_a_hit_is_in_the_last_linear_step(choice: Choice, n: int, m: int) -> None:
    """(i - 1) 2^M < k <= i 2^M; k = 0 where the ray starts inside (i = 0)."""
    linear, hit = indices(search(choice, n, m))
    found = linear > 0
    assert (hit > (linear - 1) << m)[found].all()
    assert (hit <= linear << m)[found].all()
    assert (hit[linear == 0] == 0).all()


@pytest.mark.parametrize("view", VIEWS)
@pytest.mark.parametrize("interval", ["paper", "volume"])
def test_a_hit_is_a_point_of_the_view_ray_below_the_surface(view: str, interval: str) -> None:
    """h < H there, unless it is the polygon itself; the ray's point C, the hit and the eye are on a line (to 1e-12)."""
    heights = MAPS["noise"]
    result = frame(square(heights), VIEWS[view], interval=interval)
    hit = result.stages["march.hit"].astype(np.float64)
    linear, _ = indices(result)
    on_surface = linear >= 0
    assert on_surface.sum() > 100
    for u, v, h in hit[on_surface].tolist():
        assert h < bilinear(heights, u, v, repeat=False)
    eye = VIEWS[view].eye * (1, 1, 4, 1)
    c = result.stages["raster.patch"].astype(np.float64)[on_surface]
    towards = eye[:3] - eye[3] * c
    across = np.cross(hit[on_surface] - c, towards)
    assert abs(across).max() <= 1e-12 * max(1.0, abs(towards).max() ** 2)
