"""The light: one of position and direction, and what it does not accept."""

from __future__ import annotations

import re
from typing import Any

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose

from ibr_ref import Light

NOT_NUMBERS = [(np.nan, "nan"), (np.inf, "inf"), ("a", "'a'"), (None, "None"), ([0.5, 0.5], "[0.5, 0.5]"), (1j, "1j")]
NOT_VECTORS = [((0, 1), "(0, 1)"), ((0, np.nan, 1), "nan"), ((0, -np.inf, 1), "-inf"), ("up", "'up'"), (5.0, "5.0"),
               ((0, "a", 0), "'a'")]  # fmt: skip

TABLE = [
    *(("position", value, found) for value, found in NOT_VECTORS),
    *(("direction", value, found) for value, found in NOT_VECTORS),
    ("direction", (0, 0, 0), "[0.0, 0.0, 0.0]"),
    *(
        (field, value, found)
        for field in ("ambient", "diffuse", "specular")
        for value, found in [*NOT_NUMBERS, (-0.1, "-0.1")]
    ),
    *(
        ("exponent", value, found)
        for value, found in [
            *NOT_NUMBERS,
            (-1, "-1"),
            (2.5, "2.5"),
            (True, "True"),
            (2**20 + 1, "1048577"),
            ("8", "'8'"),
        ]
    ),
]


@pytest.mark.parametrize(("field", "value", "found"), TABLE, ids=[f"{field}={found}" for field, _, found in TABLE])
def test_the_error_names_the_field_and_what_was_found(field: str, value: Any, found: str) -> None:
    given_: dict[str, Any] = {} if field in ("position", "direction") else {"direction": (0, 0, 1)}
    with pytest.raises(ValueError, match=rf"^{field}: found {re.escape(found)}|^{field}: found .*allowed: ") as error:
        Light(**given_, **{field: value})
    assert found in str(error.value).split("allowed")[0]


def test_neither_or_both_of_position_and_direction_are_rejected() -> None:
    with pytest.raises(ValueError, match=r"neither of position and direction.*exactly one"):
        Light()
    with pytest.raises(ValueError, match=r"both of position and direction.*exactly one"):
        Light(position=(0, 0, 1), direction=(0, 0, 1))


def test_a_point_light_is_its_position_and_a_one() -> None:
    assert Light(position=(1, 2, -3)).homogeneous.tolist() == [1.0, 2.0, -3.0, 1.0]


lengths = st.floats(1e-100, 1e100)
components = st.floats(-1.0, 1.0)


@settings(derandomize=True, deadline=None, max_examples=50)
@given(st.tuples(components, components, components), lengths)
def test_a_direction_is_normalized_whatever_its_length(direction: tuple[float, float, float], length: float) -> None:
    """Three squares, two sums, a root and a division: 4 ulp."""
    assume(max(abs(x) for x in direction) > 0.01)
    found = Light(direction=length * np.array(direction)).homogeneous
    assert found[3] == 0.0
    assert_allclose(found[:3], np.array(direction) / np.linalg.norm(direction), rtol=4 * 2.0**-52, atol=1e-18)


@pytest.mark.parametrize("length", [1e-200, 1e-320, 1e200])
def test_a_direction_whose_square_leaves_float64_is_rejected_or_normalized(length: float) -> None:
    """A light with NaN or infinity in it must not come into being."""
    try:
        light = Light(direction=(0, 0, length))
    except ValueError as error:
        assert "direction" in str(error)  # noqa: PT017
    else:
        assert light.homogeneous.tolist() == [0.0, 0.0, 1.0, 0.0]


def test_numbers_are_stored_as_numbers() -> None:
    light = Light(direction=[0, 0, 2], ambient=np.float32(0.5), diffuse=1, specular=0, exponent=np.int64(8))
    assert (light.ambient, light.diffuse, light.specular, light.exponent) == (0.5, 1.0, 0.0, 8)
    assert isinstance(light.exponent, int)
    with pytest.raises(AttributeError):
        light.ambient = 1.0  # type: ignore[misc]
