"""What a camera does not accept: a ValueError that names the field, what was found and what is allowed."""

from __future__ import annotations

import re
from typing import Any

import numpy as np
import pytest

from ibr_ref import Camera

LOOK_AT = {"eye": (1, 2, 3), "target": (0, 0, 0), "up": (0, 0, 1), "vertical_fov": 45.0, "near": 0.1, "far": 100.0,
           "width": 64, "height": 48}  # fmt: skip
ORTHOGRAPHIC = {**LOOK_AT, "view_height": 2.0}
del ORTHOGRAPHIC["vertical_fov"]
CALIBRATED = {"intrinsics": [[50, 0, 32], [0, 50, 24], [0, 0, 1]], "rotation": np.eye(3), "translation": (0, 0, 0),
              "near": 0.1, "far": 100.0, "width": 64, "height": 48}  # fmt: skip
MATRICES = {"view_from_world": np.eye(4), "clip_from_view": Camera.look_at(**LOOK_AT).clip_from_view,
            "near": 0.1, "far": 100.0, "width": 64, "height": 48}  # fmt: skip

POINTS = [
    ((0, 0), "(0, 0)"), ((0, 0, 0, 0), "(0, 0, 0, 0)"), ((0, np.nan, 0), "nan"), ((np.inf, 0, 0), "inf"),
    ("here", "'here'"), (None, "None"), (("a", 0, 0), "'a'"), ([[1, 2, 3]], "[[1, 2, 3]]"),
]  # fmt: skip
SIZES = [(0, "0"), (-5, "-5"), (64.5, "64.5"), (65537, "65537"), (True, "True"), (np.nan, "nan"), (np.inf, "inf"),
         ("64", "'64'"), (None, "None")]  # fmt: skip
NOT_NUMBERS = [(np.nan, "nan"), (np.inf, "inf"), (-np.inf, "-inf"), ("a", "'a'"), (None, "None"), ([1.0, 2.0], "[1.0, 2.0]"),
               (1j, "1j")]  # fmt: skip
PLANES = [
    *(("near", value, found) for value, found in [*NOT_NUMBERS, (0.0, "0.0"), (-1.0, "-1.0")]),
    *(("far", value, found) for value, found in [*NOT_NUMBERS, (0.1, "0.1"), (0.05, "0.05"), (-1.0, "-1.0")]),
]


def rows(make: Any, values: dict[str, Any], table: list[tuple[str, Any, str]]) -> list[Any]:
    return [pytest.param(make, values, *row, id=f"{row[0]}={row[2]}") for row in table]


def each(field: str, table: list[tuple[Any, str]]) -> list[tuple[str, Any, str]]:
    return [(field, value, found) for value, found in table]


