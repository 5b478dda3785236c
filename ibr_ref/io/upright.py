"""Meshes with z up, whatever axis their format has up."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from ibr_ref.choices import UP
from ibr_ref.io.meshes import read_mesh
from ibr_ref.scene import Mesh, checks

Y_UP = (".obj", ".gltf", ".glb")
"""Formats whose meshes have y up, by definition or by custom."""


def read_upright(path: str | Path, up: str | None = None) -> Mesh:
    """A mesh file with z up. up: "y" or "z", the axis that is up in the file; without, by the format.

    Raises ValueError for what `read_mesh` refuses, and for another axis.
    """
    if up is not None:
        checks.choice("up", up, UP)
    mesh = read_mesh(path)
    if up == "z" or (up is None and Path(path).suffix.lower() not in Y_UP):
        return mesh
    x, y, z = np.asarray(mesh.vertices).T
    return Mesh(vertices=np.stack([x, -z, y], axis=1), triangles=mesh.triangles, color=mesh.color)
