"""The base polygon: what it stores, and what it does not accept (displacement/method.md, "Bad input")."""

from __future__ import annotations

import re
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_array_equal

from ibr_ref import BasePolygon

GRAY = np.full((3, 4), 0.5)
COLORS = np.full((2, 5, 3), 0.5)
VALUES: dict[str, Any] = {"corner": (0, 0, 0), "edge_u": (2, 0, 0), "edge_v": (0, 3, 0), "height_map": GRAY,
                          "color_map": COLORS, "height_scale": 0.25}  # fmt: skip

NOT_NUMBERS = [(np.nan, "nan"), (np.inf, "inf"), ("a", "'a'"), (None, "None"), ([0.5, 0.5], "[0.5, 0.5]"), (1j, "1j")]
NOT_VECTORS = [((0, 1), "(0, 1)"), ((0, np.nan, 1), "nan"), ((0, -np.inf, 1), "-inf"), ("up", "'up'"), (None, "None")]
NOT_MAPS = [("a map", "'a map'"), (None, "NoneType"), (object(), "object"), ([[1, 0], [1]], "[[1, 0], [1]]")]


def with_texel(image: np.ndarray, where: tuple[int, ...], value: float) -> np.ndarray:
    changed = image.copy()
    changed[where] = value
    return changed


BAD_TEXELS = [(1.5, "1.5"), (-0.25, "-0.25"), (np.nextafter(1, 2), "1.0000000000000002"), (255.0, "255.0"), (np.nan, "nan"),
              (np.inf, "inf"), (-np.inf, "-inf")]  # fmt: skip

TABLE = [
    *((field, field, *row) for field in ("corner", "edge_u", "edge_v") for row in NOT_VECTORS),
    *(("height_map", "height_map[1, 3]", with_texel(GRAY, (1, 3), value), found) for value, found in BAD_TEXELS),
    *(
        (field, f"{field}[1, 4, 2]", with_texel(COLORS, (1, 4, 2), value), found)
        for field in ("color_map", "normal_map", "facade_map")
        for value, found in BAD_TEXELS
    ),
    *(
        ("height_map", "height_map.shape", np.zeros(shape), str(shape))
        for shape in [(0, 4), (4, 0), (0,), (5,), (2, 2, 1), (2, 2, 3), ()]
    ),
    *(
        (field, f"{field}.shape", np.zeros(shape), str(shape))
        for field in ("color_map", "normal_map", "facade_map")
        for shape in [(0, 4, 3), (4, 0, 3), (4, 4), (4, 4, 1), (4, 4, 4), (3,), ()]
    ),
    *(("height_map", "height_map", *row) for row in NOT_MAPS if row[0] is not None),
    *(("color_map", "color_map", *row) for row in NOT_MAPS if row[0] is not None),
    ("edge_v", "edge_v", (4, 0, 0), "[4.0, 0.0, 0.0]"),
    ("edge_v", "edge_v", (-1, 0, 0), "[-1.0, 0.0, 0.0]"),
    ("edge_v", "edge_v", (0, 0, 0), "[0.0, 0.0, 0.0]"),
    ("edge_v", "edge_v", (1, 1e-14, 0), "[1.0, 1e-14, 0.0]"),
    *(("height_scale", "height_scale", *row) for row in [*NOT_NUMBERS, (0.0, "0.0"), (-0.0, "-0.0"), (-0.5, "-0.5")]),
    ("height_scale", "height_scale", 1e-200, "1e-200"),
    ("height_scale", "height_scale", 1e200, "1e+200"),
    ("facade_tile", "facade_tile", (1, 0), "[1.0, 0.0]"),
    ("facade_tile", "facade_tile", (-1, 1), "[-1.0, 1.0]"),
    ("facade_tile", "facade_tile", (1, 1, 1), "(1, 1, 1)"),
    ("facade_tile", "facade_tile", (1, np.nan), "nan"),
    ("facade_tile", "facade_tile", 0.5, "0.5"),
    *(
        ("domain", "domain", *row)
        for row in [("wrap", "'wrap'"), ("", "''"), ("Clip", "'Clip'"), (None, "None"), (1, "1")]
    ),
]


@pytest.mark.parametrize(("argument", "field", "value", "found"), TABLE, ids=[f"{row[1]}={row[3]}" for row in TABLE])
def test_the_error_names_the_field_and_what_was_found(argument: str, field: str, value: Any, found: str) -> None:
    with pytest.raises(ValueError, match=rf"(?s)^{re.escape(field)}: found .*allowed: ") as error:
        BasePolygon(**{**VALUES, argument: value})
    assert found in str(error.value).split("allowed")[0]


@pytest.mark.parametrize("field", ["height_map", "color_map"])
def test_a_map_that_is_needed_cannot_be_left_out(field: str) -> None:
    with pytest.raises(ValueError, match=rf"^{field}"):
        BasePolygon(**{**VALUES, field: None})


def test_the_whole_range_is_accepted() -> None:
    """0 and 1 themselves; one texel; edges at an angle of one in a million; 8-bit and boolean maps of 0 and 1."""
    for heights in (
        np.zeros((1, 1)),
        np.ones((1, 1)),
        [[0, 1], [1, 0]],
        np.eye(3, dtype=np.uint8),
        np.eye(3, dtype=bool),
    ):
        BasePolygon(**{**VALUES, "height_map": heights})
    BasePolygon(**{**VALUES, "edge_v": (1, 1e-6, 0)})
    BasePolygon(**{**VALUES, "normal_map": COLORS, "facade_map": COLORS, "facade_tile": [2, 1], "domain": "repeat"})


def test_maps_are_copied_and_read_only() -> None:
    heights = GRAY.copy()
    polygon = BasePolygon(**{**VALUES, "height_map": heights})
    heights[0, 0] = 7.0
    assert_array_equal(polygon.height_map, GRAY)
    with pytest.raises(ValueError, match="read-only"):
        polygon.height_map[0, 0] = 0.0  # type: ignore[index]
    with pytest.raises(AttributeError):
        polygon.height_scale = 1.0  # type: ignore[misc]


def test_maps_of_any_layout_are_stored_row_by_row() -> None:
    heights = np.asfortranarray(np.random.RandomState(0).uniform(0, 1, (8, 6)).astype(np.float32))[::2, ::-1]
    stored = BasePolygon(**{**VALUES, "height_map": heights}).height_map
    assert isinstance(stored, np.ndarray)
    assert stored.flags.c_contiguous
    assert stored.dtype == np.float64
    assert_array_equal(stored, heights)


def test_arrays_are_corner_and_edges() -> None:
    corner, edge_u, edge_v = BasePolygon(**VALUES).arrays
    assert corner.tolist() == [0.0, 0.0, 0.0]
    assert edge_u.tolist() == [2.0, 0.0, 0.0]
    assert edge_v.tolist() == [0.0, 3.0, 0.0]
