"""What makes a mesh a closed surface, wound outward."""

from __future__ import annotations

import hashlib

import numpy as np
from numpy.typing import NDArray

from ibr_ref import Mesh


def corners(mesh: Mesh) -> NDArray[np.float64]:
    """(T, 3, 3) positions."""
    return np.asarray(mesh.vertices)[np.asarray(mesh.triangles)]


def parts(mesh: Mesh) -> NDArray[np.int64]:
    """(T,) the connected part that each triangle is in, named by its first vertex."""
    triangles = np.asarray(mesh.triangles)
    names = np.arange(len(np.asarray(mesh.vertices)))
    while True:
        least = names[triangles].min(axis=1)
        before = names.copy()
        for corner in range(3):
            np.minimum.at(names, triangles[:, corner], least)
        if (names == before).all():
            return least


def volumes(mesh: Mesh) -> list[float]:
    """The signed volume of every part: positive where the winding is outward."""
    a, b, c = corners(mesh).transpose(1, 0, 2)
    signed = (a * np.cross(b, c)).sum(axis=1) / 6.0
    names = parts(mesh)
    return [float(signed[names == name].sum()) for name in np.unique(names)]


def assert_closed(mesh: Mesh) -> None:
    """Every edge is walked once in either direction: no hole, no fin, no triangle turned over."""
    triangles = np.asarray(mesh.triangles)
    edges = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
    assert (edges[:, 0] != edges[:, 1]).all()
    assert len(np.unique(edges, axis=0)) == len(edges)
    assert {tuple(edge) for edge in edges.tolist()} == {tuple(edge[::-1]) for edge in edges.tolist()}


def digest(*arrays: object) -> str:
    """SHA-256 of little-endian float64 bytes."""
    sha = hashlib.sha256()
    for array in arrays:
        sha.update(np.asarray(array).astype("<f8").tobytes())
    return sha.hexdigest()
