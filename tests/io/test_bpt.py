"""Bézier patch files: Newell's teapot, the two dialects, and one clear error for whatever is no such file."""

from __future__ import annotations

import numpy as np
import pytest

from ibr_ref import io
from ibr_ref.io.bpt import decode
from tests.io.test_images import check_refused, shared
from tests.io.test_meshes import written
from tests.models.surfaces import corners

GRID = [(x, y, 0.25 * x * y) for x in range(4) for y in range(4)]
LISTED = "1\n3 3\n" + "".join(f"{x} {y} {z}\n" for x, y, z in GRID)
INDEXED = "1\n" + ",".join(map(str, range(1, 17))) + "\n16\n" + "".join(f"{x},{y},{z}\n" for x, y, z in GRID)


@pytest.fixture(scope="module")
def teapot():
    return io.read_mesh(shared("models/teapot.bpt"))


# The teapot


def test_the_teapot_has_the_polygons_of_the_paper(teapot):
    assert teapot.vertices.shape == (32 * 49, 3)
    assert teapot.triangles.shape == (2 * 1152, 3)
    np.testing.assert_array_equal(teapot.color, [0.8, 0.8, 0.8])


def test_the_teapot_is_as_large_as_newells(teapot):
    np.testing.assert_allclose(teapot.vertices.min(axis=0), (-3.0, -2.0, 0.0), atol=1e-12)
    np.testing.assert_allclose(teapot.vertices.max(axis=0), (3.42962963, 2.0, 3.15), atol=1e-8)


def test_the_teapot_is_open_only_where_newell_left_it(teapot):
    """At the rims of pot and lid, 24 edges each, and at both ends of handle and spout, 12 each."""
    _, names = np.unique(teapot.vertices, axis=0, return_inverse=True)
    triangles = names.reshape(-1)[teapot.triangles]
    edges = np.sort(np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]]), axis=1)
    _, counts = np.unique(edges[edges[:, 0] != edges[:, 1]], axis=0, return_counts=True)
    assert (counts == 1).sum() == 2 * 24 + 4 * 12


def test_the_teapot_is_wound_outward(teapot):
    a, b, c = corners(teapot).transpose(1, 0, 2)
    volumes = (a * np.cross(b, c)).sum(axis=1).reshape(32, -1).sum(axis=1) / 6.0
    pot_handle_spout_lid_bottom = np.add.reduceat(volumes, [0, 12, 16, 20, 28])
    assert pot_handle_spout_lid_bottom.min() > 0.0


@pytest.mark.parametrize("quads", [1, 3, 20])
def test_as_fine_as_you_like(quads):
    mesh = io.read_mesh(shared("models/teapot.bpt"), quads=quads)
    assert mesh.triangles.shape == (64 * quads**2, 3)


# Both dialects


@pytest.mark.parametrize("text", [LISTED, INDEXED])
@pytest.mark.parametrize("change", [str, lambda t: t.replace("\n", "\r\n"), lambda t: "\n" + t.replace("\n", " \n\n")])
def test_both_dialects_say_the_same(tmp_path, text, change):
    np.testing.assert_array_equal(decode(change(text).encode()), np.reshape(GRID, (1, 4, 4, 3)))
    mesh = io.read_mesh(written(tmp_path, "a.BPT", change(text)), quads=3)
    np.testing.assert_allclose(mesh.vertices, GRID, atol=1e-15)


def test_patches_keep_their_order():
    two = "2\n" + LISTED[2:] + LISTED[2:].replace("0.25", "7")
    assert decode(two.encode())[:, 1, 1, 2].tolist() == [0.25, 7.0]
    shared_points = INDEXED.replace("1\n", "2\n" + ",".join(map(str, range(16, 0, -1))) + "\n", 1)
    patches = decode(shared_points.encode())
    np.testing.assert_array_equal(patches[0], patches[1, ::-1, ::-1])


