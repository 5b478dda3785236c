"""The package agrees with the naive twin bit for bit, on 240 drawn sets of reference images."""

from __future__ import annotations

from collections import Counter

import numpy as np
import pytest

from ibr_ref import splatting
from ibr_ref.io import Frame
from ibr_ref.testing.splatting import Drawn as Case
from ibr_ref.testing.splatting import drawn as cases
from tests import drawn
from tests.agreement import arrays_of, check_agreement, check_without_stages
from tests.naive import splatting as twin

SCENES = 240

seen: Counter[str] = Counter()
"""In how many of the drawn scenes each feature occurred; "scenes" counts them all. No scene counts twice."""

frames: set[bytes] = set()


def features(case: Case, frame: Frame) -> set[str]:
    """What the scene holds and what its picture shows."""
    scene, stages = case.scene, frame.stages
    images, height, width = scene.images, *stages["raster.splat"].shape
    masks = [np.asarray(image.mask) for image in images]
    window, widths = stages["vertex.window"], stages["vertex.width"]
    kept = widths > 0.0
    low, high = window - widths[:, None] / 2, window + widths[:, None] / 2
    covered = stages["raster.overdraw"] > 1
    found = {
        "shown": (stages["raster.splat"] >= 0).any(),
        "background": (stages["raster.splat"] < 0).any(),
        "dropped": np.isnan(window).any(),
        "tie": (stages["raster.margin"][covered] == 0.0).any(),
        "no tie": (stages["raster.margin"][covered] > 0.0).any(),
        "overdraw > 8": (stages["raster.overdraw"] > 8).any(),
        "below a pixel": (widths[kept] < 1.0).any(),
        "hundreds of pixels": (widths > 100.0).any(),
        "over the left border": ((low[:, 0] < 0) & (high[:, 0] > 0.5)).any(),
        "over the right border": ((high[:, 0] > width) & (low[:, 0] < width - 0.5)).any(),
        "over the upper border": ((low[:, 1] < 0) & (high[:, 1] > 0.5)).any(),
        "over the lower border": ((high[:, 1] > height) & (low[:, 1] < height - 0.5)).any(),
        "centre outside": (kept & ((window < 0) | (window > [width, height])).any(axis=1)).any(),
        "mask with holes": any(mask.any() and not mask.all() for mask in masks),
        "empty image": any(not mask.any() for mask in masks),
        "one pixel": any(mask.size == 1 for mask in masks),
        "several pages": len(stages["atlas.depth"]) > 1,
        "several images": len(images) > 1,
        "disc": case.params.shape == "disc",
        "orthographic reference": any(not image.camera.perspective for image in images),
        "perspective reference": any(image.camera.perspective for image in images),
        "orthographic view": not scene.camera.perspective,
        "perspective view": scene.camera.perspective,
        "sheared pixels": any(image.camera.intrinsics[0, 1] != 0.0 for image in images),
        "baked": scene.light is None,
        "lamp": scene.light is not None and scene.light.position is not None,
        "direction": scene.light is not None and scene.light.direction is not None,
        "clamped above": (widths[kept] == case.params.max_width).any(),
        "clamped below": (widths[kept] == case.params.min_width).any(),
    }
    return {name for name, there in found.items() if there}


def agree(case: Case) -> None:
    """Compare a drawn scene, and count its features if it is a new one."""
    frame = check_agreement(splatting, twin, case.scene, case.params)
    check_without_stages(splatting, case.scene, case.params, frame)
    frames.add(b"".join(array.tobytes() for array in arrays_of(frame).values()))
    if len(frames) > seen["scenes"]:
        seen.update(["scenes", *features(case, frame)])


def run_scene(number: int) -> None:
    """Compare two drawn scenes."""
    drawn.run_scene(number, cases(), agree)


@pytest.mark.parametrize("number", range(SCENES))
def test_drawn_scene_agrees(number: int, one_thread: None) -> None:
    run_scene(number)


EXPECTED = """
shown | background | dropped | tie | no tie | overdraw > 8 | below a pixel | hundreds of pixels
over the left border | over the right border | over the upper border | over the lower border | centre outside
mask with holes | empty image | one pixel | several pages | several images | disc
orthographic reference | perspective reference | orthographic view | perspective view | sheared pixels
baked | lamp | direction | clamped above | clamped below
"""
"""What must occur in the drawn scenes, each in at least `FEW` of them."""

FEW = 5


def test_drawn_scenes_cover_every_feature(one_thread: None) -> None:
    if not seen:  # this test was chosen alone
        for number in range(SCENES):
            run_scene(number)
    assert seen["scenes"] >= SCENES, "Hypothesis drew some scenes twice"
    names = [name for row in EXPECTED.strip().splitlines() for name in row.split(" | ")]
    rare = {name: seen[name] for name in names if seen[name] < FEW}
    assert not rare, f"of {seen['scenes']} scenes too few show: {rare}"
    assert seen["shown"] >= SCENES / 2
