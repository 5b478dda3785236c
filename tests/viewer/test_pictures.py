"""Arrays as pictures."""

from __future__ import annotations

import numpy as np

from ibr_ref.displacement.contract import STAGES
from ibr_ref.viewer.pictures import picture, planes


def test_numbers_run_from_violet_to_yellow_and_nothing_is_grey() -> None:
    index = np.array([[-1, 0, 5, 10, 10]], np.int32)
    found = picture("march.hit_index", index, STAGES)
    assert found.pixels[0, :, :3].tolist()[0] == [96, 96, 104]
    assert found.pixels[0, 1, :3].tolist() == [68, 1, 84]
    assert found.pixels[0, 3, :3].tolist() == [253, 231, 37]
    assert "0 to yellow 10" in found.legend


def test_unit_vectors_are_shown_from_minus_one_to_one() -> None:
    normals = np.full((1, 3, 3), np.nan)
    normals[0, 0], normals[0, 1] = (0, 0, 1), (-1, 0, 0)
    pixels = picture("shade.normal", normals, STAGES).pixels
    assert pixels[0, :, :3].tolist() == [[128, 128, 255], [0, 128, 128], [96, 96, 104]]


def test_an_array_without_a_number_in_it() -> None:
    assert (picture("march.hit", np.full((2, 5, 3), np.nan), STAGES).pixels[..., :3].max(axis=-1) <= 104).all()
    assert picture("march.margin", np.full((2, 5), np.inf), STAGES).pixels.shape == (2, 5, 4)
    assert (picture("march.steep", np.zeros((2, 5), bool), STAGES).pixels[..., 3] == 255).all()


def test_what_of_the_stages_is_a_picture() -> None:
    arrays = {
        "vertex.clip": np.zeros((20, 4)),
        "color": np.zeros((6, 8, 3)),
        "maps.image": np.zeros((9, 6, 6), np.uint8),
        "atlas.depth": (np.zeros((6, 6)), np.zeros((6, 9, 3))),
        "warp.image": np.zeros((100, 6, 6)),
    }
    names = [name for name, _ in planes(arrays)]
    assert names == ["color", *(f"maps.image[{i}]" for i in range(9)), "atlas.depth.0", "atlas.depth.1"]
