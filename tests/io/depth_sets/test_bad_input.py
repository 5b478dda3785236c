"""Depth sets that are wrong somewhere: one line that starts with the file, says what was found and what is allowed."""

from __future__ import annotations

import json
import os
import struct

import numpy as np
import pytest

from ibr_ref import io
from tests.io.depth_sets import shots, writers
from tests.io.depth_sets.test_formats import OWN, npy, pair


def refused(folder, *words, **options):
    with pytest.raises((OSError, ValueError)) as caught:
        io.read_depth_set(folder, **options)
    message = str(caught.value)
    assert message.startswith(str(folder)), message
    assert len(message) < len(str(folder)) + 700
    assert "\n" not in message
    assert not [word for word in words if word not in message], message


def changed(path, change):
    tree = json.loads(path.read_text())
    change(tree)
    path.write_text(json.dumps(tree))


@pytest.fixture
def transforms(tmp_path):
    return writers.transforms(tmp_path, shots.shots(2))


@pytest.fixture
def own(tmp_path):
    return writers.own(tmp_path, shots.shots(2), npy, "npy")


def frame(**fields):
    return lambda tree: tree["frames"][1].update(fields)


def matrix(row, column, value):
    def change(tree):
        tree["frames"][1]["transform_matrix"][row][column] = value

    return change


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (frame(k1=0.01), ("frames[1]", "k1: found 0.01", "0: pictures without distortion")),
        (frame(p2=-0.01), ("p2: found -0.01",)),
        (frame(camera_model="OPENCV_FISHEYE"), ("camera_model", "OPENCV_FISHEYE", "a pinhole")),
        (frame(is_fisheye=True), ("is_fisheye: found True", "a pinhole")),
        (lambda tree: tree.update(ftheta_p0=0.1), ("frames[0]: ftheta_p0: found 0.1", "a pinhole")),
        (frame(camera_model="EQUIRECTANGULAR"), ("camera_model", "PINHOLE")),
        (frame(fl_x=0), ("fl_x: found 0",)),
        (frame(fl_x=1e300), ("fl_x: found 1e+300",)),
        (frame(fl_x="22"), ("fl_x: found '22'",)),
        (frame(cx=None), ("cx: found None",)),
        (frame(w=21), ("found 21 x 14 pixels, allowed: 20 x 14, the size of 1.png",)),
        (frame(w=10**30), ("w: found 1000000000000000000000000000000",)),
        (frame(near=5, far=1), ("far: found 1",)),
        (frame(file_path=None), ("file_path: found None",)),
        (frame(file_path="../secret.png"), ("file_path: found '../secret.png'", "folder of this one or below")),
        (frame(file_path="/etc/passwd"), ("file_path: found '/etc/passwd'",)),
        (frame(depth_path="a\0b"), ("depth_path",)),
        (frame(depth_path="x" * 5000), ("cannot be read (File name too long)",)),
        (frame(file_path="images/no.png"), ("no.png: cannot be read",)),
        (frame(depth_path=None), ("frames[1]: found no depth map",)),
        (frame(transform_matrix=[[1, 0, 0, 0]]), ("transform_matrix: found [[1, 0, 0, 0]]",)),
        (frame(transform_matrix=[[1, 0, 0], [0, 1], [0, 0, 1], 3]), ("transform_matrix",)),
        (matrix(0, 0, 2.0), ("frames[1]: pose[:3, :3]", "a rotation")),
        (matrix(0, 3, 1e12), ("pose[:3, 3]", "1e+09")),
        (matrix(3, 3, 2.0), ("pose[3]: found [0.0, 0.0, 0.0, 2.0]",)),
        (matrix(1, 1, None), ("transform_matrix",)),
        (lambda tree: tree.update(frames=[]), ("frames: found []",)),
        (lambda tree: tree.update(frames={"a": 1}), ("frames: found {'a': 1}",)),
        (lambda tree: tree.update(frames=[1]), ("frames[0]: found a int",)),
        (lambda tree: tree.update(integer_depth_scale=-1), ("integer_depth_scale: found -1",)),
        (lambda tree: tree.update(applied_scale="x"), ("applied_scale: found 'x'",)),
    ],
)  # fmt: skip
def test_a_document(transforms, change, words):
    changed(transforms / "transforms.json", change)
    refused(transforms, *words, views=[1] if "no depth map" in words[0] else None)


