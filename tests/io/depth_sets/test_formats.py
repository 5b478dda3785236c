"""Depth sets of every format, made by formula: the points that are read lie where the formula has them."""

from __future__ import annotations

import json

import numpy as np
import pytest

from ibr_ref import io
from tests.io import exr_writer, tiff_writer
from tests.io.depth_sets import shots, writers


def check(set_, seen, unit):
    """Masks, points to `unit` of depth, and their colours; and that `points` is what the cameras say."""
    assert len(set_) == len(seen)
    for image, shot in zip(set_, seen, strict=True):
        assert np.array_equal(image.mask, shot.valid)
        assert 0.3 < image.mask.mean() < 1
        found = image.points
        off = np.linalg.norm(found - shot.points[shot.valid], axis=1)
        assert off.max() <= 2 * unit, off.max()
        assert np.array_equal(np.rint(image.color * 255), shot.color)
        homogeneous = np.append(found, np.ones((len(found), 1)), axis=1) @ image.camera.clip_from_world.T
        x, y = homogeneous[:, 0] / homogeneous[:, 3], homogeneous[:, 1] / homogeneous[:, 3]
        rows, columns = np.nonzero(image.mask)
        assert np.allclose((x + 1) / 2 * image.camera.width, columns + 0.5, rtol=0, atol=1e-9)
        assert np.allclose((1 - y) / 2 * image.camera.height, rows + 0.5, rtol=0, atol=1e-9)
        assert 0 < image.camera.near < image.depth[image.mask].min()
        assert image.depth[image.mask].max() < image.camera.far


def test_the_formula_is_on_the_surface():
    for shot in shots.shots():
        assert shots.on_surface(shot.points[shot.valid]).max() < 1e-12
        ball = np.linalg.norm(shot.points - shots.BALL, axis=-1) < shots.RADIUS + 1e-9
        assert 0.05 < ball.mean() < 0.5


def test_open3d(tmp_path):
    seen = shots.shots()
    set_ = io.read_depth_set(writers.open3d(tmp_path, seen))
    check(set_, seen, 0.001)
    assert set_.names == ("00000.png", "00001.png", "00002.png")


def test_open3d_with_its_own_scale(tmp_path):
    seen = shots.shots(1)
    check(io.read_depth_set(writers.open3d(tmp_path, seen, scale=1 / 4000, depth_scale=4000)), seen, 1 / 4000)


def test_open3d_with_intrinsics_given(tmp_path):
    seen = shots.shots(1)
    (writers.open3d(tmp_path, seen) / "camera_intrinsic.json").unlink()
    with pytest.raises(ValueError, match="intrinsic"):
        io.read_depth_set(tmp_path)
    check(io.read_depth_set(tmp_path, intrinsics=writers.tum_intrinsics(shots.K)), seen, 0.001)


def test_tum(tmp_path):
    seen = shots.shots()
    set_ = io.read_depth_set(writers.tum(tmp_path, seen), intrinsics=writers.tum_intrinsics(shots.K))
    check(set_, seen, 1 / 5000)
    assert set_.names[0] == "rgb/1305031102.000000.png"


def test_tum_with_a_calibration_file(tmp_path):
    seen = shots.shots(2)
    writers.tum(tmp_path, seen)
    (tmp_path / "calibration.txt").write_text(" ".join(map(repr, map(float, writers.tum_intrinsics(shots.K)))))
    check(io.read_depth_set(tmp_path), seen, 1 / 5000)
    (tmp_path / "calibration.txt").write_text("22 23 8.8 6.9 0.1 0 0 0 0")
    with pytest.raises(ValueError, match=r"calibration.txt: found .*0\.1.*no distortion"):
        io.read_depth_set(tmp_path)


def test_tum_pairs_the_nearest_in_time(tmp_path):
    """As the data set's own tool does, by all pairs: here every pair is looked at."""
    from ibr_ref.io.depth_sets import tum

    chance = np.random.default_rng(3)
    for _ in range(30):
        first, second = (np.sort(chance.uniform(0, 1, 12)) for _ in range(2))
        stamped = [tum._Stamped(times, [[]] * 12, list(range(12))) for times in (first, second)]
        pairs = sorted((abs(a - b), i, j) for i, a in enumerate(first) for j, b in enumerate(second))
        expected, used = [], (set(), set())
        for apart, i, j in pairs:
            if apart <= 0.05 and i not in used[0] and j not in used[1]:
                used[0].add(i)
                used[1].add(j)
                expected.append((i, j))
        assert sorted(tum._associated(*stamped, 0.05)) == sorted(expected)


def test_tum_leaves_out_what_is_too_far_in_time(tmp_path):
    seen = shots.shots(2)
    writers.tum(tmp_path, seen, late=0.03)
    k = writers.tum_intrinsics(shots.K)
    with pytest.raises(ValueError, match=r"max_time_gap = 0\.02"):
        io.read_depth_set(tmp_path, intrinsics=k)
    check(io.read_depth_set(tmp_path, intrinsics=k, max_time_gap=0.04), seen, 1 / 5000)


