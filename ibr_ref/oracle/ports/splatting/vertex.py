"""Stage 3: every valid pixel becomes a point with a place in the window, a width and a colour."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ibr_ref.array_types import Bools, Floats
from ibr_ref.oracle.ports.splatting.atlas import Integers, Pages
from ibr_ref.oracle.ports.splatting.lighting import Lighting
from ibr_ref.oracle.ports.splatting.stage import Vector
from ibr_ref.oracle.ports.splatting.unproject import Unprojection


class Vertex(Unprojection, Lighting):
    """The vertex shader."""

    def arrays(self, atlas: dict[str, Any], codes: Sequence[NDArray[np.uint8]]) -> dict[str, Any]:
        """The stage's arrays, of the atlas' and the normals (H, W, 3) to light with, one array an image."""
        parts = [self.points(number, atlas, codes[number]) for number in range(len(self.scene.images))]
        return {name: np.concatenate([part[name] for part in parts]) for name in parts[0]}

    def points(self, number: int, atlas: dict[str, Any], codes: NDArray[np.uint8]) -> dict[str, Any]:
        """The arrays of one image's points."""
        image, rect = self.scene.images[number], atlas["atlas.rects"][number]
        rows, columns = np.nonzero(image.arrays[2])
        depth = self.fetch(atlas["atlas.depth"], rect, rows, columns)
        albedo = list(self.fetch(atlas["atlas.color"], rect, rows, columns).T)
        world, view, clip = self.positions(image, self.view_point(image.camera, columns, rows, depth))
        window, window_depth = self.projected(clip)
        kept = self.kept(window, *clip[2:])
        width = self.clamp_width(self.width(self.distance(image, world, view)))
        normals = self.fetch_normals(codes, rows, columns).astype(np.float64)
        return {
            "vertex.window": np.where(kept[:, None], np.stack(window, axis=1), np.nan),
            "vertex.depth": np.where(kept, window_depth, np.nan),
            "vertex.width": np.where(kept, width, 0.0),
            "vertex.color": np.stack(self.lit(image, world, normals, albedo), axis=1),
            "vertex.source": self.source(number, rows, columns),
        }

    def fetch(self, pages: Pages, rect: Integers, rows: Integers, columns: Integers) -> Floats:
        """Texels of an image, from its rectangle of the atlas."""
        page, x, y = rect[:3]
        return np.asarray(pages[page][y + rows, x + columns])

    def fetch_normals(self, codes: NDArray[np.uint8], rows: Integers, columns: Integers) -> NDArray[np.uint8]:
        """(P, 3) the normals' codes of pixels."""
        return codes[rows, columns]

    def source(self, number: int, rows: Integers, columns: Integers) -> Integers:
        """(P, 3) int32 image, row, column."""
        return np.stack([np.full_like(rows, number), rows, columns], axis=1).astype(np.int32)

    def positions(self, image: Any, point: list[Floats]) -> tuple[list[Floats], list[Floats], list[Floats]]:
        """World (3), view (3) and clip (4) coordinates, of those in the reference camera's view space."""
        world = self.world_point(image.camera, point)
        view = self.camera_point(world)
        return world, view, self.clip_point(view)

    def camera_point(self, world: list[Floats]) -> list[Floats]:
        """T_W→C."""
        return self.transform(self.scene.camera.view_from_world, world)[:3]

    def clip_point(self, view: list[Floats]) -> list[Floats]:
        """T_P."""
        return self.transform(self.scene.camera.clip_from_view, view)

    def projected(self, clip: Vector) -> tuple[tuple[Floats, Floats], Floats]:
        """Window position and depth."""
        x, y, z = (self.alu.divide(value, clip[3]) for value in clip[:3])
        return (self.window_x(x), self.window_y(y)), self.window_depth(z)

    def window_x(self, x: Floats) -> Floats:
        """(x + 1)/2 · width."""
        half = self.alu.multiply(0.5, self.alu.add(x, 1.0))
        return self.alu.multiply(half, self.scene.camera.width)

    def window_y(self, y: Floats) -> Floats:
        """(1 − y)/2 · height."""
        half = self.alu.multiply(0.5, self.alu.subtract(1.0, y))
        return self.alu.multiply(half, self.scene.camera.height)

    def window_depth(self, z: Floats) -> Floats:
        """Of a normalized z from 0 to 1."""
        return z

    def kept(self, window: tuple[Floats, Floats], z: Floats, w: Floats) -> Bools:
        """Whether points are drawn, by their clip z and w: all between the planes, in the picture or not."""
        return np.asarray((w > 0.0) & self.inside_planes(z, w))

    def inside_planes(self, z: Floats, w: Floats) -> Bools:
        """0 ≤ z ≤ w."""
        return np.asarray((z >= 0.0) & (z <= w))

    def distance(self, image: Any, world: Vector, view: Vector) -> Floats:
        """d, from the eye; orthographic, along the view axis. The image is the one that the points are of."""
        if not self.scene.camera.perspective:
            return np.negative(view[2])
        eye = self.alu.number(self.scene.camera.eye)[:3]
        return self.length([self.alu.subtract(x, place) for x, place in zip(world, eye, strict=True)])

    def length(self, vector: Vector) -> Floats:
        """The Euclidean length."""
        return self.alu.root(self.alu.dot(vector, vector))

    def square(self, d: Floats) -> Floats:
        """d², of the law."""
        return self.alu.multiply(d, d)

    def denominator(self, d: Floats) -> Floats:
        """β d² + γ d + δ."""
        beta, gamma, delta = (self.alu.number(getattr(self.params, name)) for name in ("beta", "gamma", "delta"))
        return self.alu.dot([beta, gamma, delta], [self.square(d), d, 1.0])

    def width(self, d: Floats) -> Floats:
        """W_s = α / (β d² + γ d + δ)."""
        return self.alu.divide(self.alu.number(self.params.alpha), self.denominator(d))

    def clamp_width(self, width: Floats) -> Floats:
        """To [min_width, max_width] pixels."""
        low, high = self.alu.number(self.params.min_width), self.alu.number(self.params.max_width)
        return np.minimum(np.maximum(width, low), high)