SIZE_ROWS = [*each("width", SIZES), *each("height", SIZES)]
LOOK_AT_TABLE = [
    *(row for field in ("eye", "target", "up") for row in each(field, POINTS)),
    ("target", (1, 2, 3), "[1.0, 2.0, 3.0]"),
    ("up", (0, 0, 0), "[0.0, 0.0, 0.0]"),
    ("up", (1, 2, 3), "[1.0, 2.0, 3.0]"),
    ("up", (-2, -4, -6), "[-2.0, -4.0, -6.0]"),
    ("up", (1, 2, 3 + 1e-13), "[1.0, 2.0, 3.0000000000001]"),
    *each("vertical_fov", [*NOT_NUMBERS, (0.0, "0.0"), (-45.0, "-45.0"), (180.0, "180.0"), (270.0, "270.0")]),
    *PLANES,
    *SIZE_ROWS,
]
ORTHOGRAPHIC_TABLE = [
    *(row for field in ("eye", "target", "up") for row in each(field, POINTS[:3])),
    ("target", (1, 2, 3), "[1.0, 2.0, 3.0]"),
    ("up", (1, 2, 3), "[1.0, 2.0, 3.0]"),
    *each("view_height", [*NOT_NUMBERS, (0.0, "0.0"), (-2.0, "-2.0")]),
    *each("near", NOT_NUMBERS),
    *each("far", [*NOT_NUMBERS, (0.1, "0.1"), (-3.0, "-3.0")]),
    *SIZE_ROWS,
]
CALIBRATED_TABLE = [
    ("intrinsics", np.eye(4), "array"),
    ("intrinsics", [[np.nan, 0, 0], [0, 1, 0], [0, 0, 1]], "nan"),
    ("intrinsics", [[0, 0, 32], [0, 50, 24], [0, 0, 1]], "[[0.0, 0.0, 32.0]"),
    ("intrinsics", [[50, 0, 32], [0, 0, 24], [0, 0, 1]], "[0.0, 0.0, 24.0]"),
    ("intrinsics", [[50, 0, 32], [1, 50, 24], [0, 0, 1]], "[1.0, 50.0, 24.0]"),
    ("intrinsics", [[50, 0, 32], [0, 50, 24], [0, 0, 2]], "[0.0, 0.0, 2.0]"),
    ("intrinsics", "K", "'K'"),
    ("rotation", np.diag((1, 1, -1)), "-1.0"),
    ("rotation", 1.01 * np.eye(3), "1.01"),
    ("rotation", np.zeros((3, 3)), "0.0"),
    ("rotation", np.full((3, 3), np.nan), "nan"),
    ("rotation", [1, 2, 3], "[1, 2, 3]"),
    *each("translation", POINTS),
    *PLANES,
    *SIZE_ROWS,
]
MATRICES_TABLE = [
    ("view_from_world", np.eye(3), "array"),
    ("view_from_world", np.diag((1, 1, 0, 1)), "singular"),
    ("view_from_world", np.full((4, 4), np.inf), "inf"),
    ("view_from_world[3]", np.diag((1, 1, 1, 2)), "[0.0, 0.0, 0.0, 2.0]"),
    ("clip_from_view[3]", np.diag((1, 1, 1, 2)), "[0.0, 0.0, 0.0, 2.0]"),
    ("clip_from_view", np.diag((1, 0, 1, 1)), "singular"),
    ("clip_from_view", "P", "'P'"),
    ("eye", (0, 0, 0), "(0, 0, 0)"),
    ("eye[3]", (0, 0, 1, 0), "0.0"),
    *PLANES,
    *SIZE_ROWS,
]


@pytest.mark.parametrize(
    ("make", "values", "field", "value", "found"),
    [
        *rows(Camera.look_at, LOOK_AT, LOOK_AT_TABLE),
        *rows(Camera.orthographic, ORTHOGRAPHIC, ORTHOGRAPHIC_TABLE),
        *rows(Camera.calibrated, CALIBRATED, CALIBRATED_TABLE),
        *rows(Camera, MATRICES, MATRICES_TABLE),
    ],
)
def test_the_error_names_the_field_and_what_was_found(
    make: Any, values: dict[str, Any], field: str, value: Any, found: str
) -> None:
    name = field.split("[")[0]
    with pytest.raises(ValueError, match=rf"(?s)^{re.escape(field)}: found .*allowed: ") as error:
        make(**{**values, name: value})
    assert found in str(error.value).split("allowed")[0]


def test_the_error_for_an_array_is_one_line() -> None:
    """As the command line has it."""
    for values in (
        {"intrinsics": np.eye(4)},
        {"rotation": np.full((3, 3), np.nan)},
        {"translation": np.zeros((99, 99))},
    ):
        with pytest.raises(ValueError, match="allowed") as error:
            Camera.calibrated(**{**CALIBRATED, **values})
        assert "\n" not in str(error.value)


def test_what_is_only_just_allowed_is_accepted() -> None:
    Camera.look_at(**{**LOOK_AT, "vertical_fov": 179.9, "near": 1e-6, "far": 1e6, "width": 1, "height": 65536})
    Camera.look_at(**{**LOOK_AT, "width": 64.0, "height": np.int32(48)})
    Camera.orthographic(**{**ORTHOGRAPHIC, "near": -5.0, "far": -4.0})
    Camera.calibrated(**{**CALIBRATED, "rotation": 1.0001 * np.eye(3)})


@pytest.mark.parametrize("fov", [5e-324, 1e-310, 1e-320])
def test_an_angle_too_small_for_a_projection_is_a_value_error(fov: float) -> None:
    with pytest.raises(ValueError, match="allowed"):
        Camera.look_at(**{**LOOK_AT, "vertical_fov": fov})


@pytest.mark.parametrize("field", ["eye", "target", "up"])
def test_a_vector_whose_length_overflows_is_a_value_error(field: str) -> None:
    """And no warning of NumPy's, which would be an error here."""
    with pytest.raises(ValueError, match="allowed"):
        Camera.look_at(**{**LOOK_AT, field: (0.0, 1e200, 0.0)})
