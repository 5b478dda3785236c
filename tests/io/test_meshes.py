"""Meshes: the vertices and triangles of the file, in its order, and one clear error for whatever is no mesh."""

import json
import struct

import numpy as np
import pytest
import trimesh
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from ibr_ref import io
from tests.io.test_images import check_refused, shared, small

CORNERS = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [9, 9, 9], [0, 0, 0]])
"""The fifth is in no triangle, the sixth is the first again: both must stay."""
TRIANGLES = np.array([[0, 2, 1], [0, 1, 3], [5, 3, 2], [1, 2, 3]])


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("meshes")


def written(folder, name, data):
    path = folder / name
    path.write_bytes(data.encode() if isinstance(data, str) else data)
    return path


def exported(kind, colors=None):
    mesh = trimesh.Trimesh(CORNERS, TRIANGLES, process=False, vertex_colors=colors)
    data = mesh.export(file_type=kind)
    return data.encode() if isinstance(data, str) else data


# OBJ


def test_the_cow():
    mesh = io.read_mesh(shared("models/cow.obj"))
    assert mesh.vertices.shape == (2903, 3)
    assert mesh.triangles.shape == (5804, 3)
    np.testing.assert_array_equal(mesh.vertices[0], [2.292449, -0.871852, -0.882400])
    np.testing.assert_array_equal(mesh.triangles[:2], [[0, 1, 2], [2, 1, 3]])
    np.testing.assert_array_equal(mesh.color, [0.8, 0.8, 0.8])
    other = trimesh.load(shared("models/cow.obj"), process=False, maintain_order=True, force="mesh")
    np.testing.assert_array_equal(mesh.vertices, other.vertices)
    np.testing.assert_array_equal(mesh.triangles, other.faces)


@small
@given(vertices=arrays(np.float64, (6, 3), elements=st.floats(allow_nan=False, allow_infinity=False)))
def test_obj_to_the_last_bit(folder, vertices):
    text = "".join("v {!r} {!r} {!r}\n".format(*row) for row in vertices.tolist())
    text += "".join("f {} {} {}\n".format(*row) for row in (TRIANGLES + 1).tolist())
    mesh = io.read_mesh(written(folder, "a.obj", text))
    np.testing.assert_array_equal(mesh.vertices, vertices)
    np.testing.assert_array_equal(mesh.triangles, TRIANGLES)


def test_all_that_an_obj_may_have(tmp_path):
    text = """# corners, of a square, \xe9
mtllib none.mtl
o part one
v 0 0 0 1.0
v 1 0 0  # a comment
v 1 1 \\
0
v 0 1 0
vt 0 0\r
vn 0 0 1
usemtl none
s off
f 1/1/1 2/1/1 3//1 4
g part two
v 0 0 5
v 1 0 5
v 0 1 5
f -3 -2/1 -1//1
"""
    mesh = io.read_mesh(written(tmp_path, "a.OBJ", text.encode("latin-1")))
    np.testing.assert_array_equal(mesh.triangles, [[0, 1, 2], [0, 2, 3], [4, 5, 6]])
    np.testing.assert_array_equal(mesh.vertices[2], [1, 1, 0])


def test_corners_may_come_before_their_vertices(tmp_path):
    mesh = io.read_mesh(written(tmp_path, "a.obj", "f 1 2 3\nv 0 0 0\nv 1 0 0\nv 0 1 0\n"))
    np.testing.assert_array_equal(mesh.triangles, [[0, 1, 2]])


def test_vertex_colours_of_an_obj(tmp_path):
    text = "v 0 0 0 0.1 0.2 0.3\nv 1 0 0 1 1 1\nv 0 1 0 0 0 0\nf 1 2 3\n"
    mesh = io.read_mesh(written(tmp_path, "a.obj", text))
    np.testing.assert_array_equal(mesh.color, [[0.1, 0.2, 0.3], [1, 1, 1], [0, 0, 0]])
    check_refused(io.read_mesh, written(tmp_path, "a.obj", text.replace(" 1 1 1", "")), "found 2 vertex colours")
    check_refused(io.read_mesh, written(tmp_path, "a.obj", text.replace("0.3", "255")), "color", "allowed")


