"""Each mesh file is read here and by a second parser (`tests.io.plain`): the same mesh, or refused in one line."""

from __future__ import annotations

import numpy as np
import pytest

from ibr_ref import io
from tests.io import corpus, plain
from tests.io.same_surface import difference
from tests.io.test_images import check_refused

ITEMS = {item.name: item for item in corpus.items()}
LONGEST = 400
"""Characters of a message behind its path."""


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """One for all: they are many."""
    return tmp_path_factory.mktemp("meshes")


@pytest.mark.parametrize("name", ITEMS)
def test_the_same_mesh_or_refused(folder, name):
    item = ITEMS[name]
    path = item.written(folder)
    if item.refusal is None:
        assert difference(io.read_mesh(path), plain.read(path)) == ""
        return
    check_refused(io.read_mesh, path, item.refusal)
    with pytest.raises((OSError, ValueError)) as caught:
        io.read_mesh(path)
    assert len(str(caught.value)) <= LONGEST + len(str(path)) * 2
    assert "http" not in str(caught.value) or "example.org" in str(caught.value)
    if item.refusal != "crosses itself":  # the plain parser does not cut polygons
        with pytest.raises(plain.Refused):
            plain.read(path)


def test_the_second_parser_sees_differences(tmp_path):
    """It would be of no use if it did not."""
    path = ITEMS["polygon-ell-from-1.obj"].written(tmp_path)
    mesh, surface = io.read_mesh(path), plain.read(path)
    triangles = np.array(mesh.triangles)
    fanned = np.array([triangles[0], *[[3, 4 + k, 5 + k] for k in range(4)], triangles[-1]])
    for changed in (triangles[:, ::-1], triangles[1:], fanned, np.concatenate([triangles, triangles[:1]])):
        assert difference(changed_mesh(mesh, changed), surface)
    assert difference(changed_mesh(mesh, triangles, 0.5), surface)


def changed_mesh(mesh, triangles, shade=0.8):
    return type(mesh)(vertices=mesh.vertices, triangles=triangles, color=(shade, shade, shade))