def test_a_mirrored_pose(transforms):
    def mirror(tree):
        for row in tree["frames"][0]["transform_matrix"][:3]:
            row[0] = -row[0]

    changed(transforms / "transforms.json", mirror)
    refused(transforms, "frames[0]: pose[:3, :3]", "det > 0")


@pytest.mark.parametrize(
    "text",
    ["", "{", "[]", "3", '{"frames": NaN}', '{"frames": [Infinity]}', "[" * 10**5, "\xff", "9" * 5000, '{"a", 1}'],
)
def test_no_document(transforms, text):
    (transforms / "transforms.json").write_bytes(text.encode("latin-1"))
    refused(transforms, "transforms.json: found", "allowed")


def test_a_number_beyond_floats(transforms):
    path = transforms / "transforms.json"
    path.write_text(path.read_text().replace('"fl_x": 22.0', '"fl_x": 1e999', 1))
    refused(transforms, "frames[0]: fl_x: found inf")


POSES = {
    "nan": ("1 0 0 nan 0 1 0 0 0 0 1 0", "finite"),
    "inf": ("1 0 0 0 0 1 0 0 0 0 1 inf", "finite"),
    "huge": ("1 0 0 1e30 0 1 0 0 0 0 1 0", "pose[:3, 3]"),
    "zero": ("0 0 0 0 0 0 0 0 0 0 0 0", "a rotation"),
    "scaled": ("2 0 0 0 0 2 0 0 0 0 2 0", "a rotation"),
    "sheared": ("1 0.1 0 0 0 1 0 0 0 0 1 0", "a rotation"),
    "mirrored": ("-1 0 0 0 0 1 0 0 0 0 1 0", "a rotation"),
    "short": ("1 0 0 0", "found 4 numbers"),
    "words": ("1 0 0 x 0 1 0 0 0 0 1 0", "found '1 0 0 x"),
    "python's": ("1 0 0 1_0 0 1 0 0 0 0 1 0", "found '1 0 0 1_0"),
    "empty": ("", "found 0 bytes"),
}


@pytest.mark.parametrize("name", POSES)
def test_a_pose(own, name):
    text, words = POSES[name]
    (own / "poses" / "1.txt").write_text(text)
    refused(own, "1.txt: ", words, **OWN)


def test_intrinsics(own):
    for text, words in (
        ("0 0 9 0 22 7 0 0 1", "focal"),
        ("22 0 9 1 22 7 0 0 1", "invertible"),
        ("1 2", "found 2 numbers"),
    ):
        (own / "intrinsics.txt").write_text(text)
        refused(own, words, **OWN)
    (own / "intrinsics.txt").unlink()
    refused(own, "intrinsics: found None and no intrinsics.txt", **OWN)


def test_what_is_missing(own):
    (own / "poses" / "1.txt").unlink()
    refused(own, "1.txt: cannot be read", **OWN)
    (own / "depth" / "1.npy").unlink()
    refused(own, "found 1 in one of color/ and depth/", **OWN)
    (own / "depth" / "0.npy").unlink()
    refused(own, "depth: found no file", **OWN)


def test_two_of_one_name(own):
    (own / "depth" / "1.png").touch()
    refused(own, "depth/1.png: found beside 1.npy", **OWN)


def test_poses_together(tmp_path):
    writers.own(tmp_path, shots.shots(2), npy, "npy", together=True)
    path = tmp_path / "poses.txt"
    path.write_text(path.read_text() + "1\n")
    refused(tmp_path, "poses.txt: found 33 numbers for 2 pictures, allowed: 16 a picture, or 12", **OWN)


def test_depths_that_are_none(own):
    for value in (0.0, -3.0, np.nan, np.inf, 1e9, 3.4e38):
        for i in range(2):
            np.save(own / "depth" / f"{i}.npy", np.full((shots.HEIGHT, shots.WIDTH), value))
        refused(own, "found no valid depth in 2 maps, the last one of", **OWN)
    np.save(own / "depth" / "0.npy", shots.shots()[0].depth)
    assert [int(image.mask.sum()) > 0 for image in io.read_depth_set(own, **OWN)] == [True, False]


def header(shape, descr="'<f8'"):
    text = f"{{'descr': {descr}, 'fortran_order': False, 'shape': {shape}, }}".encode()
    return b"\x93NUMPY\x01\x00" + struct.pack("<H", len(text)) + text


