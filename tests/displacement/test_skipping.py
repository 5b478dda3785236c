"""The search leaps over stretches that the coarse maxima prove empty: it must not leap over anything that is there."""

from __future__ import annotations

from itertools import product
from typing import Any

import pytest
from hypothesis import event, given, settings
from hypothesis import strategies as st

from ibr_ref.displacement import Params, Scene, render
from ibr_ref.displacement.maxima import build, highest
from tests.displacement.scenes import LIGHT, SCALE, camera, parallel_camera, same, spike, square
from tests.naive import displacement as naive
from tests.pipeline.texels import bilinear

derandomized = settings(derandomize=True, deadline=None, max_examples=50)

texels_in_a_map = st.one_of(st.integers(1, 70), st.sampled_from([8, 16, 17, 63, 64, 65]))
eyes = st.tuples(st.floats(-1.0, 2.0), st.floats(-1.0, 2.0), st.floats(0.05, 1.0))
within_a_texel = st.tuples(st.floats(-1.0, 1.0), st.floats(-1.0, 1.0))


@derandomized
@given(
    size=st.tuples(texels_in_a_map, texels_in_a_map),
    where=st.tuples(st.floats(0.0, 1.0), st.floats(0.0, 1.0)),
    height=st.floats(0.05, 1.0),
    eye=st.one_of(eyes, st.none()),
    beside=within_a_texel,
    kind=st.sampled_from(["paper", "repeat", "volume"]),
    parallel=st.booleans(),
    linear_steps=st.sampled_from([3, 40, 150]),
)
def test_one_raised_texel_anywhere_is_found_where_a_search_without_leaps_finds_it(
    size: tuple[int, int],
    where: tuple[float, float],
    height: float,
    eye: Any,
    beside: tuple[float, float],
    kind: str,
    parallel: bool,
    linear_steps: int,
) -> None:
    """The camera looks at it, or at what it raises around it, with a narrow angle; from straight above, if there is no eye.
    The naive twin takes all samples: every bit of the march is compared, margins too."""
    rows, columns = size
    row, column = min(int(where[0] * rows), rows - 1), min(int(where[1] * columns), columns - 1)
    heights = spike(rows, columns, row, column, height)
    at = ((column + 0.5 + beside[0]) / columns, (row + 0.5 + beside[1]) / rows, 0.4 * height * SCALE)
    above = (at[0] + 1e-3, at[1], 1.0)
    view = {"eye": eye or above, "target": at, "up": (0.1, 1.0, 0.2), "width": 6, "height": 5}
    span = (2.5 if eye else 0.6) / max(rows, columns)
    seen = parallel_camera(**view, view_height=span) if parallel else camera(**view, vertical_fov=min(60.0, 50 * span))
    polygon = square(heights, domain="repeat" if kind == "repeat" else "clip")
    scene = Scene(polygons=[polygon], camera=seen, light=LIGHT)
    params = Params(
        linear_steps=linear_steps,
        binary_steps=3,
        interval="volume" if kind == "volume" else "paper",
        faces="base" if kind == "repeat" else "auxiliary",
    )
    ours, (theirs, _, _) = render(scene, params).stages, naive.render(scene, params)
    event(f"{kind}: {'some' if (ours['march.linear_index'] >= 0).any() else 'no'} pixel shows the spike")
    for name in theirs:
        if name.startswith("march."):
            assert same(ours[name], theirs[name]), name


@pytest.mark.parametrize("size", [(1, 1), (8, 8), (9, 25), (33, 16), (40, 7)])
def test_no_fetch_returns_more_than_the_maximum_of_its_region(size: tuple[int, int]) -> None:
    """Each texel of the map's diagonal raised alone: points that it still reaches, and regions of so many texels around
    them. A fetch reads the texels beside its cell of 8 x 8 as well."""
    rows, columns = size
    for k in range(max(size)):
        row, column = min(k, rows - 1), min(k, columns - 1)
        heights = spike(rows, columns, row, column, 0.7)
        texels = heights.reshape(-1)
        texels.setflags(write=False)
        maxima = build(texels, rows, columns)
        for beside in product((-0.9, -0.4, 0.2, 0.6, 0.95), repeat=2):
            u, v = (column + 0.5 + beside[0]) / columns, (row + 0.5 + beside[1]) / rows
            value = bilinear(heights, u, v, repeat=False)
            for left, right, up, down in ((0, 0, 0, 0), (0.3, 0, 0, 0.3), (0, 3, 3, 0), (20, 0, 0, 9), (1, 50, 50, 1)):
                region = (u - left / columns, u + right / columns, v - up / rows, v + down / rows)
                assert value <= highest(maxima, *region)