def test_scannet(tmp_path):
    seen = shots.shots()
    check(io.read_depth_set(writers.scannet(tmp_path, seen)), seen, 0.001)


def test_scannet_with_pictures_of_another_size(tmp_path):
    """Colours are those of the world's point where both cameras see it: the bytes vary slowly, by formula."""
    seen = shots.shots(2, hole=False)
    k = shots.K * np.array([[3.1], [3.1], [1.0]]) + np.array([[0, 0, 0.4], [0, 0, -0.3], [0, 0, 0]])
    large = [shots.shot(s.rotation, s.center, k, 62, 44, hole=False) for s in seen]
    set_ = io.read_depth_set(writers.scannet(tmp_path, seen, large))
    for image, shot in zip(set_, seen, strict=True):
        assert np.linalg.norm(image.points - shot.points[image.mask], axis=1).max() < 0.002
        off = np.abs(image.color * 255 - shot.color).max(axis=2)[image.mask]
        assert np.quantile(off, 0.8) < 3
        assert np.median(off) < 1.5


def test_scannet_leaves_out_lost_cameras(tmp_path):
    seen = shots.shots()
    writers.scannet(tmp_path, seen)
    (tmp_path / "pose" / "1.txt").write_text("-inf -inf -inf -inf\n" * 3 + "0 0 0 1\n")
    check(io.read_depth_set(tmp_path), [seen[0], seen[2]], 0.001)
    (tmp_path / "pose" / "1.txt").write_text("1 0 0 -inf\n0 1 0 0\n0 0 1 0\n0 0 0 1\n")
    with pytest.raises(ValueError, match=r"1\.txt: pose: .*finite"):
        io.read_depth_set(tmp_path)


@pytest.mark.parametrize("per_frame", [True, False])
def test_transforms_of_instant_ngp(tmp_path, per_frame):
    seen = shots.shots()
    check(io.read_depth_set(writers.transforms(tmp_path, seen, per_frame=per_frame)), seen, 0.001)


def test_transforms_of_nerfstudio(tmp_path):
    """The file does not say what a stored unit is."""
    seen = shots.shots()
    writers.transforms(tmp_path, seen, ngp=False)
    with pytest.raises(ValueError, match=r"0\.png: depth_scale: found None .* allowed: a number > 0"):
        io.read_depth_set(tmp_path)
    check(io.read_depth_set(tmp_path, depth_scale=0.001), seen, 0.001)


def test_transforms_with_a_unit(tmp_path):
    """As files of some nerfstudio parsers say it, of all depths."""
    seen = shots.shots()
    writers.transforms(tmp_path, seen, ngp=False)
    tree = json.loads((tmp_path / "transforms.json").read_text())
    (tmp_path / "transforms.json").write_text(
        json.dumps(tree | {"depth_unit_scale_factor": 0.001, "is_fisheye": False})
    )
    check(io.read_depth_set(tmp_path), seen, 0.001)


def test_transforms_with_angles(tmp_path):
    seen = [shots.shot(np.eye(3), np.zeros(3), np.array([[22.0, 0, 10], [0, 23.0, 7], [0, 0, 1]]))]
    writers.transforms(tmp_path, seen)
    tree = json.loads((tmp_path / "transforms.json").read_text())
    for name in ("fl_x", "fl_y", "cx", "cy"):
        del tree["frames"][0][name]
    tree["camera_angle_x"], tree["camera_angle_y"] = 2 * np.arctan(10 / 22), 2 * np.arctan(7 / 23)
    (tmp_path / "transforms.json").write_text(json.dumps(tree))
    check(io.read_depth_set(tmp_path), seen, 0.001)


def test_transforms_that_were_scaled(tmp_path):
    """nerfstudio scales the poses before it writes them; the depths are as they were."""
    seen = shots.shots()
    writers.transforms(tmp_path, seen)
    tree = json.loads((tmp_path / "transforms.json").read_text())
    tree["applied_scale"] = 0.5
    for frame in tree["frames"]:
        for row in frame["transform_matrix"][:3]:
            row[3] *= 0.5
    (tmp_path / "transforms.json").write_text(json.dumps(tree))
    for image, shot in zip(io.read_depth_set(tmp_path), seen, strict=True):
        assert np.allclose(image.points, 0.5 * shot.points[shot.valid], rtol=0, atol=0.001)


def test_transforms_with_smaller_depth_maps(tmp_path):
    """As phones take them: the colours are looked up where the depths are."""
    seen = [shots.shot(np.eye(3), np.zeros(3), hole=False)]
    k = shots.K * np.array([[4.0], [4.0], [1.0]])
    large = [shots.shot(np.eye(3), np.zeros(3), k, 80, 56, hole=False)]
    writers.transforms(tmp_path, large)
    writers.png(tmp_path / "depths" / "0.png", writers.codes(seen[0], 0.001), 16)
    (image,) = io.read_depth_set(tmp_path)
    assert np.allclose(image.camera.intrinsics, shots.K, rtol=0, atol=1e-12)
    assert np.linalg.norm(image.points - seen[0].points.reshape(-1, 3), axis=1).max() < 0.002
    assert np.median(np.abs(image.color * 255 - seen[0].color)) < 1.5