MAPS = {
    "huge": (header("(100000, 100000)"), "found 100000 x 100000 pixels"),
    "short": (header("(14, 20)") + bytes(9), "found 9 bytes of numbers, 2240 needed"),
    "long": (header("(14, 20)") + bytes(2241), "found 2241 bytes"),
    "pickle": (header("(14, 20)", "'|O'") + bytes(2240), "object"),
    "complex": (header("(14, 20)", "'<c16'") + bytes(4480), "complex128"),
    "table": (header("(14, 20)", "[('a', '<f8')]") + bytes(2240), "allowed for depths"),
    "one axis": (header("(280,)") + bytes(2240), "found an array (280,)"),
    "no pixels": (header("(0, 20)"), "found an array (0, 20)"),
    "no header": (b"\x93NUMPY\x01\x00\xff\xff{", "found an NPY header"),
    "version": (b"\x93NUMPY\x07\x00", "found an NPY header"),
    "other size": (header("(7, 20)") + np.ones(140).tobytes(), "found 20 x 14 pixels of colour and 20 x 7 of depth"),
    "colmap": (b"20&14&1&" + bytes(3), "found 3 bytes of a COLMAP map, 1120 needed"),
    "colmap, huge": (b"999999999&999999999&1&" + bytes(3), "found 999999999 x 999999999 pixels"),
    "colmap, normals": (b"20&14&3&" + bytes(3360), "of 3 channels"),
    "text": (b"20 14 1", "found a file that starts with b'20 14 1'"),
    "colours": (header("(14, 20, 3)") + np.arange(840.0).tobytes(), "found an array (14, 20, 3) of float64"),
}


@pytest.mark.parametrize("name", MAPS)
def test_a_depth_map(own, name):
    data, words = MAPS[name]
    (own / "depth" / "1.npy").write_bytes(data)
    refused(own, words, **OWN)


def test_what_is_no_file(own):
    path = own / "depth" / "1.npy"
    path.unlink()
    os.mkfifo(path)
    refused(own, "1.npy: is a device or a pipe", **OWN)
    path.unlink()
    path.mkdir()
    refused(own, "1.npy: is a folder", **OWN)


@pytest.mark.parametrize("name", ["transforms.json", "calib.txt", "sparse/cameras.bin", "rgb.txt"])
def test_texts_that_are_no_files(tmp_path, name):
    writers.tum(tmp_path, shots.shots(1))
    (tmp_path / name).parent.mkdir(exist_ok=True)
    (tmp_path / name).unlink(missing_ok=True)
    os.mkfifo(tmp_path / name)
    format_ = {"t": "transforms", "c": "middlebury", "s": "colmap", "r": "tum"}[name[0]]
    k = {"intrinsics": (1, 1, 1, 1)} if format_ == "tum" else {}
    refused(tmp_path, f"{name}: is a device or a pipe", format=format_, **k)


def test_a_link_out_of_the_folder(tmp_path):
    folder, outside = tmp_path / "set", tmp_path / "outside.png"
    folder.mkdir()
    writers.transforms(folder, shots.shots(1))
    (folder / "images" / "0.png").rename(outside)
    os.symlink(outside, folder / "images" / "0.png")
    refused(folder, "file_path", "not a link out of it")
    os.remove(folder / "images" / "0.png")
    os.symlink("0.png", folder / "images" / "0.png")
    refused(folder, "file_path")


def test_which_format(tmp_path):
    refused(tmp_path, "found none of the depth sets that are read", "tum: rgb.txt, depth.txt and groundtruth.txt")
    refused(tmp_path / "no", "is no folder")
    writers.transforms(tmp_path, shots.shots(1))
    writers.colmap(tmp_path / "sub", shots.shots(1))
    (tmp_path / "sub" / "sparse").rename(tmp_path / "sparse")
    refused(tmp_path, "format: found the files of several, allowed: one of transforms | colmap")
    assert len(io.read_depth_set(tmp_path, "transforms")) == 1
    for name in ("open3d", "tum", "scannet", "middlebury"):
        refused(tmp_path, format=name, **({"intrinsics": (1, 1, 1, 1)} if name in ("open3d", "tum") else {}))


