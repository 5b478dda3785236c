"""The picture before its shadows: which surface each pixel sees."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ibr_ref.oracle.programs.program import Bools, Floats, Ints, Vector
from ibr_ref.oracle.programs.shadows.maps import Maps
from ibr_ref.oracle.programs.shadows.raster import Fragments, Raster


@dataclass(frozen=True)
class Surface:
    """The N fragments that are seen."""

    pixel: Ints
    """(N,) row times width, plus column."""
    world: Vector
    """Position, three (N,)."""
    color: Vector
    """Three (N,)."""
    normal: Vector
    """Flat, of unit length, as the triangle is wound; three (N,)."""
    casts: Bools
    """(N,) whether it is the caster's."""
    depth: Floats
    """(H W,) of the picture: 1 where nothing is seen."""


@dataclass(frozen=True)
class Drawn:
    """Triangles of all meshes, in order: (T, 3) each."""

    world: Vector
    clip: Vector
    color: Vector
    casts: Bools
    """(T,)."""


class Picture(Maps):
    """Vertex stage, rasterization and depth test of receivers and caster."""

    def meshes(self) -> list[tuple[Vector, Floats, Ints]]:
        """World positions (three (V,)), colours (V, 3) and triangles of the receivers, then the caster."""
        result = [(list(self.do.matrix(mesh.vertices).T), mesh) for mesh in self.scene.receivers]
        result.append((self.caster_vertices(self.offset), self.scene.caster))
        return [
            (world, np.broadcast_to(self.do.matrix(mesh.color), (len(world[0]), 3)), np.asarray(mesh.triangles))
            for world, mesh in result
        ]

    def to_clip(self, world: Vector) -> Vector:
        """Four (V,) clip coordinates of the picture."""
        camera = self.scene.camera
        return self.clip_coordinates(np.asarray(camera.clip_from_view), self.do.matrix(camera.view_from_world), world)

    def drawn(self) -> Drawn:
        """All triangles in the order of submission."""
        world, clip, color = [], [], []
        meshes = self.meshes()
        for positions, colors, triangles in meshes:
            world.append([component[triangles] for component in positions])
            clip.append([component[triangles] for component in self.to_clip(positions)])
            color.append([component[triangles] for component in colors.T])
        counts = [len(triangles) for _, _, triangles in meshes]
        casts = np.repeat(np.arange(len(counts)) == len(counts) - 1, counts)
        return Drawn(_joined(world), _joined(clip), _joined(color), casts)

    def surface(self) -> Surface:
        """What is seen."""
        raster, camera = self.surface_raster(self.do), self.scene.camera
        drawn = self.drawn()
        corners, owner = raster.clip(np.stack([*drawn.clip, *drawn.world, *drawn.color], axis=-1))
        x, y, z = raster.window(corners, camera.width, camera.height)
        fragments = raster.cover(x, y, camera.width, camera.height)
        depth = self.do.depth(self.window_depth(raster, fragments, z, corners[..., 3]))
        seen, held = raster.nearest(fragments.pixel, depth, camera.width * camera.height)
        fragments = fragments.take(seen[seen >= 0])
        mesh_triangle, w = owner[fragments.triangle], corners[..., 3]
        return Surface(
            pixel=fragments.pixel,
            world=self.world(raster, fragments, w, [corners[..., k] for k in (4, 5, 6)]),
            color=self.colors(raster, fragments, w, [corners[..., k] for k in (7, 8, 9)]),
            normal=[component[mesh_triangle] for component in self.normals(drawn.world)],
            casts=drawn.casts[mesh_triangle],
            depth=held,
        )

    def window_depth(self, raster: Raster, fragments: Fragments, z: Floats, w: Floats) -> Floats:
        """Of fragments: linear in the window."""
        return raster.linear(fragments, z)

    def world(self, raster: Raster, fragments: Fragments, w: Floats, corners: Vector) -> Vector:
        """Positions of fragments."""
        return raster.perspective(fragments, w, corners)

    def colors(self, raster: Raster, fragments: Fragments, w: Floats, corners: Vector) -> Vector:
        """Colours of fragments."""
        return raster.perspective(fragments, w, corners)

    def read_back(self, depth: Floats) -> Floats:
        """The picture's depth, as it is handed in."""
        return depth

    def normals(self, world: Vector) -> Vector:
        """Three (T,) of triangles with corners three (T, 3): the cross product of two edges, of unit length."""
        first, second = ([self.do.subtract(p[:, k], p[:, 0]) for p in world] for k in (1, 2))
        return self.do.unit(self.cross(first, second))

    def cross(self, a: Vector, b: Vector) -> Vector:
        """The vector product."""
        do = self.do
        return [do.subtract(do.multiply(a[i], b[j]), do.multiply(a[j], b[i])) for i, j in ((1, 2), (2, 0), (0, 1))]


def _joined(meshes: list[Vector]) -> Vector:
    """The components of all meshes, one after another."""
    return [np.concatenate(component) for component in zip(*meshes, strict=True)]
