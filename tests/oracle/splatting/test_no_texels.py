"""A page of an atlas, or a whole image, without a point on it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ibr_ref.oracle import examine
from ibr_ref.scene import DepthImage
from tests.oracle.tiny_cases import TINY, handed_of


def test_an_image_whose_mask_is_empty_is_judged() -> None:
    case = TINY["splatting-dots"]()
    first = case.scene.images[0]
    nothing = DepthImage(
        color=first.color, depth=first.depth, camera=first.camera, mask=np.zeros(np.shape(first.depth), bool)
    )
    scene = replace(case.scene, images=[first, nothing])
    empty = replace(case, scene=scene, inputs={})
    assert examine(empty, handed_of(empty), profile="ieee32").verdict.outcome == "PASS"
