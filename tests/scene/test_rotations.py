"""Rotations made true, and their quaternions, against SciPy's."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose
from scipy.linalg import polar
from scipy.spatial.transform import Rotation

from ibr_ref.scene.rotations import MOST_DEFECT, nearest_rotation, normalized, quaternion, rotation_of

derandomized = settings(derandomize=True, deadline=None, max_examples=60)
seeds = st.integers(0, 2**32 - 1)


@derandomized
@given(seeds)
def test_the_nearest_rotation_is_the_polar_factor(seed: int) -> None:
    """Up to the largest defect that a measured rotation may have."""
    random = np.random.default_rng(seed)
    stretch = random.uniform(-1.0, 1.0, (3, 3))
    stretch += stretch.T
    stretch *= 0.499 * MOST_DEFECT / np.linalg.norm(stretch)
    rotation = Rotation.from_quat(np.random.default_rng(seed).normal(size=4)).as_matrix()
    noisy = rotation @ (np.eye(3) + stretch)
    defect = np.linalg.norm(noisy.T @ noisy - np.eye(3))
    assert 0.99 * MOST_DEFECT < defect <= MOST_DEFECT
    assert_allclose(nearest_rotation(noisy), rotation, rtol=0, atol=1e-15)
    assert_allclose(nearest_rotation(noisy), polar(noisy)[0], rtol=0, atol=1e-14)


@derandomized
@given(seeds)
def test_a_quaternion_and_back(seed: int) -> None:
    rotation = Rotation.from_quat(np.random.default_rng(seed).normal(size=4))
    q = np.array(normalized(quaternion(rotation.as_matrix())))
    assert_allclose(q * np.sign(q @ rotation.as_quat()), rotation.as_quat(), rtol=0, atol=1e-15)
    assert_allclose(rotation_of((*q.tolist(),)), rotation.as_matrix(), rtol=0, atol=1e-15)


@pytest.mark.parametrize("turn", [0.0, 1e-9, 1.0, np.pi - 1e-9, np.pi])
@pytest.mark.parametrize("axis", [(1, 0, 0), (0, 1, 0), (0, 0, 1), (0.6, 0.0, -0.8)])
def test_turns_about_one_axis(axis: tuple[float, float, float], turn: float) -> None:
    matrix = Rotation.from_rotvec(turn * np.array(axis)).as_matrix()
    assert_allclose(rotation_of(normalized(quaternion(matrix))), matrix, rtol=0, atol=1e-15)
