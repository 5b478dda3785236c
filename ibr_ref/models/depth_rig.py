"""Reference images of a mesh for splatting: pictures with depth, taken from all around it."""

from __future__ import annotations

import math

import numpy as np

from ibr_ref.array_types import Floats
from ibr_ref.pipeline.clip import clip_triangles
from ibr_ref.pipeline.transform import transformed
from ibr_ref.pipeline.triangles import set_up
from ibr_ref.pipeline.visibility import interpolate, visible
from ibr_ref.scene import Camera, DepthImage, Mesh, checks
from ibr_ref.scene.trigonometry import sine_cosine

COUNTS = (4, 9, 16, 32)
MOST_PIXELS = 4096
"""A side: the largest atlas of splatting would hold one."""

VERTICAL_FOV = 40.0
DISTANCE = 3.0
"""From the eye to the middle of the mesh, in radii of the sphere around it. The sphere then fills 0.971 of the picture."""
SLACK = 1.0625
"""The planes are tangent to a sphere this much larger than the one around the mesh."""

_FARTHEST, _LEAST_EXTENT = 1e45, 1e-9
_GOLDEN_ANGLE = math.pi * (3.0 - math.sqrt(5.0))


def depth_rig(mesh: Mesh, count: int = 9, *, size: int = 192) -> list[DepthImage]:
    """Take `count` pictures, 4, 9, 16 or 32, of size x size pixels, evenly from all around a mesh, below too.

    Camera k looks at the middle of the mesh's bounding box from the direction k of `directions`, up is +z. All have a
    field of view of 40 degrees and stand 3 radii of the sphere around the mesh away from its centre, so that the sphere
    just fits; near and far enclose it. Vertices of no triangle do not count. `depth_image` says what a picture holds.

    The paper's 4, 9 and 16 images have 45,012, 83,521 and 167,980 points in all; `kettle()` has as many, to 1 %, at sizes
    210, 189 and 201.

    Raises ValueError for a mesh that is none or has no extent, and for a count or size that is not allowed.
    """
    if not isinstance(mesh, Mesh):
        raise checks.reject("mesh", type(mesh).__name__, "a Mesh")
    count = checks.whole("count", count, low=COUNTS[0], high=COUNTS[-1])
    if count not in COUNTS:
        raise checks.reject("count", count, " | ".join(map(str, COUNTS)))
    size = checks.whole("size", size, low=1, high=MOST_PIXELS)
    mesh = mesh.compact()
    center, radius = _sphere_around(mesh)
    return [depth_image(mesh, _camera(center, radius, direction, size)) for direction in directions(count)]


def directions(count: int) -> Floats:
    """(count, 3) unit vectors of the Fibonacci lattice: z = 1 - (2 k + 1)/count, turned by the golden angle each time.

    Evenly spread, from near +z to near -z, none of them vertical.
    """
    z = 1.0 - (2.0 * np.arange(count) + 1.0) / count
    beside = np.sqrt(1.0 - z * z)
    turns = np.array([sine_cosine(k * _GOLDEN_ANGLE) for k in range(count)])
    return np.stack([beside * turns[:, 1], beside * turns[:, 0], z], axis=1)


def depth_image(mesh: Mesh, camera: Camera) -> DepthImage:
    """The picture that one camera takes of a mesh: its own colours, unlit, its depths, and the mask of where it is seen.

    Both sides of a triangle are seen. The depth along the view axis is a perspective-correct varying, right to some units
    in the last place whatever near and far are, as the window depth is not. The corners are snapped to 1/256 pixel, as in
    any rasterizer: the point of a pixel lies on the line of sight through its centre, at the depth of a point of the mesh
    that is seen at most 1/512 pixel beside it on either axis.
    """
    vertices, triangles = np.asarray(mesh.vertices), np.asarray(mesh.triangles)
    view = transformed(camera.view_from_world, vertices)
    clip = transformed(camera.clip_from_view, view)
    varyings = np.append(-view[:, 2:3], np.broadcast_to(mesh.color, vertices.shape), axis=1)
    clipped = clip_triangles(clip, varyings, triangles, camera.width, camera.height)
    drawn = set_up(clipped, camera.width, camera.height)
    shown = visible(drawn, camera.width, camera.height)
    pixels = interpolate(drawn, shown.triangle)
    mask = shown.triangle >= 0
    # A mean of colours in [0, 1] may round to outside.
    color = np.clip(np.where(mask[:, :, None], pixels[:, :, 1:], 0.0), 0.0, 1.0)
    return DepthImage(color=color, depth=pixels[:, :, 0], camera=camera, mask=mask)


def _sphere_around(mesh: Mesh) -> tuple[Floats, float]:
    """The middle of the bounding box, and the distance from there to the farthest vertex."""
    used, (low, high) = mesh.corners, mesh.bounds
    if not np.abs(used).max() <= _FARTHEST:
        raise checks.reject(
            "mesh.vertices", float(np.abs(used).max()), f"numbers between {-_FARTHEST:g} and {_FARTHEST:g}"
        )
    center = low + (high - low) / 2.0
    x, y, z = (used - center).T
    radius = float(np.sqrt((x * x + y * y + z * z).max()))
    if not radius > _LEAST_EXTENT * np.abs(used).max():
        found = f"a box from {low.tolist()} to {high.tolist()}"
        raise checks.reject("mesh.vertices", found, f"a radius above {_LEAST_EXTENT:g} of the largest coordinate")
    return center, radius


def _camera(center: Floats, radius: float, direction: Floats, size: int) -> Camera:
    return Camera.look_at(
        eye=center + DISTANCE * radius * direction,
        target=center,
        vertical_fov=VERTICAL_FOV,
        near=(DISTANCE - SLACK) * radius,
        far=(DISTANCE + SLACK) * radius,
        width=size,
        height=size,
    )
