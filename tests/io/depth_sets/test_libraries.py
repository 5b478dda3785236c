"""COLMAP's and Open3D's own readers and writers, where they are installed, beside the package's."""

from __future__ import annotations

import importlib.util
import subprocess
import sys

import numpy as np
import pytest

from ibr_ref import io
from tests.io.depth_sets import shots, writers

FLIP = writers.FLIP


@pytest.mark.parametrize("binary", [True, False])
def test_a_model_as_pycolmap_reads_it(tmp_path, binary):
    pycolmap = pytest.importorskip("pycolmap", reason="COLMAP's own reader, pip install pycolmap, is not installed")
    set_ = io.read_depth_set(writers.colmap(tmp_path, shots.shots(), binary))
    theirs = {image.name: image for image in pycolmap.Reconstruction(tmp_path / "sparse").images.values()}
    assert set(theirs) == set(set_.names)
    for name, camera in zip(set_.names, set_.cameras, strict=True):
        image = theirs[name]
        pose = np.vstack([image.cam_from_world().matrix(), [0, 0, 0, 1]])
        assert np.allclose(FLIP @ camera.view_from_world, pose, rtol=0, atol=1e-12)
        assert np.allclose(camera.intrinsics, image.camera.calibration_matrix(), rtol=1e-12)
        point = np.array([0.1, 0.2, 4.0])
        x, y, _, w = camera.clip_from_world @ [*point, 1.0]
        window = (x / w + 1) / 2 * camera.width, (1 - y / w) / 2 * camera.height
        assert np.allclose(window, image.camera.img_from_cam(pose[:3] @ [*point, 1.0]), rtol=0, atol=1e-9)


@pytest.mark.parametrize("write", ["write_binary", "write_text"])
def test_a_model_as_pycolmap_writes_it(tmp_path, write):
    pycolmap = pytest.importorskip("pycolmap", reason="COLMAP's own reader, pip install pycolmap, is not installed")
    seen = shots.shots()
    writers.colmap(tmp_path, seen, binary=write == "write_text")
    model = pycolmap.Reconstruction(tmp_path / "sparse")
    for path in (tmp_path / "sparse").iterdir():
        path.unlink()
    getattr(model, write)(tmp_path / "sparse")
    for image, shot in zip(io.read_depth_set(tmp_path), seen, strict=True):
        assert np.abs(image.points - shot.points[shot.valid]).max() < 1e-6


OPEN3D = """
import sys
import numpy as np
import open3d
folder = sys.argv[1]
intrinsic = open3d.io.read_pinhole_camera_intrinsic(f"{folder}/camera_intrinsic.json")
trajectory = open3d.io.read_pinhole_camera_trajectory(f"{folder}/trajectory.log")
clouds = [open3d.io.read_point_cloud(f"{folder}/cloud.ply")]
for i, camera in enumerate(trajectory.parameters):
    color, depth = (open3d.io.read_image(f"{folder}/{name}/{i:05d}.png") for name in ("color", "depth"))
    pair = open3d.geometry.RGBDImage.create_from_color_and_depth(
        color, depth, depth_trunc=100.0, convert_rgb_to_intensity=False
    )
    clouds.append(open3d.geometry.PointCloud.create_from_rgbd_image(pair, intrinsic, camera.extrinsic))
arrays = {f"{kind}{i}": np.asarray(getattr(cloud, kind)) for i, cloud in enumerate(clouds) for kind in ("points", "colors")}
np.savez(f"{folder}/open3d.npz", **arrays)
"""
"""In a process of its own: it loads another version of the library that Numba's threads may come from."""


def test_pictures_and_points_as_open3d_reads_them(tmp_path):
    if importlib.util.find_spec("open3d") is None:
        pytest.skip("Open3D, pip install open3d-cpu, is not installed")
    set_ = io.read_depth_set(writers.open3d(tmp_path, shots.shots(hole=False)))
    io.write_point_cloud(tmp_path / "cloud.ply", set_[:1])
    subprocess.run([sys.executable, "-c", OPEN3D, tmp_path], check=True, timeout=120, capture_output=True)
    with np.load(tmp_path / "open3d.npz") as theirs:
        assert np.array_equal(theirs["points0"], set_[0].points)
        for i, image in enumerate([set_[0], *set_]):
            assert np.allclose(theirs[f"points{i}"], image.points, rtol=0, atol=1e-5)
            assert np.allclose(theirs[f"colors{i}"], image.color[image.mask], rtol=0, atol=1e-6)
