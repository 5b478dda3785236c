"""Depth sets and point clouds written, read again: by the package, and by plain readers."""

from __future__ import annotations

import json

import numpy as np
import pytest

import ibr_ref
from ibr_ref import displacement, io, models
from tests.io.depth_sets import shots


def rig():
    return models.depth_rig(models.kettle(), 4, size=40)


def same(found, expected, atol=0.0):
    for image, other in zip(found, expected, strict=True):
        assert np.array_equal(image.mask, other.mask)
        assert np.allclose(image.depth, other.depth, rtol=0, atol=atol)
        assert np.abs(image.color - other.color)[image.mask].max() <= 0.5 / 255 + 1e-12
        for name in ("near", "far", "width", "height"):
            assert getattr(image.camera, name) == getattr(other.camera, name)
        assert np.allclose(image.camera.intrinsics, other.camera.intrinsics, rtol=1e-14)
        assert np.allclose(image.camera.view_from_world, other.camera.view_from_world, rtol=0, atol=1e-14)


def test_a_rig_comes_back(tmp_path):
    images = rig()
    io.write_depth_set(tmp_path / "new" / "set", images)
    set_ = io.read_depth_set(tmp_path / "new" / "set")
    assert isinstance(set_, ibr_ref.DepthSet)
    same(set_, images)
    io.write_depth_set(tmp_path / "again", set_)
    same(io.read_depth_set(tmp_path / "again"), set_)


def test_in_whole_numbers(tmp_path):
    images = rig()
    io.write_depth_set(tmp_path, images, depth_scale=1e-4)
    assert not list(tmp_path.rglob("*.npy"))
    same(io.read_depth_set(tmp_path), images, atol=0.5e-4 + 1e-12)
    with pytest.raises(ValueError, match=r"images\[0\]: depth\[\d+, \d+\]: found .* allowed: 1 to 65535 units"):
        io.write_depth_set(tmp_path / "no", images, depth_scale=1e-6)
    assert not (tmp_path / "no").exists()


def test_what_the_files_say(tmp_path):
    """Read plainly: nerfstudio's fields, OpenGL's axes, camera to world."""
    images = rig()
    io.write_depth_set(tmp_path, images)
    frames = json.loads((tmp_path / "transforms.json").read_text())["frames"]
    for frame, image in zip(frames, images, strict=True):
        depth = np.load(tmp_path / frame["depth_file_path"])
        rows, columns = np.nonzero(depth)
        x = (columns + 0.5 - frame["cx"]) / frame["fl_x"] * depth[rows, columns]
        y = (rows + 0.5 - frame["cy"]) / frame["fl_y"] * depth[rows, columns]
        points = np.stack([x, -y, -depth[rows, columns], np.ones(len(x))], axis=1)
        world = points @ np.array(frame["transform_matrix"]).T
        assert np.allclose(world[:, :3], image.points, rtol=0, atol=1e-12)
        assert (tmp_path / frame["file_path"]).exists()


def test_a_rendered_picture_is_a_reference(tmp_path):
    """The top of a box at z = 0.2 and the ground at z = 0, as displacement mapping draws them."""
    camera = ibr_ref.Camera.look_at(eye=(0.3, -1.4, 1.6), target=(0, 0, 0), near=0.5, far=9, width=40, height=30)
    scene = displacement.Scene(polygons=[models.box()], camera=camera, light=ibr_ref.Light(direction=(0.5, -0.8, 1)))
    frame = displacement.render(scene, displacement.Params(linear_steps=50, binary_steps=6), stages=False)
    image = frame.depth_image(camera)
    assert np.array_equal(image.mask, frame.depth < 1)
    io.write_depth_set(tmp_path, [image])
    same(io.read_depth_set(tmp_path), [image])
    window = np.append(image.points, np.ones((image.mask.sum(), 1)), axis=1) @ camera.clip_from_world.T
    assert np.allclose(window[:, 2] / window[:, 3], frame.depth[image.mask], rtol=0, atol=1e-12)
    with pytest.raises(ValueError, match="camera"):
        frame.depth_image(ibr_ref.Camera.look_at(eye=(1, 1, 1), target=(0, 0, 0)))


@pytest.mark.parametrize("perspective", [True, False])
def test_depths_of_a_frame(perspective):
    """Of window depths by the definition: z_clip / w_clip of points on the axis."""
    make = ibr_ref.Camera.look_at if perspective else ibr_ref.Camera.orthographic
    of = {"vertical_fov": 50} if perspective else {"view_height": 2.0}
    camera = make(eye=(0, -5, 0), target=(0, 0, 0), near=2, far=11, width=3, height=1, **of)
    depth = np.array([[2.5, 7.0, 10.0]])
    clip = np.stack([np.zeros(3), np.zeros(3), -depth[0], np.ones(3)], axis=1) @ camera.clip_from_view.T
    window = (clip[:, 2] / clip[:, 3]).reshape(1, 3)
    frame = io.Frame(color=np.zeros((1, 3, 3)), depth=window)
    assert np.allclose(frame.depth_image(camera).depth, depth, rtol=1e-12)


