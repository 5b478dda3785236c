"""The package agrees with the naive twin bit for bit: on drawn scenes, and on the chair."""

from __future__ import annotations

from collections import Counter

import numpy as np
import pytest

from ibr_ref import models
from ibr_ref.io import Frame
from ibr_ref.shadows import Params, prepare
from ibr_ref.testing.shadows import Drawn as Case
from ibr_ref.testing.shadows import drawn as cases
from tests import drawn
from tests.shadows.twin import check_agreement

SCENES = 120

seen: Counter[str] = Counter()
"""In how many of the drawn scenes each feature occurred."""


def agree(case: Case) -> None:
    """Render a drawn scene with the package and with the twin, and remember what occurred in it."""
    frame = check_agreement(case.scene, case.params, case.controls)
    seen.update(["scenes", *features(case, frame)])


def features(case: Case, frame: Frame) -> set[str]:
    """What occurs in a scene that a test of agreement must have seen."""
    params, stages = case.params, frame.stages
    shadow, coord = np.asarray(stages["accumulate.shadow"]), np.asarray(stages["project.coord"])
    texel_margin = np.asarray(stages["project.texel_margin"])
    surface = np.broadcast_to(frame.depth < 1.0, texel_margin.shape)
    count = len(params.light_samples) if isinstance(params.light_samples, np.ndarray) else params.light_samples
    return {
        f"method {params.method}",
        f"content {params.content}",
        f"policy {params.policy}",
        f"interpolation {params.interpolation} {params.policy}",
        f"samples {count}",
        f"accumulation {params.accumulation}",
        f"quantize {params.quantize} {params.content}",
        f"pcf {params.pcf} {params.content}",
        f"map samples {params.map_samples}",
        f"mix {params.grid_mix} {params.method}",
        *(["shadow"] if (shadow > 0.0).any() else []),
        *(["half shadow"] if ((shadow > 0.1) & (shadow < 0.9)).any() else []),
        *(["beside the map"] if (np.abs(coord[..., :2] - 0.5).max() > 0.5) else []),
        *(["behind the light"] if (np.isinf(texel_margin) & surface).any() else []),
        *(["beyond the far plane"] if (coord[..., 2] == 1.0).any() else []),
        *(["on a middle line"] if "warp.fraction" in stages and (stages["warp.fraction"] == 0.0).any() else []),
        *(["at the end"] if "warp.fraction" in stages and (stages["warp.fraction"] == 1.0).any() else []),
    }


def run_scene(number: int) -> None:
    """Compare two drawn scenes."""
    drawn.run_scene(number, cases(), agree)


@pytest.mark.parametrize("number", range(SCENES))
def test_drawn_scene_agrees(number: int, one_thread: None) -> None:
    run_scene(number)


EXPECTED = """
interpolation linear dissolve | interpolation linear nearest
interpolation projective dissolve | interpolation projective nearest
method warp | method direct | method grid | content mask | content depth | policy dissolve | policy nearest
samples 1 | samples 2 | samples 3 | samples 4 | samples 5 | samples 9 | accumulation float | accumulation unorm8
quantize None mask | quantize 8 mask | quantize None depth | quantize 8 depth | pcf True depth | pcf False depth
map samples 1 | map samples 2 | map samples 3 | mix True grid | mix False grid | shadow | half shadow
beside the map | behind the light | beyond the far plane | on a middle line | at the end
"""
"""What must occur in the drawn scenes, each in at least three of them."""


def test_drawn_scenes_cover_every_feature(one_thread: None) -> None:
    if not seen:  # this test was chosen alone
        for number in range(SCENES):
            run_scene(number)
    expected = [name for row in EXPECTED.strip().splitlines() for name in row.split(" | ")]
    rare = {name: seen[name] for name in expected if seen[name] < 3}
    assert not rare, f"of {seen['scenes']} scenes too few show: {rare}"


@pytest.mark.sampled(3)
@pytest.mark.parametrize("content", ["mask", "depth"])
@pytest.mark.parametrize(
    "method",
    [{"policy": "dissolve"}, {"policy": "nearest"}, {"method": "direct"}],
    ids=lambda method: next(iter(method.values())),
)
def test_chair_agrees(method: dict[str, str], content: str, one_thread: None) -> None:
    """1,464 triangles, many of them smaller than a texel, over a floor with steps; the controls follow its silhouette."""
    scene = models.shadow_stage(models.chair(), offset=(0.31, -0.24), width=40, height=30)
    params = Params(map_size=48, content=content, light_samples=5, **method)
    frame = check_agreement(scene, params, prepare(scene, params, controls="fast").controls)
    shadow = frame.stages["accumulate.shadow"]
    assert (shadow > 0.9).any()
    assert ((shadow > 0.0) & (shadow < 0.9)).any()