@pytest.mark.parametrize("binary", [True, False])
@pytest.mark.parametrize("place", ["", "sparse", "sparse/0"])
def test_colmap(tmp_path, binary, place):
    seen = shots.shots()
    set_ = io.read_depth_set(writers.colmap(tmp_path / "dense", seen, binary, place))
    check(set_, seen, 1e-6)
    assert set_.names == ("cam/0.png", "cam/1.png", "cam/2.png")


def test_colmap_with_photometric_maps_and_another_camera(tmp_path):
    seen = shots.shots(k=np.array([[22.0, 0, 9.3], [0, 22.0, 7.4], [0, 0, 1]]))
    writers.colmap(tmp_path / "dense", seen, model="SIMPLE_RADIAL", kind="photometric")
    check(io.read_depth_set(tmp_path / "dense"), seen, 1e-6)


def pair():
    right = np.array([[22.0, 0, 11.1], [0, 22.0, 7.4], [0, 0, 1]])
    left = right - [[0, 0, 1.8], [0, 0, 0], [0, 0, 0]]
    return [shots.shot(np.eye(3), np.zeros(3), left), shots.shot(np.eye(3), np.array([0.3, 0.0, 0.0]), right)]


def test_middlebury(tmp_path):
    seen = pair()
    check(io.read_depth_set(writers.middlebury(tmp_path, seen, 0.3)), seen, 1e-5)


def test_middlebury_with_one_disparity_map(tmp_path):
    seen = pair()
    (writers.middlebury(tmp_path, seen, 0.3) / "disp1.pfm").unlink()
    check(io.read_depth_set(tmp_path), seen[:1], 1e-5)
    with pytest.raises(FileNotFoundError, match="found no depth map"):
        io.read_depth_set(tmp_path, views=[1])
    _, right = io.read_depth_cameras(tmp_path)
    assert np.allclose(right.eye, [0.3, 0, 0, 1])


def npy(path, shot):
    np.save(path, np.where(shot.valid, shot.depth, np.nan))


def npy_of_bytes(path, shot):
    np.save(path, np.asfortranarray(writers.codes(shot, 0.001)))


def raster(path, shot):
    writers.png(path, writers.codes(shot, 0.001), 16)


def far(path, shot):
    path.write_bytes(writers.pfm(np.where(shot.valid, shot.depth, 1e10)))  # Blender's word for nothing


def exr(path, shot):
    path.write_bytes(exr_writer.encode({"Z": np.where(shot.valid, shot.depth, np.inf).astype(np.float32)}))


def tiff(path, shot):
    path.write_bytes(tiff_writer.encode(np.where(shot.valid, shot.depth, -1).astype(np.float32)))


OWN = {"convention": "opencv", "poses": "camera_to_world", "along": "axis", "pixel_centers": "integer"}


@pytest.mark.parametrize(
    ("write", "ending", "scale"),
    [(npy, "npy", None), (npy_of_bytes, "npy", 0.001), (raster, "png", 0.001), (far, "pfm", None), (exr, "exr", None),
     (tiff, "tiff", None)],
)  # fmt: skip
def test_a_folder_of_ones_own(tmp_path, write, ending, scale):
    seen = shots.shots()
    writers.own(tmp_path, seen, write, ending, together=ending == "npy")
    check(io.read_depth_set(tmp_path, depth_scale=scale, **OWN), seen, scale or 1e-6)


def test_pictures_are_in_the_order_of_their_numbers(tmp_path):
    seen = [*shots.shots(), *shots.shots(), *shots.shots(), *shots.shots()]
    set_ = io.read_depth_set(writers.own(tmp_path, seen, npy, "npy"), **OWN)
    assert set_.names == tuple(f"{i}.png" for i in range(12))
    check(set_, seen, 1e-12)


def test_some_views(tmp_path):
    seen = shots.shots()
    writers.scannet(tmp_path, seen)
    check(io.read_depth_set(tmp_path, views=(2, 0)), [seen[2], seen[0]], 0.001)
    for views in ((3,), (-1,), (), "01", 1, (0.5,)):
        with pytest.raises(ValueError, match="views"):
            io.read_depth_set(tmp_path, views=views)


def test_transforms_whose_floats_have_a_unit(tmp_path):
    """The caller's word comes before the file's."""
    seen = shots.shots(1)
    io.write_depth_set(tmp_path, io.read_depth_set(writers.transforms(tmp_path, seen)))
    path = tmp_path / "transforms.json"
    tree = json.loads(path.read_text())
    path.write_text(json.dumps(tree | {"depth_unit_scale_factor": 2}))
    depth, expected = (io.read_depth_set(tmp_path, depth_scale=scale)[0].depth for scale in (None, 1))
    assert np.array_equal(depth, 2 * expected)
    assert np.allclose(expected, seen[0].depth, rtol=0, atol=0.001)
    path.write_text(json.dumps(tree | {"depth_unit_scale_factor": 2, "integer_depth_scale": 2}))
    with pytest.raises(
        ValueError, match=r"depth_unit_scale_factor: found 2\.0, allowed: None beside integer_depth_scale"
    ):
        io.read_depth_set(tmp_path)
