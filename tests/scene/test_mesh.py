"""Meshes: what they store, and what they do not accept."""

from __future__ import annotations

import re
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_array_equal

from ibr_ref import Mesh

CORNERS = np.array([(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)], float)
VALUES: dict[str, Any] = {"vertices": CORNERS, "triangles": [(0, 1, 2), (0, 2, 3)]}


def with_nan() -> np.ndarray:
    changed = CORNERS.copy()
    changed[2, 1] = np.nan
    return changed


TABLE = [
    ("vertices.shape", np.zeros((0, 3)), "(0, 3)"),
    ("vertices.shape", np.zeros((4, 2)), "(4, 2)"),
    ("vertices.shape", np.zeros(3), "(3,)"),
    ("vertices.shape", 1.0, "()"),
    ("vertices[2]", with_nan(), "[0.0, nan, 0.0]"),
    ("vertices[0]", CORNERS + np.inf, "[inf, inf, inf]"),
    ("triangles.shape", np.zeros((0, 3), int), "(0, 3)"),
    ("triangles.shape", [(0, 1, 2, 3)], "(1, 4)"),
    ("triangles.shape", [0, 1, 2], "(3,)"),
    ("triangles.dtype", [(0.0, 1.0, 2.0)], "float64"),
    ("triangles.dtype", [(True, False, True)], "bool"),
    ("triangles", [(0, 1, 4)], "4"),
    ("triangles", [(0, 1, -1)], "-1"),
    ("triangles", np.array([(0, 1, 2**63)], np.uint64), "9223372036854775808"),
    ("color.shape", np.zeros(4), "(4,)"),
    ("color.shape", np.zeros((2, 3)), "(2, 3)"),
    ("color.shape", 0.5, "()"),
    ("color", (0.5, 1.5, 0.5), "1.5"),
    ("color", (0.5, -0.5, 0.5), "-0.5"),
    ("color", (0.5, np.nan, 0.5), "nan"),
]


@pytest.mark.parametrize(("field", "value", "found"), TABLE, ids=[f"{field}={found}" for field, _, found in TABLE])
def test_the_error_names_the_field_and_what_was_found(field: str, value: Any, found: str) -> None:
    with pytest.raises(ValueError, match=rf"^{re.escape(field)}.*: found .*allowed: ") as error:
        Mesh(**{**VALUES, re.split(r"[.\[]", field)[0]: value})
    assert found in str(error.value).split("allowed")[0]


@pytest.mark.parametrize("field", ["vertices", "triangles", "color"])
@pytest.mark.parametrize("value", ["abc", [(0, 1, 2), (0, 1)], [("a", 0, 0)], None, [(1j, 0, 0)], object], ids=repr)
def test_what_is_no_array_of_numbers_is_a_value_error_with_the_fields_name(field: str, value: Any) -> None:
    with pytest.raises(ValueError, match=rf"^{field}.*: found .*allowed: "):
        Mesh(**{**VALUES, field: value})


def test_a_mesh_stores_copies_that_cannot_be_changed() -> None:
    vertices = CORNERS.copy()
    mesh = Mesh(vertices=vertices, triangles=VALUES["triangles"], color=(1, 0, 0.5))
    vertices[0] = 7.0
    assert_array_equal(mesh.vertices, CORNERS)
    for array in (mesh.vertices, mesh.triangles, mesh.color):
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 0  # type: ignore[index]


def test_triangles_become_int32_whatever_integers_they_were() -> None:
    for kind in (np.uint8, np.int16, np.uint64, np.int64):
        triangles = Mesh(vertices=CORNERS, triangles=np.array([(0, 1, 3)], kind)).triangles
        assert isinstance(triangles, np.ndarray)
        assert triangles.dtype == np.int32
        assert triangles.tolist() == [[0, 1, 3]]


def test_degenerate_triangles_and_vertices_that_nobody_uses_are_kept() -> None:
    mesh = Mesh(vertices=CORNERS, triangles=[(0, 0, 0), (1, 2, 1)], color=np.zeros((4, 3)))
    assert np.shape(mesh.triangles) == (2, 3)
    assert np.shape(mesh.vertices) == (4, 3)


def test_a_mesh_extends_to_the_corners_of_its_triangles() -> None:
    shades = np.arange(12).reshape(4, 3) / 12
    mesh = Mesh(vertices=CORNERS * 1e300, triangles=[(3, 1, 0), (1, 3, 0)], color=shades)
    assert_array_equal(mesh.corners, 1e300 * CORNERS[[0, 1, 3]])
    assert_array_equal(mesh.bounds, [(0, 0, 0), (1e300, 0, 1e300)])
    compact = mesh.compact()
    assert_array_equal(compact.vertices, mesh.corners)
    assert_array_equal(compact.triangles, [(2, 1, 0), (1, 2, 0)])
    assert_array_equal(compact.color, shades[[0, 1, 3]])
    assert_array_equal(Mesh(**VALUES).compact().color, Mesh.color)