def test_tum(tmp_path):
    writers.tum(tmp_path, shots.shots(2))
    k = {"intrinsics": writers.tum_intrinsics(shots.K)}
    refused(tmp_path, "intrinsics: found None and no calibration.txt", "525, 525, 319.5, 239.5")
    poses, colors = tmp_path / "groundtruth.txt", tmp_path / "rgb.txt"
    good, good_colors = poses.read_text(), colors.read_text()
    for text, words in (
        ("x 1 2", "line 1: found 'x 1 2', allowed: a time"),
        ("nan 1 2", "line 1: found 'nan 1 2'"),
        ("1305031102.001 0 0 0 0 0 0 1 9", "line 1: found '0 0 0 0 0 0 1 9', allowed: 7 finite numbers"),
        ("1305031102.001 0 0 0 0 0 0 0.5", "found a quaternion [0.0, 0.0, 0.0, 0.5] of length 0.5"),
        ("1305031102.001 0 0 0 0 0 0 0", "of length 0"),
        ("1305031102.001 0 0 nan 0 0 0 1", "7 finite numbers"),
        ("1305031102.001 0 0 1e300 0 0 0 1", "pose[:3, 3]"),
        ("# none", "2 pictures, 2 depth maps and 0 poses"),
    ):
        poses.write_text(text)
        refused(tmp_path, words, **k)
    poses.write_text(good)
    for text, words in (
        ("1305031102.0", "rgb.txt: line 1: found no file"),
        ("1305031102.0 ../x.png", "rgb.txt: line 1: found '../x.png'"),
        ("1305031102.0 rgb/no.png", "no.png: cannot be read"),
    ):
        colors.write_text(text)
        refused(tmp_path, words, **k)
    colors.write_text("".join(f"1305031102.0{i % 10} rgb/a.png\n" for i in range(5000)))
    poses.write_text("".join(f"1305031102.0{i % 10} 0 0 0 0 0 0 1\n" for i in range(5000)))
    (tmp_path / "depth.txt").write_text("".join(f"1305031102.0{i % 10} depth/a.png\n" for i in range(5000)))
    refused(tmp_path, "max_time_gap: found 0.02", "at most 4194304 pairs", **k)
    colors.write_text(good_colors)


def test_open3d(tmp_path):
    writers.open3d(tmp_path, shots.shots(2))
    log, path = tmp_path / "trajectory.log", tmp_path / "camera_intrinsic.json"
    good = log.read_text()
    for text, words in (
        (good + good, "found 2 pictures, 2 depth maps and 4 poses"),
        (good + "1 2 3\n", "trajectory.log: found 11 lines"),
        (good.replace("1.0", "x", 1), "trajectory.log: line 2"),
    ):
        log.write_text(text)
        refused(tmp_path, words)
    log.write_text(good)
    for field, value in (("intrinsic_matrix", [1, 2]), ("width", 0), ("height", None), ("depth_scale", 0)):
        before = path.read_text()
        changed(path, lambda tree, field=field, value=value: tree.update({field: value}))
        refused(tmp_path, f"{field}: found")
        path.write_text(before)
    (tmp_path / "another.log").write_text(good)
    refused(tmp_path, "found another.log, trajectory.log, allowed: one trajectory .log")


def test_scannet(tmp_path):
    writers.scannet(tmp_path, shots.shots(2))
    (tmp_path / "intrinsic" / "extrinsic_color.txt").write_text("1 0 0 0.1 0 1 0 0 0 0 1 0 0 0 0 1")
    refused(tmp_path, "extrinsic_color.txt: found another matrix, allowed: the unit matrix")
    (tmp_path / "intrinsic" / "extrinsic_color.txt").unlink()
    (tmp_path / "pose" / "1.txt").unlink()
    refused(tmp_path, "color/1.png: found no pose/1.txt")
    (tmp_path / "depth" / "0.png").unlink()
    refused(tmp_path, "color/0.png: found no depth/0.png")


