"""The figures that automatic control points must reach, S = 256, 15 x 5, dissolve (the table: `tests.shadows.quality`)."""

from __future__ import annotations

import pytest

from ibr_ref.shadows import Params, prepare, prepare_grid
from tests.shadows import quality
from tests.shadows.casters import DATA

WITH_DATA = pytest.mark.skipif(
    not DATA.exists(), reason="the cow and the teapot are not beside the repository (../shared/data)"
)


@pytest.mark.long
@pytest.mark.parametrize(
    ("name", "controls", "samples", "mean", "worst"),
    [
        pytest.param("cow", "best", 1, 0.960, 0.945, marks=WITH_DATA),
        pytest.param("cow", "best", 4, 0.968, 0.950, marks=WITH_DATA),
        pytest.param("cow", "fast", 1, 0.940, 0.900, marks=WITH_DATA),
        pytest.param("teapot", "best", 1, 0.952, 0.930, marks=WITH_DATA),
        ("chair", "best", 1, 0.920, 0.865),
    ],
)
def test_warped_maps_are_the_rendered_ones(name: str, controls: str, samples: int, mean: float, worst: float) -> None:
    scenes = quality.stages(name, quality.OFFSETS)
    params = Params(map_size=256, map_samples=samples)
    found = quality.map_quality(scenes, params, prepare(scenes[0], params, controls=controls))
    assert found[0] >= mean, found
    assert found[1] >= worst, found


@pytest.mark.long
@WITH_DATA
def test_soft_shadows_are_nearer_than_those_of_1024_maps() -> None:
    scenes = quality.stages("cow", quality.SOFT_OFFSETS)
    params = Params(map_size=256, light_samples=9)
    grid = Params(map_size=256, light_samples=9, method="grid")
    warped = quality.soft_quality(scenes, params, prepare(scenes[0], params, controls="best"))
    mixed = quality.soft_quality(scenes, grid, prepare_grid(scenes[0], grid))
    assert warped < mixed
    assert warped < 0.034