def test_what_the_file_has_no_words_for(tmp_path):
    image = models.depth_image(
        models.kettle(),
        ibr_ref.Camera.orthographic(eye=(5, 0, 0), target=(0, 0, 0), view_height=4.0, near=1, far=9, width=8, height=8),
    )
    with pytest.raises(ValueError, match=r"images\[0\]: camera: found .*orthographic.* allowed: a pinhole"):
        io.write_depth_set(tmp_path / "no", [image])
    for nothing in ([], [1], image, None):
        with pytest.raises(ValueError, match="allowed: a sequence of DepthImages"):
            io.write_depth_set(tmp_path / "no", nothing)
    assert not (tmp_path / "no").exists()
    (tmp_path / "file").touch()
    with pytest.raises(OSError, match="file: cannot be made"):
        io.write_depth_set(tmp_path / "file", rig())


def test_a_point_cloud(tmp_path):
    images, path = rig(), tmp_path / "cloud.ply"
    io.write_point_cloud(path, images)
    header, data = path.read_bytes().split(b"end_header\n", 1)
    count = sum(int(image.mask.sum()) for image in images)
    assert header.decode().split("\n")[:3] == ["ply", "format binary_little_endian 1.0", f"element vertex {count}"]
    rows = np.frombuffer(data, [("p", "<f8", 3), ("c", "u1", 3)])
    assert len(rows) == count
    assert np.array_equal(rows["p"], np.concatenate([image.points for image in images]))
    assert np.array_equal(rows["c"], np.floor(np.concatenate([i.color[i.mask] for i in images]) * 255 + 0.5))


def test_a_point_cloud_as_another_library_reads_it(tmp_path):
    import trimesh

    (image,) = images = [models.depth_image(models.kettle(), rig()[0].camera)]
    io.write_point_cloud(tmp_path / "cloud.ply", images)
    cloud = trimesh.load(tmp_path / "cloud.ply")
    assert np.array_equal(cloud.vertices, image.points)
    assert np.array_equal(cloud.colors[:, :3], np.floor(image.color[image.mask] * 255 + 0.5))


def test_no_point_cloud(tmp_path):
    image = rig()[0]
    empty = ibr_ref.DepthImage(color=image.color, depth=image.depth, camera=image.camera, mask=image.mask & False)
    for nothing in ([], [1], image, [empty]):
        with pytest.raises(ValueError, match=r"cloud\.ply: .*found .* allowed"):
            io.write_point_cloud(tmp_path / "cloud.ply", nothing)
    assert not list(tmp_path.iterdir())


def test_the_description():
    images = rig()
    set_ = ibr_ref.DepthSet(images=images, names=list("abcd"))
    assert len(set_) == 4
    assert set_[1] is images[1]
    assert set_[1:] == tuple(images[1:])
    assert list(set_) == images
    assert set_.cameras[2] is images[2].camera
    for names in ("abcd", ["a"], [1, 2, 3, 4], None):
        with pytest.raises(ValueError, match="names"):
            ibr_ref.DepthSet(images=images, names=names)
    for bad in ([], images[0], [1], 3):
        with pytest.raises(ValueError, match="images"):
            ibr_ref.DepthSet(images=bad, names=["a"])


def test_points_of_a_parallel_camera():
    camera = ibr_ref.Camera.orthographic(
        eye=(0, -5, 0), target=(0, 0, 0), view_height=2.0, near=1, far=9, width=4, height=2
    )
    image = ibr_ref.DepthImage(color=np.zeros((2, 4, 3)), depth=np.full((2, 4), 3.0), camera=camera)
    x, z = np.meshgrid([-1.5, -0.5, 0.5, 1.5], [0.5, -0.5])
    expected = np.stack([x.reshape(-1), np.full(8, -2.0), z.reshape(-1)], axis=1)
    assert np.allclose(image.points, expected, rtol=0, atol=1e-12)


def test_points_lie_on_the_surface_that_was_seen():
    from ibr_ref.scene import Camera, DepthImage

    shot = shots.shots()[1]
    r = np.diag([1.0, -1.0, -1.0]) @ shot.rotation.T
    camera = Camera.calibrated(
        intrinsics=shot.k,
        rotation=r,
        translation=-r @ shot.center,
        near=1,
        far=9,
        width=shots.WIDTH,
        height=shots.HEIGHT,
    )
    image = DepthImage(color=shot.color / 255, depth=shot.depth, camera=camera, mask=shot.valid)
    assert np.abs(image.points - shot.points[shot.valid]).max() < 1e-12


def test_a_measured_camera_comes_back(tmp_path):
    """With a skew, and a rotation that is one to 1e-4 alone, as those of the MSR 3D Video set are."""
    from ibr_ref.scene import Camera, DepthImage

    shot = shots.shots()[1]
    r = np.diag([1.0, -1.0, -1.0]) @ shot.rotation.T + np.array([[0, 1e-4, 0], [0, 0, 0], [0, 0, 0]])
    camera = Camera.calibrated(
        intrinsics=shot.k + 0.6 * np.eye(3, k=1) * [[1], [0], [0]],
        rotation=r,
        translation=(0.3, 20, -7),
        near=1,
        far=9,
        width=shots.WIDTH,
        height=shots.HEIGHT,
    )
    image = DepthImage(color=shot.color / 255, depth=shot.depth, camera=camera, mask=shot.valid)
    io.write_depth_set(tmp_path, [image])
    (again,) = io.read_depth_set(tmp_path)
    assert again.camera.intrinsics[0, 1] == 0.6
    assert np.abs(again.points - image.points).max() < 1e-12
    assert np.array_equal(again.color, image.color)