# Files that are none


def replaced(text, number, line):
    """The text with another line of that number, counted from 1."""
    lines = text.splitlines()
    lines[number - 1] = line
    return "\n".join(lines)


@pytest.mark.parametrize(
    ("text", "number", "line", "words"),
    [
        (LISTED, 1, "0", ("'0' in line 1", "number of patches, from 1")),
        (LISTED, 1, "-1", ("'-1' in line 1", "number of patches")),
        (LISTED, 1, "1.5", ("'1.5' in line 1",)),
        (LISTED, 1, "9" * 5000, ("line 1", "number of patches")),
        (LISTED, 1, "1 2", ("'1 2' in line 1",)),
        (LISTED, 1, "2", ("end of the file", "allowed: 3 3")),
        (LISTED, 1, "2147483647", ("end of the file",)),
        (LISTED, 2, "2 3", ("'2 3' in line 2", "allowed: 3 3, the degrees of a bicubic patch")),
        (LISTED, 2, "4 4", ("'4 4' in line 2", "3 3")),
        (LISTED, 2, "3", ("'3' in line 2", "3 3")),
        (LISTED, 5, "1 2", ("'1 2' in line 5", "x, y and z")),
        (LISTED, 5, "1 2 3 4", ("line 5",)),
        (LISTED, 5, "1 2 x", ("'1 2 x' in line 5", "numbers")),
        (LISTED, 5, "1 2 nan", ("'1 2 nan' in line 5", "numbers between")),
        (LISTED, 5, "1 2 inf", ("line 5",)),
        (LISTED, 5, "1 2 1e301", ("line 5", "1e+300")),
        (LISTED, 18, "3 3 1\n0 0 0", ("'0 0 0' in line 19", "nothing after")),
        (INDEXED, 1, "2", ("line 3", "16 indices")),
        (INDEXED, 2, ",".join(["0"] * 16), ("line 2", "from 1 up")),
        (INDEXED, 2, ",".join(["x"] * 16), ("line 2", "16 indices")),
        (INDEXED, 2, ",".join(["17"] * 16), ("line 2", "from 1 to 16")),
        (INDEXED, 2, ",".join(["1"] * 15), ("line 2", "3 3")),
        (INDEXED, 3, "15", ("line 2", "16 indices of points, from 1 to 15")),
        (INDEXED, 19, "3,3,2.25\n1,1,1", ("'1 1 1' in line 20", "nothing after")),
        (INDEXED, 3, "17", ("end of the file", "x, y and z")),
        (INDEXED, 3, "2147483647", ("end of the file",)),
        (INDEXED, 3, "99999999999", ("line 3", "number of points")),
        (INDEXED, 9, "1,2,nan", ("'1 2 nan' in line 9",)),
    ],
)
def test_bad_lines_are_named(tmp_path, text, number, line, words):
    check_refused(io.read_mesh, written(tmp_path, "a.bpt", replaced(text, number, line)), *words)


@pytest.mark.parametrize("text", [LISTED, INDEXED])
def test_no_first_lines_are_a_file(tmp_path, text):
    lines = text.splitlines(keepends=True)
    for count in range(len(lines)):
        check_refused(io.read_mesh, written(tmp_path, "a.bpt", "".join(lines[:count])))


@pytest.mark.parametrize("data", [b"\n\n", b"hello, world\n", bytes(200), b"\xff" * 200, b"{}", b"1", b"1\n1\n1\n"])
def test_garbage(tmp_path, data):
    check_refused(io.read_mesh, written(tmp_path, "a.bpt", data))


@pytest.mark.parametrize("quads", [0, 257, 1.5, "6", None])
def test_bad_quads_are_named(tmp_path, quads):
    with pytest.raises(ValueError, match=r"^quads: found .*allowed: a whole number from 1 to 256$"):
        io.read_mesh(written(tmp_path, "a.bpt", LISTED), quads=quads)
