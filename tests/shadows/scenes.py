"""Small scenes for the tests of shadows: casters of a known shape over a floor."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ibr_ref.scene import Camera, Mesh
from ibr_ref.shadows import AreaLight, Params, Scene

Array = NDArray[np.float64]


def plate(half: float = 0.5, z: float = 0.0, **changes: Any) -> Mesh:
    """A square in a plane z."""
    corners = [(-half, -half, z), (half, -half, z), (half, half, z), (-half, half, z)]
    return Mesh(vertices=corners, triangles=[(0, 1, 2), (0, 2, 3)], **changes)


def box(half: float = 0.4, **changes: Any) -> Mesh:
    """A closed cube around the origin, its triangles turned outwards."""
    corners = np.array([(x, y, z) for x in (-half, half) for y in (-half, half) for z in (-half, half)])
    quads = np.array([(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)])
    return Mesh(vertices=corners, triangles=np.concatenate([quads[:, :3], quads[:, [0, 2, 3]]]), **changes)


def ball(radius: float = 0.5, rings: int = 48) -> Mesh:
    """A sphere around the origin by meridians and parallels."""
    angles = [(math.pi * i / rings, 2 * math.pi * j / rings) for i in range(rings + 1) for j in range(rings)]
    points = [(math.sin(a) * math.cos(b), math.sin(a) * math.sin(b), math.cos(a)) for a, b in angles]
    triangles = []
    for i in range(rings):
        for j in range(rings):
            p, q = i * rings + j, i * rings + (j + 1) % rings
            triangles += [(p, p + rings, q + rings), (p, q + rings, q)]
    return Mesh(vertices=radius * np.array(points), triangles=triangles)


def light(**changes: Any) -> AreaLight:
    """Straight above the origin, looking down, with an edge of 0.4."""
    values: dict[str, Any] = {
        "position": (0.0, 0.0, 4.0),
        "target": (0.0, 0.0, 0.0),
        "vertical_fov": 60.0,
        "near": 1.0,
        "far": 8.0,
        "half_edges": ((0.2, 0.0, 0.0), (0.0, 0.2, 0.0)),
    }
    return AreaLight(**{**values, **changes})


def scene(**changes: Any) -> Scene:
    """A cube over a floor."""
    values: dict[str, Any] = {
        "receivers": [plate(6.0, -1.0, color=(0.5, 0.6, 0.7))],
        "caster": box(color=(0.8, 0.3, 0.1)),
        "offset_range": ((-0.5, 0.5), (-0.5, 0.5)),
        "offset": (0.2, -0.1),
        "light": light(),
        "camera": Camera.look_at(eye=(0.5, -4.0, 2.5), target=(0.0, 0.0, -0.7), near=0.1, far=20, width=48, height=36),
    }
    return Scene(**{**values, **changes})


def params(**changes: Any) -> Params:
    """Small maps."""
    return Params(**{"map_size": 64, "rows": 5, "columns": 4, **changes})
