"""Stage 3: every valid pixel becomes a point with a place in the window, a width and a colour."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from ibr_ref.oracle.programs.splatting.atlas import Pages
from ibr_ref.oracle.programs.splatting.case import Bools, Floats, Image, Ints, Vector
from ibr_ref.oracle.programs.splatting.lighting import Lighting
from ibr_ref.oracle.programs.splatting.unproject import Unprojection

GAUSSIAN = ("vertex.covariance", "vertex.amplitude", "vertex.distance")
"""Arrays of ellipses."""
Clip = Vector
"""x, y, z, w of clip space."""


@dataclass(frozen=True)
class Texels:
    """What is fetched for the points of an image, (P,) each."""

    rows: Ints
    columns: Ints
    depth: Floats
    albedo: Vector
    codes: Vector
    """Of the normals to light with."""


@dataclass(frozen=True)
class Placed:
    """Points in the window, (P,) each."""

    world: Vector
    window: Vector
    """x and y."""
    depth: Floats
    width: Floats
    kept: Bools
    """Others are dropped: window, depth and width mean nothing."""
    gaussian: Vector
    """xx, xy, yy, amplitude and distance of ellipses; of other splats nothing."""


class Vertex(Unprojection, Lighting):
    """The vertex shader."""

    def points(self, number: int, texels: Texels) -> dict[str, Any]:
        """The stage's arrays of one image's points."""
        image = self.scene.images[number]
        placed = self.placed(image, texels)
        kept = np.asarray(placed.kept)
        gaussian = [np.where(kept, x, np.nan) for x in placed.gaussian]
        return {
            "vertex.window": np.where(kept[:, None], np.stack(placed.window, axis=1), np.nan),
            "vertex.depth": np.where(kept, placed.depth, np.nan),
            "vertex.width": np.where(kept, placed.width, 0.0),
            "vertex.color": np.stack(self.lit(image, placed.world, texels.codes, texels.albedo), axis=1),
            "vertex.source": self.source(number, texels.rows, texels.columns),
            **(dict(zip(GAUSSIAN, self.named_gaussian(gaussian), strict=True)) if gaussian else {}),
        }

    def named_gaussian(self, gaussian: Vector) -> Vector:
        """(P, 3), (P,) and (P,): as the arrays of an ellipse have it."""
        return [np.stack(gaussian[:3], axis=1), *gaussian[3:]]

    # --- Fetches -----------------------------------------------------------------------------------------------------

    def texels(self, number: int, atlas: dict[str, Any], codes: Any) -> Texels:
        """Of all points of an image; codes (H, W, 3) uint8 to light with."""
        rows, columns = np.nonzero(self.scene.images[number].arrays[2])
        rect = atlas["atlas.rects"][number]
        return Texels(
            rows,
            columns,
            self.fetch(atlas["atlas.depth"], rect, rows, columns),
            list(self.fetch(atlas["atlas.color"], rect, rows, columns).T),
            list(self.fetch_normals(codes, rows, columns).astype(np.float64).T),
        )

    def fetch(self, pages: Pages, rect: Ints, rows: Ints, columns: Ints) -> Floats:
        """Texels of an image, from its rectangle of the atlas."""
        page, x, y = rect[:3]
        return pages[page][y + rows, x + columns]

    def fetch_normals(self, codes: Any, rows: Ints, columns: Ints) -> Any:
        """(P, 3) the normals' codes of pixels."""
        return codes[rows, columns]

    def source(self, number: int, rows: Ints, columns: Ints) -> Ints:
        """(P, 3) int32 image, row, column."""
        return np.stack([np.full_like(rows, number), rows, columns], axis=1).astype(np.int32)

    # --- Places ------------------------------------------------------------------------------------------------------

    def placed(self, image: Image, texels: Texels) -> Placed:
        """Points of an image through unprojection, T_R→W, T_W→C and T_P."""
        tell = self.do.told
        depth = tell("fetch: depth", texels.depth)
        point = self.view_point(image.camera, texels.columns, texels.rows, depth)
        world, view, clip = self.positions(image, point)
        tell("world x, y, z", world)
        window, window_depth = self.projected(clip, view)
        kept = self.kept(window, clip[2], clip[3])
        width, gaussian = self.sized(image, texels, world, view, clip)
        return Placed(world, list(window), window_depth, width, kept, gaussian)

    def positions(self, image: Image, point: Vector) -> tuple[Vector, Vector, Vector]:
        """World (3), view (3) and clip (4) coordinates, of those in the reference camera's view space."""
        world = self.from_view(image.camera, point)
        view = self.camera_point(world)
        clip = self.clip_point(view)
        if not (self.do.bounded and self.right("world_from_view", "from_view", "camera_point", "clip_point")):
            return world, view, clip
        # Or two of the matrices, or all three, are multiplied together on the host.
        two = self.scene.camera.clip_from_world
        orders = ((two, world), (two @ image.camera.world_from_view, point))
        clip = self.do.either(clip, *(lambda m=m, p=p: self.transform(m, p) for m, p in orders))
        if self.do.minus_one:
            clip[2] = self.do.either(clip[2], lambda: self.do.halfway(self.z_from_minus_one(view), clip[3]))
        return world, view, clip

    def camera_point(self, world: Vector) -> Vector:
        """T_W→C."""
        return self.transform(self.scene.camera.view_from_world, world)[:3]

    def clip_point(self, view: Vector) -> Vector:
        """T_P."""
        return self.transform(self.scene.camera.clip_from_view, view)

    def z_from_minus_one(self, view: Vector) -> Floats:
        """Clip z of a clip space that starts at -w: 2 z - w, by a matrix of its own."""
        rows = np.asarray(self.scene.camera.clip_from_view)
        (z,) = self.transform((2.0 * rows[2] - rows[3])[None], view)
        return z

    def projected(self, clip: Vector, view: Vector) -> tuple[Vector, Floats]:
        """Window position and depth."""
        x, y, z = (self.do.divide(value, clip[3]) for value in clip[:3])
        depth = self.window_depth(z)
        if self.do.minus_one and self.right("clip_point", "window_depth"):
            depth = self.do.either(depth, lambda: self.halved(self.do.divide(self.z_from_minus_one(view), clip[3])))
        return [self.window_x(x), self.window_y(y)], depth

    def window_x(self, x: Floats) -> Floats:
        """(x + 1)/2 · width, or x · width/2 + width/2."""
        width = self.scene.camera.width
        return self.do.either(self.do.multiply(self.halved(x), width), lambda: self.viewport(x, 0.5 * width, 1.0))

    def window_y(self, y: Floats) -> Floats:
        """(1 − y)/2 · height: downwards."""
        height = self.scene.camera.height
        down = self.do.multiply(self.do.multiply(0.5, self.do.subtract(1.0, y)), height)
        return self.do.either(down, lambda: self.viewport(y, 0.5 * height, -1.0))

    def halved(self, x: Floats) -> Floats:
        """(x + 1)/2."""
        return self.do.multiply(0.5, self.do.add(x, 1.0))

    def viewport(self, ndc: Floats, half: float, sign: float) -> Floats:
        """A window coordinate, scaled and moved."""
        return self.do.dot([ndc, half], [sign * half, 1.0])

    def window_depth(self, z: Floats) -> Floats:
        """Of a normalized z from 0 to 1."""
        return z

    def kept(self, window: Vector, z: Floats, w: Floats) -> Bools:
        """Whether points are drawn, by their clip z and w: all between the planes, in the picture or not."""
        return self.do.told("w > 0", w > 0.0) & self.inside_planes(z, w)

    def inside_planes(self, z: Floats, w: Floats) -> Bools:
        """0 ≤ z ≤ w."""
        return self.do.told("0 <= z", z >= 0.0) & self.do.told("z <= w", z <= w)

    # --- Widths ------------------------------------------------------------------------------------------------------

    def sized(self, image: Image, texels: Texels, world: Vector, view: Vector, clip: Clip) -> tuple[Floats, Vector]:
        """W_s by the law; and no Gaussian."""
        distance = self.do.told("distance d of the law", self.distance(image, world, view))
        return self.clamp_width(self.width(distance)), []

    def distance(self, image: Image, world: Vector, view: Vector) -> Floats:
        """d, from the eye; orthographic, along the view axis. The image is the one that the points are of."""
        if not self.scene.camera.perspective:
            return np.negative(view[2])
        eye = self.do.number(self.scene.camera.eye)[:3]
        return self.length([self.do.subtract(x, place) for x, place in zip(world, eye, strict=True)])

    def length(self, vector: Vector) -> Floats:
        """The Euclidean length."""
        return self.do.root(self.do.dot(vector, vector))

    def square(self, d: Floats) -> Floats:
        """d², of the law."""
        return self.do.multiply(d, d)

    def law(self) -> list[Floats]:
        """β, γ and δ."""
        return [self.do.number(getattr(self.params, name)) for name in ("beta", "gamma", "delta")]

    def denominator(self, d: Floats) -> Floats:
        """β d² + γ d + δ."""
        return self.do.dot(self.law(), [self.square(d), d, 1.0])

    def width(self, d: Floats) -> Floats:
        """W_s = α / (β d² + γ d + δ)."""
        return self.do.divide(self.do.number(self.params.alpha), self.denominator(d))

    def clamp_width(self, width: Floats) -> Floats:
        """To [min_width, max_width] pixels."""
        low, high = self.do.number(self.params.min_width), self.do.number(self.params.max_width)
        return np.minimum(np.maximum(width, low), high)
