"""The depth image: what it stores, and what it does not accept (splatting/method.md, "Bad input")."""

from __future__ import annotations

import re
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from numpy.testing import assert_array_equal

from ibr_ref import Camera, DepthImage

COLOR = np.arange(36).reshape(3, 4, 3) / 35.0
DEPTH = np.arange(1.0, 13.0).reshape(3, 4)
MASK = np.array([[1, 1, 0, 0], [1, 0, 1, 0], [0, 0, 0, 1]], bool)
CAMERA = Camera.look_at(eye=(0, 0, 9), target=(0, 0, 0), up=(0, 1, 0), width=4, height=3)
VALUES: dict[str, Any] = {"color": COLOR, "depth": DEPTH, "camera": CAMERA, "mask": MASK}


def with_pixel(image: np.ndarray, where: tuple[int, ...], value: float) -> np.ndarray:
    changed = image.astype(np.float64)
    changed[where] = value
    return changed


def test_without_a_mask_every_pixel_is_a_point() -> None:
    image = DepthImage(color=COLOR, depth=DEPTH, camera=CAMERA)
    color, depth, mask = image.arrays
    assert_array_equal(color, COLOR)
    assert_array_equal(depth, DEPTH)
    assert_array_equal(mask, np.ones((3, 4), bool))
    assert mask.dtype == np.bool_
    assert image.camera is CAMERA


@settings(derandomize=True, deadline=None, max_examples=50)
@given(arrays(bool, (3, 4)), arrays(np.float64, (3, 4), elements=st.floats(allow_nan=True, allow_infinity=True)))
def test_off_the_mask_any_depth_will_do_and_is_stored_as_0(mask: np.ndarray, other: np.ndarray) -> None:
    """An empty mask, too: that no reference has a point is for the renderer to say."""
    image = DepthImage(color=COLOR, depth=np.where(mask, DEPTH, other), camera=CAMERA, mask=mask)
    assert_array_equal(image.depth, np.where(mask, DEPTH, 0.0))
    assert_array_equal(image.mask, mask)


@pytest.mark.parametrize("dtype", [bool, np.uint8, np.int64, np.float32])
def test_masks_of_numbers_0_and_1(dtype: Any) -> None:
    mask = DepthImage(**{**VALUES, "mask": MASK.astype(dtype).tolist()}).arrays[2]
    assert_array_equal(mask, MASK)
    assert mask.dtype == np.bool_


def test_arrays_are_copied_and_read_only() -> None:
    color, depth, mask = COLOR.copy(), DEPTH.copy(), MASK.copy()
    image = DepthImage(color=color, depth=depth, camera=CAMERA, mask=mask)
    color[:], depth[:], mask[:] = 0.0, 0.0, False
    assert_array_equal(image.color, COLOR)
    assert_array_equal(image.depth, np.where(MASK, DEPTH, 0.0))
    assert_array_equal(image.mask, MASK)
    for array in image.arrays:
        with pytest.raises(ValueError, match="read-only"):
            array[0, 0] = 0.5
    with pytest.raises(AttributeError):
        image.depth = DEPTH  # type: ignore[misc]


def test_arrays_of_any_layout_are_stored_row_by_row() -> None:
    depth = np.asfortranarray(DEPTH.astype(np.float32))
    stored = DepthImage(**{**VALUES, "depth": depth, "color": np.asfortranarray(COLOR)})
    for array in stored.arrays:
        assert array.flags.c_contiguous
    assert stored.arrays[1].dtype == np.float64
    DepthImage(**{**VALUES, "depth": DEPTH.astype(int).tolist()})


