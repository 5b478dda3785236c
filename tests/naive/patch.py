"""displacement/method.md, "Inputs" and "Patch space": plain copies of the inputs, and the affine frame of a polygon."""

from __future__ import annotations

from typing import Any

from .raster import Texture
from .vectors import Vec3, Vec4, cross, divide, dot, length, normalize, scale, sub, vec3, vec4


class Camera:
    """The matrices, the homogeneous world eye and the size of the window."""

    def __init__(self, camera: Any) -> None:
        self.width = int(camera.width)
        self.height = int(camera.height)
        self.view_from_world = [vec4(row) for row in camera.view_from_world]
        self.clip_from_view = [vec4(row) for row in camera.clip_from_view]
        self.eye = vec4(camera.eye)

    def clip_position(self, p: Vec3) -> Vec4:
        """World to view, then view to clip: two transforms one after another, each row summed from left to right."""
        x, y, z = p
        view = [m[0] * x + m[1] * y + m[2] * z + m[3] for m in self.view_from_world]
        clip = [m[0] * view[0] + m[1] * view[1] + m[2] * view[2] + m[3] * view[3] for m in self.clip_from_view]
        return vec4(clip)

    def direction_to_eye(self, p: Vec3) -> Vec3:
        """The view vector at a world point; for an orthographic camera the same everywhere."""
        x, y, z, w = self.eye
        if w == 0.0:
            return x, y, z
        return normalize(sub((x, y, z), p))


class Light:
    """A position, or a direction towards the light; homogeneous in world space, a direction of length 1."""

    def __init__(self, light: Any) -> None:
        self.homogeneous: Vec4
        if light.position is not None:
            self.homogeneous = (*vec3(light.position), 1.0)
        else:
            self.homogeneous = (*normalize(vec3(light.direction)), 0.0)
        self.ambient = float(light.ambient)
        self.diffuse = float(light.diffuse)
        self.specular = float(light.specular)
        self.exponent = int(light.exponent)

    def direction(self, p: Vec3) -> Vec3:
        """l: the unit vector from the world point p towards the light."""
        x, y, z, w = self.homogeneous
        if w == 0.0:
            return x, y, z
        return normalize(sub((x, y, z), p))


class Patch:
    """One polygon: its maps, its frame, and the eye and the light in its patch space."""

    def __init__(self, polygon: Any, eye: Vec4, light: Vec4) -> None:
        repeat = polygon.domain == "repeat"
        self.repeat = repeat
        self.height_map = Texture(polygon.height_map, repeat)
        self.color_map = Texture(polygon.color_map, repeat)
        self.normal_map = None if polygon.normal_map is None else Texture(polygon.normal_map, repeat)
        self.facade_map = None if polygon.facade_map is None else Texture(polygon.facade_map, True)
        self.tile_width = self.tile_height = 1.0
        if self.facade_map is not None:
            self.tile_width, self.tile_height = float(polygon.facade_tile[0]), float(polygon.facade_tile[1])

        self.corner = vec3(polygon.corner)
        self.u_edge = vec3(polygon.edge_u)
        self.v_edge = vec3(polygon.edge_v)
        self.u_length = length(self.u_edge)
        self.v_length = length(self.v_edge)
        self.s = float(polygon.height_scale)
        self.n = normalize(cross(self.u_edge, self.v_edge))
        self.up = scale(self.s, self.n)  # N3 = s n

        determinant = dot(self.u_edge, cross(self.v_edge, self.up))
        self.u_row = divide(cross(self.v_edge, self.up), determinant)  # U*
        self.v_row = divide(cross(self.up, self.u_edge), determinant)  # V*
        self.h_row = divide(cross(self.u_edge, self.v_edge), determinant)

        self.eye = self.from_world(eye)
        self.light = self.from_world(light)

    def from_world(self, p: Vec4) -> Vec4:
        """A homogeneous world point (w = 1) or direction (w = 0) in patch space."""
        q = (p[0], p[1], p[2])
        if p[3] == 1.0:
            q = sub(q, self.corner)
        return dot(self.u_row, q), dot(self.v_row, q), dot(self.h_row, q), p[3]

    def to_world(self, p: Vec3) -> Vec3:
        """((P0 + u U) + v V) + h s n, per component."""
        u, v, h = p
        corner, u_edge, v_edge, up = self.corner, self.u_edge, self.v_edge, self.up
        return (
            ((corner[0] + u * u_edge[0]) + v * v_edge[0]) + h * up[0],
            ((corner[1] + u * u_edge[1]) + v * v_edge[1]) + h * up[1],
            ((corner[2] + u * u_edge[2]) + v * v_edge[2]) + h * up[2],
        )
