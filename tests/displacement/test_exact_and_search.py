"""What the linear search finds of the truth: all but what is thinner than its steps."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from tests.displacement.scenes import Array, block, camera, frame, noise, patch_eye, spike, square
from tests.pipeline.texels import bilinear

N, M = 4096, 6
LATTICE = N << M

GRAZING = {"eye": (2.0, -1.5, 0.3), "vertical_fov": 24.0}
VIEWS = {"oblique": camera(), "grazing": camera(**GRAZING), "from behind": camera(eye=(-0.8, 1.2, 0.5))}
LARGE_VIEWS = {"oblique": camera(width=160, height=120), "grazing": camera(width=160, height=120, **GRAZING)}
MAPS = {
    "a box": block(24, 24, 8, 16, 0.75),
    "noise": noise(24, 24),
    "finer noise": noise(64, 64),
}
MISSED = {
    ("noise", "grazing"): 3,
    ("noise", "from behind"): 1,
    ("finer noise", "oblique"): 1,
    ("finer noise", "grazing"): 13,
    ("finer noise", "from behind"): 5,
}
"""Pixels that a search of 4,096 steps gets wrong, of about 450: crests that the view ray cuts for less than a step."""


@pytest.mark.parametrize("view", VIEWS)
@pytest.mark.parametrize("name", MAPS)
def test_4096_steps_stop_at_the_lattice_point_behind_the_exact_hit(name: str, view: str) -> None:
    """K = 2^18: the search's t is the exact one rounded up to the lattice, never before it, at most 1/K (and rounding)
    behind it. Where it is farther, or finds nothing, no sample of the linear search is inside the solid: a miss.
    """
    polygon = square(MAPS[name])
    exact = frame(polygon, VIEWS[view], method="exact")
    search = frame(polygon, VIEWS[view], linear_steps=N, binary_steps=M)
    t_exact, t_search = 1 - exact.stages["march.hit"][..., 2], 1 - search.stages["march.hit"][..., 2]
    hit = np.isfinite(t_exact)
    assert hit.sum() > 200
    assert not np.isfinite(t_search[~hit]).any(), "the search finds nothing that is not there"
    late = np.where(np.isfinite(t_search), t_search, 1.0)[hit] - t_exact[hit]
    assert late.min() >= -1e-12
    missed = np.argwhere(hit)[(late > 1 / LATTICE + 1e-12) | ~np.isfinite(t_search[hit])]
    for row, column in missed:
        c = exact.stages["raster.patch"][row, column]
        last = t_search[row, column] if np.isfinite(t_search[row, column]) else 1.0
        assert samples_inside(MAPS[name], patch_eye(VIEWS[view]), c, t_exact[row, column], last) == 0
    assert len(missed) == MISSED.get((name, view), 0)


def samples_inside(heights: Array, eye: Array, c: Array, first: float, last: float) -> int:
    """How many samples of the linear search between two t (one step less at the end) are inside the solid."""
    v = eye[:3] - eye[3] * c
    top, bottom = c + v * ((1 - c[2]) / v[2]), c - v * (c[2] / v[2])
    count = 0
    for i in range(int(np.ceil(first * N)), int(np.floor(last * N - 1e-9))):
        u, w = (top + (bottom - top) * (i / N))[:2].tolist()
        within = 0 <= u <= 1 and 0 <= w <= 1
        count += within and 1 - i / N < bilinear(heights, u, w, repeat=False)
    return count


@pytest.mark.parametrize(
    ("texels", "view", "shown", "by_ten", "by_fifty"),
    [(32, "oblique", 54, 26, 51), (64, "oblique", 24, 2, 19), (64, "grazing", 45, 6, 18), (128, "oblique", 12, 1, 8)],
)
def test_ten_steps_miss_most_of_a_spike_that_exact_shows(
    texels: int, view: str, shown: int, by_ten: int, by_fifty: int
) -> None:
    """One texel of height 0.95 in a picture of 160 x 120: pixels that show it. The paper's second open problem."""
    polygon = square(spike(texels, texels, texels // 2, texels // 2 + 1, 0.95))

    def raised(**params: Any) -> NDArray[np.bool_]:
        return frame(polygon, LARGE_VIEWS[view], **params).stages["march.hit"][..., 2] > 0

    exact = raised(method="exact")
    ten, fifty = raised(linear_steps=10), raised(linear_steps=50)
    assert (exact.sum(), ten.sum(), fifty.sum()) == (shown, by_ten, by_fifty)
    assert exact[ten | fifty].all(), "a search shows nothing that is not there"
    assert (raised(linear_steps=4096) == exact).all()


def test_exact_reports_the_lattice_of_the_search() -> None:
    """linear_index and hit_index of the first lattice points at or behind the hit, so that pictures of both compare."""
    polygon = square(noise(8, 8))
    exact = frame(polygon, camera(), method="exact", linear_steps=10, binary_steps=6)
    t = 1 - exact.stages["march.hit"][..., 2]
    on_surface = exact.stages["march.linear_index"] >= 0
    assert on_surface.sum() > 200
    assert (exact.stages["march.linear_index"] == np.ceil(10 * t))[on_surface].mean() > 0.999
    assert (exact.stages["march.hit_index"] == np.ceil(640 * t))[on_surface].mean() > 0.999
    assert (exact.stages["march.hit_index"][exact.stages["march.hit"][..., 2] == 0] == 640).all()