TABLE = [
    *(
        ("depth", "depth[1, 2]", with_pixel(DEPTH, (1, 2), value), str(value))
        for value in (0.0, -1.0, float("nan"), float("inf"), float("-inf"))
    ),
    *(
        ("depth", "depth.shape", np.ones(shape), str(shape))
        for shape in [(4, 3), (3, 4, 1), (3, 4, 3), (12,), (), (0, 4)]
    ),
    ("depth", "depth", "deep", "str"),
    ("depth", "depth", None, "NoneType"),
    ("depth", "depth", [[1.0], [1.0, 2.0]], "list"),
    ("depth", "depth", DEPTH + 1j, "ndarray"),
    ("depth", "depth", object(), "object"),
    *(
        ("mask", "mask.shape", np.ones(shape, bool), str(shape))
        for shape in [(4, 3), (3, 4, 1), (12,), (), (0, 4)]
    ),
    ("mask", "mask[2, 0]", with_pixel(MASK, (2, 0), 255.0), "255.0"),
    ("mask", "mask[2, 0]", with_pixel(MASK, (2, 0), 0.5), "0.5"),
    ("mask", "mask[2, 0]", with_pixel(MASK, (2, 0), np.nan), "nan"),
    ("mask", "mask[2, 0]", with_pixel(MASK, (2, 0), -1.0), "-1.0"),
    ("mask", "mask.dtype", np.full((3, 4), "yes"), "<U3"),
    ("mask", "mask.dtype", MASK.astype(object), "object"),
    ("mask", "mask.dtype", MASK * 1j, "complex128"),
    ("mask", "mask.shape", "mask", "()"),
    ("mask", "mask", [[True], [True, False]], "list"),
    *(("color", "color.shape", np.zeros(shape), str(shape)) for shape in [(3, 4), (3, 4, 4), (0, 4, 3)]),
    ("color", "color[1, 2, 0]", with_pixel(COLOR, (1, 2, 0), 1.5), "1.5"),
    ("color", "color[1, 2, 0]", with_pixel(COLOR, (1, 2, 0), np.nan), "nan"),
    ("camera", "camera", None, "NoneType"),
    ("camera", "camera", np.eye(4), "ndarray"),
    ("camera", "camera", Camera.look_at(eye=(0, 0, 9), target=(0, 0, 0), up=(0, 1, 0), width=3, height=4), "3 x 4"),
]  # fmt: skip


@pytest.mark.parametrize(("argument", "field", "value", "found"), TABLE, ids=[f"{row[1]}={row[3]}" for row in TABLE])
def test_the_error_names_the_field_and_what_was_found(argument: str, field: str, value: Any, found: str) -> None:
    with pytest.raises(ValueError, match=rf"^{re.escape(field)}: found .*allowed: ") as error:
        DepthImage(**{**VALUES, argument: value})
    assert found in str(error.value).split("allowed")[0]
    assert "\n" not in str(error.value)


def test_sizes_must_be_the_colours() -> None:
    with pytest.raises(ValueError, match=r"^depth\.shape: found \(3, 4\), allowed: \(3, 5\), the size of color"):
        DepthImage(**{**VALUES, "color": np.zeros((3, 5, 3)), "mask": None})
    with pytest.raises(ValueError, match=r"^camera: found 'pictures of 4 x 3', allowed: 5 x 3, the size of color"):
        DepthImage(color=np.zeros((3, 5, 3)), depth=np.ones((3, 5)), camera=CAMERA)


@pytest.mark.parametrize("field", ["color", "depth", "camera"])
def test_a_field_that_is_needed_cannot_be_left_out(field: str) -> None:
    values = {name: value for name, value in VALUES.items() if name != field}
    with pytest.raises(TypeError, match=field):
        DepthImage(**values)


def test_fields_have_names() -> None:
    with pytest.raises(TypeError):
        DepthImage(COLOR, DEPTH, CAMERA)  # type: ignore[misc]


def test_one_pixel() -> None:
    camera = Camera.look_at(eye=(0, 0, 9), target=(0, 0, 0), up=(0, 1, 0), width=1, height=1)
    image = DepthImage(color=[[[0, 0.5, 1]]], depth=[[5e-324]], camera=camera, mask=[[True]])
    assert image.arrays[1][0, 0] == 5e-324