def test_middlebury(tmp_path):
    writers.middlebury(tmp_path, pair(), 0.3)
    path = tmp_path / "calib.txt"
    good = path.read_text()
    for old, new, words in (
        ("baseline=0.3", "baseline=-1", "baseline: found -1.0"),
        ("baseline=0.3", "", "baseline: found ''"),
        ("baseline=0.3", "baseline=nan", "baseline: found 'nan'"),
        ("width=20", "width=21", "found 21 x 14 pixels, allowed: 20 x 14"),
        ("width=20", "width=1e9", "width: found"),
        ("cam1=[22.0", "cam1=[0", "cam1: found '0 0 10.6 0 22.0 6.9 0 0 1'"),
        ("cam0=[22.0", "cam0=[22.0 1", "cam0: found"),
    ):
        path.write_text(good.replace(old, new))
        refused(tmp_path, "calib.txt: ", words)
    path.write_text(good)
    (tmp_path / "im1.png").unlink()
    refused(tmp_path, "found no im1.png")


def test_colmap_cameras(tmp_path):
    writers.colmap(tmp_path / "a", shots.shots(2), model="OPENCV", bend=0.01)
    refused(tmp_path / "a", "image cam/0.png: camera: found", "OPENCV", "colmap image_undistorter")
    writers.colmap(tmp_path / "b", shots.shots(2), model="OPENCV", binary=False)
    assert len(io.read_depth_set(tmp_path / "b")) == 2
    path = tmp_path / "b" / "sparse" / "cameras.txt"
    good = path.read_text()
    for old, new, words in (
        ("OPENCV", "FOV", "parameters: found"),
        ("OPENCV 20", "OPENCV 0", "width: found 0"),
        ("OPENCV", "LENS", "line 3: found '1 LENS 20"),
        (" 0.0\n", " 0.1\n", "camera: found"),
        (" 0.0\n", " nan\n", "finite"),
        ("1 OPENCV", "9 OPENCV", "camera: found 1, allowed: a camera of the model"),
    ):
        path.write_text(good.replace(old, new))
        refused(tmp_path / "b", words)
    path.write_text("1 FOV 20 14 22 23 9 7 0\n2 FOV 20 14 22 23 9 7 0")
    refused(tmp_path / "b", "FOV", "a pinhole")


def test_colmap_images_txt(tmp_path):
    writers.colmap(tmp_path, shots.shots(2), binary=False)
    path = tmp_path / "sparse" / "images.txt"
    for text, words in (
        ("1 1 0 0 0 0 0 0 1", "line 1: found"),
        ("1 1 0 0 0 0 0 inf 1 a.png", "7 finite numbers"),
        ("1 2 0 0 0 0 0 0 1 a.png", "of length 2"),
        ("1 1 0 0 0 0 0 0 x a.png", "a camera's number"),
        ("1 1 0 0 0 0 0 0 1 ../a.png", "found '../a.png'"),
        ("1 1 0 0 0 0 0 0 1 a.png", "found 1 pictures and no depth map"),
        ("# none", "found no image"),
    ):
        path.write_text(text)
        refused(tmp_path, words)


def test_colmap_binary(tmp_path):
    writers.colmap(tmp_path, shots.shots(2))
    cameras, images = (tmp_path / "sparse" / f"{name}.bin" for name in ("cameras", "images"))
    good = cameras.read_bytes(), images.read_bytes()
    for data, words in (
        (struct.pack("<Q", 2**63) + good[0][8:], "cameras.bin: found a truncated file"),
        (good[0][:-1], "found a truncated file"),
        (good[0] + b"x", "found 1 bytes after the last one"),
        (good[0][:12] + struct.pack("<i", -5) + good[0][16:], "camera model: found -5"),
        (good[0][:12] + struct.pack("<i", 99) + good[0][16:], "camera model: found 99"),
        (good[0][:16] + struct.pack("<Q", 2**60) + good[0][24:], "width: found"),
    ):
        cameras.write_bytes(data)
        refused(tmp_path, words)
    cameras.write_bytes(good[0])
    for data, words in (
        (struct.pack("<Q", 2**40) + good[1][8:], "images.bin: found a truncated file"),
        (good[1][:80], "found a name without an end"),
        (good[1][:82] + struct.pack("<Q", 2**62), "truncated"),
    ):
        images.write_bytes(data)
        refused(tmp_path, words)


def test_more_than_fits(own, monkeypatch):
    monkeypatch.setattr("ibr_ref.io.depth_sets.read.MOST_PIXELS", 300)
    refused(own, "views: found more than 300 pixels in 2 pictures, allowed: fewer of the 2", **OWN)
    assert len(io.read_depth_set(own, views=[1], **OWN)) == 1
