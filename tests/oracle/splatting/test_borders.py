"""Quads at the picture's borders may be cut there, where an API's view volume ends: their depth is made once more."""

from __future__ import annotations

import numpy as np
import pytest

from ibr_ref.affine.rows import UNIT
from ibr_ref.oracle.device import PROFILES
from ibr_ref.oracle.pipeline.splats import recut
from ibr_ref.oracle.referees.splatting.model import Model
from tests.oracle.splatting.judged import Arrays, case, reference, stages

LAMP = "splatting-lamp"


def moved(at: tuple[int, int]) -> Arrays:
    """A depth that is off by 30 units at a pixel: more than a rasterizer's own, less than that of a piece."""
    arrays = dict(reference(LAMP))
    for name in ("raster.depth", "depth"):
        arrays[name] = arrays[name].copy()
        arrays[name][at] *= 1.0 + 30.0 * UNIT
    return arrays


def pixel(across: bool) -> tuple[int, int]:
    """One whose splat lies across a border, and one whose splat does not."""
    arrays, camera = reference(LAMP), case(LAMP).scene.camera
    splat, width = arrays["raster.splat"], arrays["vertex.width"][:, None]
    beyond = (arrays["vertex.window"] < 0.4 * width) | (
        arrays["vertex.window"] > (camera.width, camera.height) - 0.4 * width
    )
    found = np.argwhere((splat >= 0) & (beyond.any(axis=1)[splat] == across))
    return int(found[0][0]), int(found[0][1])


@pytest.mark.parametrize(("profile", "across", "legal"), [("vulkan", True, True), ("vulkan", False, False),
                                                          ("d3d11", True, False), ("d3d11", False, False)])  # fmt: skip
def test_what_is_cut_may_be_off_by_more(profile: str, across: bool, legal: bool) -> None:
    arrays = moved(pixel(across))
    judged = next(j for j in stages(LAMP, arrays, profile) if j.stage == "raster")
    assert judged.wrong.sum() == (0 if legal else 1)


def test_nothing_is_cut_within_a_guard_band() -> None:
    model = Model(case(LAMP), PROFILES["d3d11"])
    assert recut(model.program, model.own_places) is model.own_places
