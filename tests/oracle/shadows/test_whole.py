"""A ground that passes behind the eye, set up from its own corners, as SwiftShader does: where it is allowed, right."""

from __future__ import annotations

import numpy as np
import pytest

from tests.oracle.judgements import complaints
from tests.oracle.shadows.judged import case, plain, stages

NAME = "shadows-beyond"
STEP = 16.0
"""Subpixels a pixel."""


def ground_depths(shape: tuple[int, int]) -> list[np.ndarray]:
    """(H, W) window depths of the ground's two triangles, everywhere: planes through their snapped corners, in float32."""
    camera, ground = case(NAME).scene.camera, case(NAME).scene.receivers[0]
    corners = np.column_stack([ground.vertices, np.ones(len(ground.vertices))]) @ camera.clip_from_world.T
    height, width = shape
    found = []
    for x, y, z, w in (corners[triangle].T for triangle in ground.triangles):
        places = ((x / w + 1.0) * width / 2.0, (1.0 - y / w) * height / 2.0)
        x, y = (np.rint(place.astype(np.float32) * STEP) / STEP for place in places)
        plane = np.linalg.solve(np.stack([x, y, np.ones(3)], axis=1), z / w)
        rows, columns = np.mgrid[:height, :width] + 0.5
        found.append((plane[0] * columns + plane[1] * rows + plane[2]).astype(np.float32))
    return found


def drawn() -> dict[str, np.ndarray]:
    """The plain port's arrays with such depths of the ground, triangle by triangle."""
    arrays = dict(plain(NAME))
    depth = np.array(arrays["depth"])
    for theirs in ground_depths(depth.shape):
        near = np.abs(theirs - arrays["depth"]) < 1e-3
        depth[near] = theirs[near]
    assert np.abs(depth - arrays["depth"]).max() > 4e-4, "no corner behind the eye shows"
    return arrays | {"depth": depth}


@pytest.mark.parametrize("device", ["gl,subpixel_bits=4", "vulkan,subpixel_bits=4"])
def test_it_is_right(device: str) -> None:
    assert complaints(stages(NAME, drawn(), device)[:2]) == []


def test_it_is_wrong_where_planes_are_those_of_the_clipped_polygon() -> None:
    assert complaints(stages(NAME, drawn(), "gl,subpixel_bits=4,setup=clipped")[:2])
