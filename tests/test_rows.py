"""Some rows of a picture are those of the whole picture, bit for bit, with all their stages."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from ibr_ref import displacement, shadows, splatting
from ibr_ref.io import Frame
from tests import golden
from tests.shadows import golden_scenes as shadow_scenes

WIDTH, HEIGHT = 48, 36
CUTS = ((0, 7), (7, 8), (8, 36))

RENDERS: dict[str, Any] = {"displacement": displacement.render, "splatting": splatting.render}


def rendered(name: str, scene: Any, params: Any, **options: Any) -> Frame:
    method = name.split("/")[0]
    if method != "shadows":
        frame: Frame = RENDERS[method](scene, params, **options)
        return frame
    if isinstance(scene, shadows.Ensemble):
        return shadows.render_ensemble(scene, params, maps=shadow_scenes.prepared_for_all(scene, params), **options)
    return shadows.render(scene, params, maps=shadow_scenes.prepared(scene, params), **options)


def of_rows(array: Any, cut: tuple[int, int]) -> Any:
    """The rows of a stage that has the picture's, behind an axis of samples or not; all of any other."""
    if not isinstance(array, np.ndarray):
        return array
    for axis in (0, 1):
        if array.shape[axis : axis + 2] == (HEIGHT, WIDTH):
            return array[(slice(None),) * axis + (slice(*cut),)]
    return array


@pytest.mark.parametrize("name", golden.SCENES)
def test_rows_are_those_of_the_whole_picture(name: str) -> None:
    scene, params = golden.SCENES[name](WIDTH, HEIGHT)
    whole = rendered(name, scene, params)
    assert (whole.depth < 1.0).any()
    for cut in CUTS:
        part = rendered(name, scene, params, rows=cut)
        assert part.depth.shape == (cut[1] - cut[0], WIDTH)
        assert np.array_equal(part.color, whole.color[slice(*cut)])
        assert np.array_equal(part.depth, whole.depth[slice(*cut)])
        bare = rendered(name, scene, params, rows=cut, stages=False)
        assert np.array_equal(bare.color, part.color)
        assert part.stages.keys() == whole.stages.keys()
        for stage, array in part.stages.items():
            theirs = of_rows(whole.stages[stage], cut)
            same = (
                all(np.array_equal(*pair) for pair in zip(array, theirs, strict=True))
                if isinstance(array, tuple)
                else (np.array_equal(array, theirs, equal_nan=array.dtype.kind == "f"))
            )
            assert same, stage


@pytest.mark.parametrize("rows", [(0, 0), (5, 4), (-1, 3), (0, 37), (1.5, 3), 7, (1, 2, 3), ("a", 2)], ids=str)
def test_rows_that_are_none(rows: Any) -> None:
    for name in ("displacement/box", "splatting/balls", "shadows/direct"):
        with pytest.raises(ValueError, match=r"^rows.*: found .*, allowed: "):
            rendered(name, *golden.SCENES[name](WIDTH, HEIGHT), rows=rows)
