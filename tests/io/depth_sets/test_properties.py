"""Any camera, said in any convention, sees the same points."""

from __future__ import annotations

import tempfile
from pathlib import Path

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from ibr_ref import io
from ibr_ref.io.depth_sets.conventions import CHOICES
from tests.io.depth_sets import writers
from tests.io.depth_sets.shots import turn

numbers = st.floats(-100, 100)
pinholes = st.tuples(st.floats(5, 500), st.floats(5, 500), st.floats(-20, 40), st.floats(-20, 40))
conventions = st.fixed_dictionaries({name: st.sampled_from(values) for name, values in CHOICES.items()})
axes = st.tuples(numbers, numbers, numbers).filter(lambda axis: np.linalg.norm(axis) > 1)


@settings(max_examples=40, deadline=None)
@given(pinholes, axes, st.floats(-3, 3), st.tuples(numbers, numbers, numbers), conventions, st.integers(0, 2**32 - 1))
def test_points_are_where_they_are_whatever_they_are_said_in(pinhole, axis, angle, center, says, seed):
    f_x, f_y, c_x, c_y = pinhole
    rotation = turn(axis, angle)  # world from camera, OpenCV's axes
    depth = np.random.default_rng(seed).uniform(0.1, 50, (3, 4))
    v, u = np.mgrid[:3, :4] + 0.5
    rays = np.stack([(u - c_x) / f_x, (v - c_y) / f_y, np.ones_like(u)], axis=-1)
    points = (rays * depth[..., None]) @ rotation.T + center

    pose = np.eye(4)
    pose[:3, :3], pose[:3, 3] = rotation, center
    if says["convention"] == "opengl":
        pose = pose @ writers.FLIP
    if says["poses"] == "world_to_camera":
        pose = np.linalg.inv(pose)
    stored = depth * np.linalg.norm(rays, axis=-1) if says["along"] == "ray" else depth
    off = 0.5 if says["pixel_centers"] == "integer" else 0.0
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for inside in ("depth", "poses"):
            (folder / inside).mkdir()
        writers.png(folder / "color" / "a.png", np.zeros((3, 4, 3), np.uint8))
        np.save(folder / "depth" / "a.npy", stored)
        (folder / "poses" / "a.txt").write_text(writers.rows(pose))
        (image,) = io.read_depth_set(folder, intrinsics=(f_x, f_y, c_x - off, c_y - off), **says)
        io.write_depth_set(folder / "again", [image])
        (again,) = io.read_depth_set(folder / "again")
    atol = 1e-11 * (1 + np.abs(points).max())
    assert np.allclose(image.points, points.reshape(-1, 3), rtol=0, atol=atol)
    assert np.allclose(again.points, image.points, rtol=0, atol=atol)
    assert np.array_equal(again.depth, image.depth)