@pytest.mark.parametrize(
    ("line", "words"),
    [
        ("f 1 2", ("'f 1 2' in line 4", "allowed: f and 3 corners or more")),
        ("f 1 2 x", ("line 4", "whole numbers")),
        ("f 0 1 2", ("line 4", "from 1 up")),
        ("f -4 1 2", ("line 4", "back from -1")),
        ("f 1 2 4", ("triangles", "found 3", "from 0 to 2")),
        ("f 1 2 99999999999999999999", ("line 4", "whole numbers")),
        ("v 1 2", ("'v 1 2' in line 4", "v and 3 numbers")),
        ("v 1 2 x", ("line 4",)),
        ("v 1 2 nan", ("vertices[3]", "finite")),
        ("v 1 2 1e999", ("vertices[3]", "finite")),
        ("", ("triangles.shape", "T >= 1")),
    ],
)
def test_bad_obj(tmp_path, line, words):
    text = f"v 0 0 0\nv 1 0 0\nv 0 1 0\n{line}\n" + ("f 1 2 3\n" if line.startswith("v") else "")
    check_refused(io.read_mesh, written(tmp_path, "a.obj", text), *words)


# The formats that trimesh reads


@pytest.mark.parametrize("kind", ["ply", "glb"])
def test_indexed_formats_keep_vertices_and_order(tmp_path, kind):
    mesh = io.read_mesh(written(tmp_path, f"a.{kind}", exported(kind)))
    np.testing.assert_array_equal(mesh.vertices, CORNERS)
    np.testing.assert_array_equal(mesh.triangles, TRIANGLES)
    np.testing.assert_array_equal(mesh.color, [0.8, 0.8, 0.8])


@pytest.mark.parametrize("kind", ["stl", "stl_ascii"])
def test_stl_has_three_vertices_a_triangle(tmp_path, kind):
    mesh = io.read_mesh(written(tmp_path, "a.stl", exported(kind)))
    np.testing.assert_array_equal(mesh.vertices, CORNERS[TRIANGLES].reshape(-1, 3))
    np.testing.assert_array_equal(mesh.triangles, np.arange(12).reshape(4, 3))


@pytest.mark.parametrize("kind", ["ply", "glb"])
def test_vertex_colours(tmp_path, kind):
    colors = np.random.default_rng(0).integers(0, 256, (6, 3), np.uint8)
    mesh = io.read_mesh(written(tmp_path, f"a.{kind}", exported(kind, colors)))
    np.testing.assert_array_equal(mesh.color, colors / 255.0)


def test_ascii_ply_of_squares_with_texture_coordinates(tmp_path):
    mesh = io.read_mesh(written(tmp_path, "a.ply", PLY))
    np.testing.assert_array_equal(mesh.vertices, CORNERS[[0, 1, 2, 3]])
    assert sorted(map(sorted, mesh.triangles.tolist())) in ([[0, 1, 2], [0, 2, 3]], [[0, 1, 3], [1, 2, 3]])


PLY = """ply
format ascii 1.0
comment by hand
element vertex 4
property float x
property float y
property float z
property float s
property float t
element face 1
property list uchar int vertex_indices
end_header
0 0 0 0 0
1 0 0 1 0
0 1 0 1 1
0 0 1 0 1
4 0 1 2 3
"""


def scene_of_two():
    scene = trimesh.Scene()
    scene.add_geometry(trimesh.Trimesh(CORNERS, TRIANGLES, process=False), node_name="here")
    scene.add_geometry(
        trimesh.Trimesh(CORNERS, TRIANGLES, process=False),
        node_name="there",
        transform=trimesh.transformations.translation_matrix([0, 0, 7]),
    )
    return scene


def test_the_parts_of_a_scene_are_put_in_place_and_joined(tmp_path):
    mesh = io.read_mesh(written(tmp_path, "a.glb", scene_of_two().export(file_type="glb")))
    assert mesh.vertices.shape == (12, 3)
    assert mesh.triangles.shape == (8, 3)
    heights = sorted(mesh.vertices[:, 2])
    np.testing.assert_array_equal(heights, sorted([*CORNERS[:, 2], *(CORNERS[:, 2] + 7)]))


def test_a_gltf_has_its_numbers_beside_it(tmp_path):
    files = scene_of_two().export(file_type="gltf")
    for name, data in files.items():
        (tmp_path / name).write_bytes(data)
    assert io.read_mesh(tmp_path / "model.gltf").triangles.shape == (8, 3)
    buffers = [name for name in files if name.endswith(".bin")]
    (tmp_path / buffers[0]).unlink()
    check_refused(io.read_mesh, tmp_path / "model.gltf")


# Files that are no meshes


def test_no_such_file_folder_empty_or_ending(tmp_path):
    check_refused(io.read_mesh, tmp_path / "none.obj", "No such file")
    check_refused(io.read_mesh, tmp_path, "is a folder")
    check_refused(io.read_mesh, written(tmp_path, "a.obj", ""), "found 0 bytes")
    check_refused(
        io.read_mesh, written(tmp_path, "a.fbx", "x"), "found the ending '.fbx'", ".obj, .ply, .stl, .glb, .gltf"
    )


@pytest.mark.parametrize("ending", ["obj", "ply", "stl", "glb", "gltf"])
@pytest.mark.parametrize("data", [b"hello, world\n", bytes(200), b"\xff" * 200, b"{}", b"[]", b"solid", b"ply\n"])
def test_garbage(tmp_path, capfd, ending, data):
    check_refused(io.read_mesh, written(tmp_path, f"a.{ending}", data))
    assert capfd.readouterr() == ("", "")


@pytest.mark.parametrize("kind", ["ply", "glb", "stl"])
def test_no_part_of_a_binary_mesh_is_one(tmp_path, kind):
    whole = exported(kind)
    for size in range(0, len(whole), 7):
        check_refused(io.read_mesh, written(tmp_path, f"a.{kind}", whole[:size]))


@pytest.mark.parametrize(("kind", "text"), [("ply", PLY.encode()), ("stl", exported("stl_ascii"))])
def test_no_first_lines_of_a_text_mesh_are_one(tmp_path, kind, text):
    lines = text.splitlines(keepends=True)
    for count in range(len(lines)):
        check_refused(io.read_mesh, written(tmp_path, f"a.{kind}", b"".join(lines[:count])))


@pytest.mark.parametrize(
    ("old", "new"), [("4 0 1 2 3", "3 0 1 9"), ("1 0 0 1 0", "nan 0 0 1 0"), ("4 0 1 2 3", "4 0 1 x 3")]
)
def test_bad_ply(tmp_path, old, new):
    check_refused(io.read_mesh, written(tmp_path, "a.ply", PLY.replace(old, new)))


@pytest.mark.parametrize("count", [10**9, 2**40])
def test_a_ply_that_claims_much(tmp_path, count):
    text = PLY.replace("element vertex 4", f"element vertex {count}")
    check_refused(io.read_mesh, written(tmp_path, "a.ply", text))
    check_refused(io.read_mesh, written(tmp_path, "a.ply", text.replace("ascii", "binary_little_endian")))


def test_vertices_that_are_not_finite(tmp_path):
    data = bytearray(exported("stl"))
    data[84 + 12 : 84 + 16] = struct.pack("<f", float("inf"))
    check_refused(io.read_mesh, written(tmp_path, "a.stl", bytes(data)), "vertices[0]", "finite")


def test_points_alone_are_no_mesh(tmp_path):
    data = trimesh.PointCloud(CORNERS).export(file_type="ply")
    check_refused(io.read_mesh, written(tmp_path, "a.ply", data))
    tree = {"asset": {"version": "2.0"}, "scenes": [{"nodes": []}], "scene": 0}
    check_refused(io.read_mesh, written(tmp_path, "a.gltf", json.dumps(tree)))
